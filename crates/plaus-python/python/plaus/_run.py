"""Runs: draws as arrays, solutions, motions, pages.

Modules that only some calls need are imported in those calls, so that `import plaus` is quick.
"""

from __future__ import annotations

import os
import weakref
from collections.abc import Iterable, Sequence
from typing import TYPE_CHECKING, Any, NamedTuple, Union

from plaus import _plaus
from plaus._motion import Events, Poses, Replay
from plaus._requirement import Requirement

if TYPE_CHECKING:
    import xarray

    Path = str | os.PathLike[str]


class Sample(NamedTuple):
    """A draw: its chain, its number there, from 0, and whether it is from the warm-up, which is numbered separately."""

    chain: int
    draw: int
    warmup: bool = False

    def __str__(self) -> str:
        return f"{self.chain}:{'w' if self.warmup else ''}{self.draw}"


class Solution(NamedTuple):
    """The first satisfying draw of its kind."""

    chain: int
    draw: int
    iteration: int
    """The iteration that recorded it."""
    log_p: float
    """Log probability density, up to a constant."""
    warmup: bool = False
    """Whether it was found in the warm-up, while moves were adapted; statistics leave such draws out."""

    @property
    def sample(self) -> Sample:
        """The draw that it is."""
        return Sample(self.chain, self.draw, self.warmup)


# What names a sample: the number of a solution, (chain, draw), or "chain:draw".
Which = Union[int, str, "tuple[int, int]", Sample, Solution]


class _Folder:
    """A run's folder."""

    fleeting = False

    def __init__(self, path: Path) -> None:
        self.path = os.fspath(path)


def _remove(folder: str, owner: int) -> None:
    # A forked child leaves the folder, which its parent still needs.
    if os.getpid() == owner:
        import shutil

        shutil.rmtree(folder, ignore_errors=True)


class _TemporaryFolder(_Folder):
    """A run's folder that is deleted with the run."""

    fleeting = True

    def __init__(self) -> None:
        import tempfile

        place = tempfile.mkdtemp(prefix="plaus-")
        super().__init__(os.path.join(place, "run"))
        self._end = weakref.finalize(self, _remove, place, os.getpid())


class Table(dict[str, Any]):
    """Columns of numbers, all equally long: a dictionary of names and read-only numpy arrays.

    Data frames accept it unchanged: `polars.DataFrame(run.draws)`, `pandas.DataFrame(run.draws)`,
    `pyarrow.table(run.draws)`.
    """

    def __init__(self, columns: dict[str, Any], units: dict[str, str]) -> None:
        super().__init__(columns)
        self.units = units
        """Units by name; empty for pure numbers."""

    @property
    def rows(self) -> int:
        """How many rows there are."""
        return len(next(iter(self.values()), ()))

    def __repr__(self) -> str:
        return f"<Table: {self.rows:,} rows, columns {', '.join(self)}>"


class Gallery:
    """A page that plays solutions. Notebooks show it in a frame; `open` shows it in a browser."""

    def __init__(self, html: str, shown: int, distinct: int) -> None:
        self.html = html
        """The page: one text that needs nothing else."""
        self.shown = shown
        """Number of solutions on it."""
        self.distinct = distinct
        """Number of distinct solutions of the run."""

    def save(self, path: Path, *, force: bool = False) -> str:
        """Writes the page; an existing file is replaced only with `force`."""
        with open(path, "w" if force else "x", encoding="utf-8") as out:
            out.write(self.html)
        return os.fspath(path)

    def open(self) -> str:
        """Shows the page in a browser; returns the path of its file."""
        import tempfile
        import webbrowser

        place = os.path.join(tempfile.mkdtemp(prefix="plaus-gallery-"), "gallery.html")
        self.save(place)
        webbrowser.open("file://" + place)
        return place

    def _repr_html_(self) -> str:
        from html import escape

        # Without allow-same-origin, the page can run and download, but cannot see the notebook.
        return (
            f'<iframe sandbox="allow-scripts allow-downloads" srcdoc="{escape(self.html, quote=True)}" '
            'style="width:100%;height:640px;border:0" title="plaus gallery"></iframe>'
        )

    def __repr__(self) -> str:
        return f"<Gallery of {self.shown} of {self.distinct} distinct solutions, {len(self.html) / 1e6:.1f} MB>"


