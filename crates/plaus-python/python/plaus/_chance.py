"""How likely what a scenario demands is, before it is demanded."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterable, Mapping
from typing import TYPE_CHECKING, Any, NamedTuple

from plaus import _plaus
from plaus._numbers import _whole
from plaus._sampling import _scenario_of, _watched

if TYPE_CHECKING:
    Path = str | os.PathLike[str]


NAN = float("nan")


class Estimate(NamedTuple):
    """A probability as one method has it."""

    method: str
    """`counting`, `splitting` or `stones`."""
    probability: float
    """The estimate."""
    error: float
    """Its standard error; 0 where nothing was seen that tells it."""
    interval: tuple[float, float]
    """Where the probability lies, with 95 % confidence if the method has seen every way to the goal."""
    simulations: int
    """Simulations that it took."""
    count: int  # type: ignore[assignment]  # Every tuple has a method of that name.
    """Draws where it was counted, else batches."""


class Disagreement(NamedTuple):
    """Two methods that cannot both be right: one has missed what the other has seen, or has not looked long enough."""

    less: str
    """The method that finds less."""
    more: str
    """The method that finds more."""
    factor: float | None
    """How many times as much; None where the other finds nothing."""


class Answer:
    """How likely one thing is: all that is demanded, or a part of it."""

    def __init__(self, made: dict[str, Any]) -> None:
        self.name: str = made["name"]
        """What."""
        self.estimates: list[Estimate] = [_estimate(one) for one in made["estimates"]]
        """What each method says."""
        self.best: Estimate | None = made["best"] and _estimate(made["best"])
        """The one with the smallest relative error; where methods disagree, the largest. None where no batch is
        made."""
        self.disagreements: list[Disagreement] = [Disagreement(**one) for one in made["disagreements"]]
        """Which methods cannot both be right: one has missed what the other has seen."""
        self.lopsided: list[str] = made["lopsided"]
        """Methods whose estimate rests on one batch for more than half: more batches are needed."""

    @property
    def probability(self) -> float:
        """The best estimate; NaN where no batch is made."""
        return NAN if self.best is None else self.best.probability

    @property
    def error(self) -> float:
        """Its standard error; NaN where no batch is made."""
        return NAN if self.best is None else self.best.error

    @property
    def interval(self) -> tuple[float, float]:
        """Where the probability lies with 95 % confidence, by the best estimate; all of 0 to 1 where no batch is
        made."""
        return (0.0, 1.0) if self.best is None else self.best.interval

    @property
    def agrees(self) -> bool:
        """Whether the methods agree, as far as can be told."""
        return not self.disagreements

    def __repr__(self) -> str:
        doubt = "" if self.agrees else ", methods disagree"
        return f"<{type(self).__name__} {self.name}: {self.probability:.3g} ± {self.error:.2g}{doubt}>"


def _estimate(made: dict[str, Any]) -> Estimate:
    return Estimate(**{**made, "interval": tuple(made["interval"])})


class Chance(Answer):
    """How likely all that a scenario demands is under its prior, and each part of it in `parts`.

    `plaus.chance` gives one; `Chance.open` reads one from a file that it, or the command, kept it in. As text it is
    what the command prints.
    """

    def __init__(
        self,
        known: tuple[str, str, str, str],
        *,
        _path: Path | None = None,
    ) -> None:
        import json  # `import plaus` stays quick

        self.facts: dict[str, Any] = json.loads(known[0])
        """What `plaus chance --json` prints."""
        self._text, self._file, self._effective = known[1:]
        super().__init__(self.facts["answers"][0])
        self.parts: list[Answer] = [Answer(made) for made in self.facts["answers"][1:]]
        """Each thing that is demanded by itself, where it is more than one."""
        self.path: str | None = None if _path is None else os.fspath(_path)
        """The file that it is kept in."""
        self.ending: str | None = None
        """How asking ended: `complete`, `out_of_time`, `interrupted`, `callback`; None where it was opened."""
        self.seconds: float | None = None
        """Seconds that asking took this time; None where it was opened."""

    @classmethod
    def open(cls, path: Path) -> Chance:
        """Reads the file of a chance."""
        return cls(_plaus.read_chance(path), _path=path)

    @property
    def batches(self) -> tuple[int, int]:
        """Batches that are made, and that are to be, of all methods together."""
        return self.facts["batches_done"], self.facts["batches_due"]

    @property
    def methods(self) -> list[str]:
        """Methods that are used."""
        return list(self.facts["methods"])

    @property
    def why(self) -> str:
        """Why these methods are used."""
        return str(self.facts["why"])

    @property
    def seed(self) -> int:
        """Seed of all randomness."""
        return int(self.facts["asking"]["seed"])

    @property
    def scenario(self) -> _plaus.Scenario:
        """The scenario in force."""
        return _plaus.Scenario.from_text(self._effective, self._file)

    def __str__(self) -> str:
        return self._text


class ChanceProgress:
    """How far a chance is; what a callback gets."""

    def __init__(self, state: dict[str, Any]) -> None:
        self.seconds: float = state["seconds"]
        """Seconds since asking began."""
        self.simulations: int = state["simulations"]
        """Simulations made since."""
        self.batches: int = state["batches"]
        """Batches that are made."""
        self.batches_planned: int = state["batches_planned"]
        """Batches that are to be made, of all methods; 0 until the first is."""

    @property
    def share(self) -> float:
        """Done share of the batches, in [0, 1]."""
        return self.batches / max(1, self.batches_planned)

    @property
    def _bar(self) -> float:
        return self.share

    def __str__(self) -> str:
        pace = self.simulations / max(self.seconds, 1e-9)
        far = f"{self.batches} of {self.batches_planned} batches  " if self.batches_planned else ""
        return f"{100 * self.share:3.0f} %  {far}{pace:,.0f} simulations/s  {self.seconds:.0f} s"

    def __repr__(self) -> str:
        return f"<ChanceProgress {self}>"


def chance(
    scenario: _plaus.Scenario | Path | Mapping[str, Any],
    *,
    out: Path | None = None,
    seed: int | None = None,
    set: Iterable[str] = (),
    methods: Iterable[str] = (),
    batches: int | None = None,
    draws: int | None = None,
    particles: int | None = None,
    steps: int | None = None,
    rungs: int | None = None,
    iterations: int | None = None,
    max_time: float | None = None,
    threads: int = 0,
    callback: Callable[[ChanceProgress], object] | None = None,
    progress: bool | None = None,
) -> Chance:
    """Estimates how likely what a scenario demands is under its prior, before it is demanded.

    Three methods, held against each other: `counting` draws of the prior, `splitting` particles that climb the
    constraint, stepping `stones` between prior and target. Unless `methods` names some, counting alone where 16 of the
    first 500 draws hit, else all three.

    - `out`: a file that batches are kept in. Where it holds some of this very asking, it is gone on with: the same call
      again goes on after an interruption, and gives the same bytes as one that was never interrupted.
    - `seed`, `set`: as for `sample`. A requirement of your own plays no part: only what the scenario demands does.
    - `batches` of each method (16): four times as many halve the error; `draws` of the prior that a batch counts (500);
      `particles` of a batch of splitting (100), `steps` that a copied one makes (20); `rungs` of a batch of stones
      (10), `iterations` of each (1600), after a quarter as many of warm-up.
    - `max_time`: stop after so many seconds with the batches that are made; `threads`: 0 is one a core, and no result
      depends on it.
    - `callback`, called a few times a second with a `ChanceProgress`, and `progress`: as for `sample`.

    Ctrl-C gives what the batches say that were made until then (`Chance.ending` is `"interrupted"`); a second one does
    not wait.

    Raises `ScenarioError` for a wrong scenario, `RunError` where the file holds something else or cannot be written,
    `ValueError` for numbers out of range and methods that there are not.
    """
    made = _scenario_of(scenario)
    seeded = _whole("seed", seed, 0)
    given = {
        "batches": batches,
        "draws": draws,
        "particles": particles,
        "steps": steps,
        "rungs": rungs,
        "iterations": iterations,
    }
    overrides = [set] if isinstance(set, str) else [*set]
    if seeded is not None:
        overrides.append(f"sampler.seed={seeded}")

    def ask(poll: Callable[[dict[str, Any]], bool], interval: float) -> Any:
        return _plaus.chance(
            made,
            overrides=overrides,
            numbers={name: _whole(name, number, 1) for name, number in given.items()},
            methods=[methods] if isinstance(methods, str) else [*methods],
            out=out,
            threads=_whole("threads", threads, 0),
            max_time=max_time,
            poll=poll,
            interval=interval,
        )

    known, why, seconds = _watched(ask, ChanceProgress, callback, progress, max_time)
    found = Chance(known, _path=out)
    done, due = found.batches
    # What was asked to stop may be done all the same.
    found.ending = "complete" if done == due else why or "stopped"
    found.seconds = seconds
    return found
