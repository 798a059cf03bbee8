"""Sampling, in threads of plaus, while Python waits without holding its lock."""

from __future__ import annotations

import os
import sys
from collections.abc import Callable, Iterable, Mapping
from contextlib import AbstractContextManager, nullcontext
from typing import TYPE_CHECKING, Any, Protocol, TypeVar

from plaus import _plaus
from plaus._numbers import _whole
from plaus._requirement import Requirement
from plaus._run import Run, _Folder, _TemporaryFolder

if TYPE_CHECKING:
    Path = str | os.PathLike[str]

# Seconds between two calls of a callback, and between two updates of the progress line.
_INTERVAL = 0.2


class Progress:
    """How far a run is: the argument of a callback."""

    def __init__(self, state: dict[str, Any]) -> None:
        self.seconds: float = state["seconds"]
        """Seconds since sampling began."""
        self.iterations: list[int] = state["iterations"]
        """Iterations that each chain has done, including the warm-up."""
        self.iterations_planned: int = state["iterations_planned"]
        """Iterations that each chain will do, including the warm-up."""
        self.warmup: int = state["warmup"]
        """Iterations of the warm-up."""
        self.satisfied: list[int] = state["satisfied"]
        """Iterations of each chain that satisfied the constraint."""
        self.distinct: int = state["distinct"]
        """Distinct solutions recorded by all chains; if a number is asked for, those of the warm-up count too."""
        self.solutions_wanted: int | None = state["solutions_wanted"]
        """Number of distinct solutions after which the run stops; None if no number was asked for."""
        before = state["iterations_before"] * len(self.iterations)
        self.per_second: float = max(0, sum(self.iterations) - before) / max(self.seconds, 1e-9)
        """Iterations per second of all chains together."""

    @property
    def share(self) -> float:
        """Share of the planned iterations that is done, in [0, 1]."""
        return min(self.iterations, default=0) / max(1, self.iterations_planned)

    @property
    def _bar(self) -> float:
        """How full the bar is: if solutions are asked for, they count too."""
        found = min(1.0, self.distinct / self.solutions_wanted) if self.solutions_wanted else 0.0
        return max(self.share, found)

    def __str__(self) -> str:
        wanted = f" of {self.solutions_wanted}" if self.solutions_wanted is not None else ""
        return (
            f"{100 * self.share:3.0f} %  {self.per_second:,.0f} iterations/s  {sum(self.satisfied):,} satisfy  "
            f"{self.distinct:,}{wanted} distinct solutions  {self.seconds:.0f} s"
        )

    def __repr__(self) -> str:
        return f"<Progress {self}>"


class _Far(Protocol):
    """Progress as text, and as a bar."""

    @property
    def _bar(self) -> float: ...


class _Shown:
    """Shows progress in a notebook, or on a line of a terminal."""

    def __init__(self, wanted: bool | None) -> None:
        self._display: Any = None
        self._length = 0
        notebook = "ipykernel" in sys.modules
        self._on = wanted if wanted is not None else notebook or sys.stderr.isatty()
        self._notebook = notebook

    def show(self, progress: _Far) -> None:
        """Shows the progress."""
        if not self._on:
            return
        if self._notebook:
            import importlib

            display: Any = importlib.import_module("IPython.display").display

            made = {"text/plain": str(progress), "text/html": _bar(progress)}
            if self._display is None:
                self._display = display(made, raw=True, display_id=True)
            else:
                self._display.update(made, raw=True)
        else:
            text = str(progress)
            sys.stderr.write(f"\r{text:<{self._length}}")
            sys.stderr.flush()
            self._length = len(text)

    def end(self) -> None:
        """Clears the line."""
        if self._length:
            sys.stderr.write("\r" + " " * self._length + "\r")
            sys.stderr.flush()


def _bar(progress: _Far) -> str:
    return (
        f'<progress value="{progress._bar:.4f}" max="1" style="width:16em;vertical-align:middle"></progress> '
        f'<span style="font-variant-numeric:tabular-nums">{progress}</span>'
    )


Made = TypeVar("Made")
Seen = TypeVar("Seen", bound="_Far")


def _watched(
    work: Callable[[Callable[[dict[str, Any]], bool], float], Made],
    kind: Callable[[dict[str, Any]], Seen],
    callback: Callable[[Seen], object] | None,
    progress: bool | None,
    max_time: float | None,
) -> Made:
    """Runs `work` and shows its progress. `work` gets a function to report progress with, and the interval."""
    if callback is not None and not callable(callback):
        raise TypeError(f"callback: a function of the progress is expected, not a {type(callback).__name__}")
    if max_time is not None and not float(max_time) > 0.0:
        raise ValueError(f"max_time is {max_time}, but must be a number of seconds above 0")
    shown = _Shown(progress)
    begun_in = os.getpid()

    def poll(state: dict[str, Any]) -> bool:
        now = kind(state)
        shown.show(now)
        return callback is None or callback(now) is not False

    try:
        return work(poll, _INTERVAL)
    finally:
        if os.getpid() == begun_in:
            shown.end()


def _required(requirement: Requirement | Callable[..., Any] | None) -> Requirement | None:
    if requirement is None or isinstance(requirement, Requirement):
        return requirement
    return Requirement(requirement)