def _opened(path: str, requirement: Requirement | None) -> Run:
    return Run(path, _requirement=requirement)


class Run:
    """The samples of a scenario. `Run(path)` opens a run's folder; `plaus.sample` makes a run.

    A run never changes while you use it; `resume` returns a new one.
    """

    def __init__(
        self,
        path: Path,
        *,
        salvage: bool = False,
        _folder: _Folder | None = None,
        _ended: tuple[str, float] | None = None,
        _requirement: Requirement | None = None,
    ) -> None:
        import json

        self._run = _plaus.RunFolder(path, salvage)
        self._folder = _folder or _Folder(path)
        self.manifest: dict[str, Any] = json.loads(self._run.manifest())
        """What the run is: scenario, seed, plan, version, moves, numbers."""
        self.ending: str | None = _ended[0] if _ended else None
        """How sampling ended: `complete`, `enough_solutions`, `out_of_time`, `interrupted`, `callback`; None for a run
        that was opened."""
        self.seconds: float | None = _ended[1] if _ended else None
        """Seconds that sampling took; None for a run that was opened."""
        self.requirement = _requirement
        """The requirement that it was sampled with, if known."""
        self._solutions: list[Solution] | None = None

    def __reduce__(self) -> tuple[Any, ...]:
        # A copy opens the folder again, which must outlive it.
        if self._folder.fleeting:
            raise TypeError("this run is in a temporary folder that is deleted with it: give `sample` a folder by `out`")
        return _opened, (self.path, self.requirement)

    @property
    def path(self) -> str:
        """The run's folder."""
        return self._folder.path

    @property
    def scenario(self) -> _plaus.Scenario:
        """The scenario, with all overrides applied."""
        stored = self.manifest["scenario"]
        return _plaus.Scenario.from_text(stored["effective"], stored["file"])

    @property
    def seed(self) -> int:
        """Seed of all randomness."""
        return int(self.manifest["plan"]["seed"])

    @property
    def chains(self) -> int:
        """Number of chains in the folder: all chains of the run, or those of a piece."""
        first, end = self._run.chains()
        return end - first

    @property
    def iterations(self) -> int:
        """Iterations that every chain has done, including the warm-up."""
        return self._run.size()[2]

    @property
    def draw_count(self) -> int:
        """Number of draws of each chain after the warm-up."""
        return self._run.size()[1]

    @property
    def draws(self) -> Table:
        """All draws after the warm-up: `chain`, `draw`, `log_p`, `satisfied`, then the scene's scalars."""
        import numpy

        columns = self._run.columns(False)
        arrays = {name: array.reshape(-1) for name, _, _, array in columns}
        chains, draws = numpy.arange(*self._run.chains()), columns[0][3].shape[1]
        index = {
            "chain": numpy.repeat(chains, draws),
            "draw": numpy.tile(numpy.arange(draws), len(chains)),
            "log_p": arrays["lp"],
            "satisfied": arrays["satisfied"],
        }
        own = {name: arrays[name] for name, _, role, _ in columns if role != "stat"}
        return Table({**index, **own}, {name: unit for name, unit, _, _ in columns})

    @property
    def solutions(self) -> list[Solution]:
        """The distinct solutions, each represented by its first draw, in the order in which they were found."""
        if self._solutions is None:
            self._solutions = [Solution(*found) for found in self._run.solutions()]
        return self._solutions

    def most_different(self, count: int) -> list[Solution]:
        """Up to `count` distinct solutions: the likeliest, then always the one that looks least like those before."""
        return [Solution(*found) for found in self._run.most_different(count)]

    def _sample(self, which: Which) -> Sample:
        if isinstance(which, str):
            chain, _, draw = which.partition(":")
            try:
                return Sample(int(chain), int(draw.removeprefix("w")), draw.startswith("w"))
            except ValueError:
                raise ValueError(f"{which!r} names no sample: write CHAIN:DRAW, e.g. '0:17'") from None
        if isinstance(which, (Sample, Solution)):
            return Sample(which.chain, which.draw, which.warmup)
        if isinstance(which, tuple):
            return Sample(int(which[0]), int(which[1]))
        if isinstance(which, bool) or not hasattr(which, "__index__"):
            raise TypeError(f"{which!r} names no sample: give the number of a solution, (chain, draw), or 'chain:draw'")
        known = self.solutions
        try:
            return known[which].sample
        except IndexError:
            raise IndexError(f"there is no solution {which}: there are {len(known)}") from None

    def replay(self, which: Which = 0, *, accuracy: str | None = None) -> Replay:
        """Simulates one sample again: the solution with this number, or the draw `(chain, draw)` or `"chain:draw"`.

        `accuracy`: simulate the same draw at another accuracy, for example `"fine"` or `"reference"`.
        """
        [made] = self._run.replay([self._sample(which)], accuracy)
        return Replay(*made)

    def replays(self, which: Iterable[Which] | None = None) -> list[Replay]:
        """Simulates many samples again, on all cores; by default one sample of each solution."""
        chosen = [self._sample(one) for one in (self.solutions if which is None else which)]
        return [Replay(*made) for made in self._run.replay(chosen)]

    def poses(self, which: Which = 0, fps: float = 60.0) -> Poses:
        """Poses of all bodies of one sample at `fps` frames per second: times, names, positions and orientations."""
        return self.replay(which).poses(fps)

    def events(self, which: Which = 0) -> Events:
        """Impacts of one sample, in order of time."""
        return self.replay(which).events

    def diagnose(self, most: int | None = None) -> dict[str, Any]:
        """What `plaus diagnose --json` prints: R-hat and effective sample size of every scalar, acceptance of every
        move.

        `most`: the largest number of draws of each chain to use.
        """
        import json

        made: dict[str, Any] = json.loads(self._run.diagnose(most))
        return made

    def to_datatree(self, *, warmup: bool = True) -> xarray.DataTree:
        """The draws for ArviZ and xarray: groups `posterior` and `sample_stats`, and the same groups for the warm-up.

        Needs xarray. Arrays are not copied, and are read-only.
        """
        import numpy

        try:
            import xarray
        except ImportError as error:
            raise ImportError("to_datatree needs xarray: pip install 'plaus[arviz]'") from error

        chains = numpy.arange(*self._run.chains())
        groups: dict[str, xarray.Dataset] = {}
        for prefix, early in [("", False), ("warmup_", True)][: 2 if warmup else 1]:
            columns = self._run.columns(early)
            draws = columns[0][3].shape[1]
            if early and draws == 0:
                continue
            index = {"chain": chains, "draw": numpy.arange(draws)}
            for group, stat in [("posterior", False), ("sample_stats", True)]:
                arrays = {
                    name: (("chain", "draw"), array, {} if stat else {"unit": unit, "role": role})
                    for name, unit, role, array in columns
                    if (role == "stat") is stat
                }
                groups[prefix + group] = xarray.Dataset(arrays, index)
        stored = self.manifest["scenario"]
        about = {
            "inference_library": "plaus",
            "inference_library_version": self.manifest["plaus"],
            "scene": self.manifest["scene"],
            "scenario": stored["effective"],
            "scenario_hash": stored["hash"],
            "seed": self.seed,
        }
        tree = xarray.DataTree.from_dict(groups)
        tree.attrs.update(about)
        return tree

    def to_inferencedata(self, *, warmup: bool = True) -> Any:
        """The draws for ArviZ: an `InferenceData` for version 0.23, a `DataTree` for 1.x, which has nothing else."""
        import arviz  # type: ignore[import-untyped,unused-ignore]

        tree = self.to_datatree(warmup=warmup)
        read: Any = getattr(arviz, "from_datatree", None)
        return tree if read is None else read(tree)

    def export(
        self,
        path: Path,
        *,
        format: str | None = None,
        samples: Which | Sequence[Which] | None = None,
        fps: float | None = None,
        time_range: tuple[float, float] | None = None,
        until: float | None = None,
        force: bool = False,
    ) -> str:
        """Writes what `plaus export` writes, and gives the path.

        `format` is `csv` or `zarr` (all draws), `glb`, `usda`, `poses`, `events` or `state` (animations of `samples`,
        one or several; by default of every solution); where it is not given, the path's ending says it. Several
        animations make a folder, or one file if the path has an ending: clips of a GLB, variants of a USD prim. They
        end after `until` seconds, or when everything is at rest.
        """
        ending = os.path.splitext(os.fspath(path))[1].lstrip(".").lower()
        chosen = format or ("events" if ending == "json" else ending)
        many: list[Any] = [] if samples is None else [samples] if _is_one(samples) else list(samples)  # type: ignore
        in_one = len(many) != 1 and ending and chosen not in ("csv", "zarr", "poses", "events")
        words = ["export", self.path, "--format", chosen, "--into" if in_one else "--out", os.fspath(path)]
        if chosen not in ("csv", "zarr"):
            if samples is None:
                words.append("--all-distinct")
            for one in many:
                words += ["--sample", str(self._sample(one))]
        elif samples is not None:
            raise ValueError(f"samples go with glb, usda, poses and events: {chosen} holds all draws")
        if fps is not None:
            words += ["--fps", repr(float(fps))]
        if time_range is not None:
            words += ["--time-range", f"{float(time_range[0])!r}:{float(time_range[1])!r}"]
        if until is not None:
            words += ["--until", f"{float(until)!r}s"]
        if force:
            words.append("--force")
        try:
            _plaus.call(words)
        except ValueError as error:
            raise _plaus.RunError(str(error).replace("replace it by `--force`", "pass `force=True`")) from None
        return os.fspath(path)

    def gallery(self, count: int = 64) -> Gallery:
        """A page that plays up to `count` solutions, chosen to differ as much as possible."""
        if not 1 <= count <= 5000:
            raise ValueError(f"count is {count}, but must be from 1 to 5000")
        return Gallery(*self._run.gallery(count))

    def resume(self, **how: Any) -> Run:
        """Continues the run: see `plaus.resume`."""
        from plaus._sampling import resume

        return resume(self, **how)

    def save(self, path: Path) -> Run:
        """Copies the run to the folder `path`, which must not exist; returns the copy."""
        import shutil

        place = os.fspath(path)
        if os.path.lexists(place):
            raise FileExistsError(f"{place} already exists; choose another name")
        shutil.copytree(self.path, place)
        ended = None if self.ending is None else (self.ending, self.seconds or 0.0)
        return Run(place, _ended=ended, _requirement=self.requirement)

    def __repr__(self) -> str:
        warmup, draws, _ = self._run.size()
        kept = "" if not self._folder.fleeting else ", temporary"
        how = f", {self.ending.replace('_', ' ')}" if self.ending else ""
        found = f", {len(self.solutions)} distinct solutions" if draws or self.solutions else ""
        of = f"{self.chains} chains of {draws:,} draws" if draws else f"{self.chains} chains, no draws after their warm-up"
        return f"<Run of {self.manifest['scene']}: {of}{found}{how}{kept}>"


def _is_one(samples: Any) -> bool:
    """Whether this names one sample, and not a list of samples."""
    if isinstance(samples, (str, Sample, Solution)) or hasattr(samples, "__index__"):
        return True
    return isinstance(samples, tuple) and len(samples) == 2 and all(hasattr(part, "__index__") for part in samples)