def _go(
    scenario: _plaus.Scenario | None,
    folder: _Folder,
    requirement: Requirement | None,
    callback: Callable[[Progress], object] | None,
    progress: bool | None,
    **how: Any,
) -> Run:
    asked = None
    others: AbstractContextManager[Any] = nullcontext()
    if requirement is not None:
        asked = requirement._asked
        others = requirement._asking(
            scenario.set(*how["overrides"]) if scenario is not None else Run(folder.path).scenario
        )
    def work(poll: Callable[[dict[str, Any]], bool], interval: float) -> tuple[str, float]:
        with others as by:
            return _plaus.sample(
                scenario,
                folder.path,
                fleeting=folder.fleeting,
                asked=asked,
                others=by and by.ask,
                poll=poll,
                interval=interval,
                **how,
            )

    ending, seconds = _watched(work, Progress, callback, progress, how["max_time"])
    return Run(folder.path, _folder=folder, _ended=(ending, seconds), _requirement=requirement)


def sample(
    scenario: _plaus.Scenario | Path | Mapping[str, Any],
    *,
    out: Path | None = None,
    seed: int | None = None,
    chains: int | None = None,
    iterations: int | None = None,
    warmup: int | None = None,
    thin: int | None = None,
    solutions: int | None = None,
    set: Iterable[str] = (),
    max_time: float | None = None,
    threads: int = 0,
    requirement: Requirement | Callable[..., Any] | None = None,
    callback: Callable[[Progress], object] | None = None,
    progress: bool | None = None,
) -> Run:
    """Samples animations of a scenario: a `Scenario`, the path of a file, or dictionaries.

    The run is a folder, `out`, which must not exist. Without `out`, the folder is temporary and is deleted with the
    `Run`, unless `Run.save` keeps it. The same scenario, seed and version give the same bytes, here and on the command
    line.

    - `seed`, `chains`, `iterations` (of each chain after the warm-up), `warmup`, `thin`: as in the scenario's
      `[sampler]`; `set`: any keys, such as `"sigma_d=0.05"`.
    - `solutions`: stop once this many distinct solutions are recorded, including those of the warm-up.
    - `max_time`: stop after this many seconds; `threads`: 0 means one per core, and no result depends on it.
    - `requirement`: a `Requirement`, or a function to make one of.
    - `callback`: called a few times a second with a `Progress`; if it returns False, the run stops. An exception in it
      also stops the run, and is raised here.
    - `progress`: whether to show progress; by default it is shown on terminals and in notebooks.

    Ctrl-C stops the run and returns what was found so far (`Run.ending` is `"interrupted"`); a second Ctrl-C does not
    wait.

    Raises `ScenarioError` for a wrong scenario, and `RunError` if the folder exists or a chain fails. Exceptions of a
    requirement are raised with a note that names the chain and the iteration.
    """
    made = _scenario_of(scenario)
    numbers = {
        "seed": (seed, 0),
        "chains": (chains, 1),
        "iterations": (iterations, 1),
        "warmup": (warmup, 0),
        "thin": (thin, 1),
    }
    wanted = {key: _whole(key, value, least) for key, (value, least) in numbers.items()}
    if isinstance(set, str):
        set = [set]
    overrides = [*set, *(f"sampler.{key}={value}" for key, value in wanted.items() if value is not None)]
    folder = _TemporaryFolder() if out is None else _Folder(out)
    return _go(
        made,
        folder,
        _required(requirement),
        callback,
        progress,
        overrides=overrides,
        solutions=_whole("solutions", solutions, 1),
        iterations=None,
        threads=_whole("threads", threads, 0),
        max_time=max_time,
    )


def resume(
    run: Run | Path,
    *,
    iterations: int | None = None,
    solutions: int | None = None,
    max_time: float | None = None,
    threads: int = 0,
    requirement: Requirement | Callable[..., Any] | None = None,
    callback: Callable[[Progress], object] | None = None,
    progress: bool | None = None,
) -> Run:
    """Continues a run from its last checkpoint, to its planned end, or to a total of `iterations` or `solutions`.

    The result has the same bytes as a run that was never interrupted. A run with a requirement needs the same one
    again.
    """
    required = _required(requirement)
    if isinstance(run, Run):
        folder, required = run._folder, required or run.requirement
    else:
        folder = _Folder(run)
    return _go(
        None,
        folder,
        required,
        callback,
        progress,
        overrides=[],
        solutions=_whole("solutions", solutions, 1),
        iterations=_whole("iterations", iterations, 1),
        threads=_whole("threads", threads, 0),
        max_time=max_time,
    )


def _scenario_of(scenario: Any) -> _plaus.Scenario:
    if isinstance(scenario, _plaus.Scenario):
        return scenario
    if isinstance(scenario, Mapping):
        return _plaus.Scenario.from_dict(dict(scenario))
    if isinstance(scenario, (str, os.PathLike)):
        return _plaus.Scenario.from_file(scenario)
    raise TypeError(
        f"a scenario is a plaus.Scenario, the path of a file, or dictionaries, not a {type(scenario).__name__}"
    )
