"""How likely it is, under its prior, that a scenario does what it asks for."""

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
    """A probability, as estimated by one method."""

    method: str
    """`counting`, `splitting`, `stones` or `importance`."""
    probability: float
    """The estimate."""
    error: float
    """Its standard error; 0 if nothing was seen that would show it."""
    interval: tuple[float, float]
    """95 % confidence interval, if the method has seen every way to the goal."""
    simulations: int
    """Number of simulations that it took."""
    count: int  # type: ignore[assignment]  # Every tuple has a method of that name.
    """Number of draws for `counting`, of batches for the other methods."""


class Disagreement(NamedTuple):
    """Two methods that cannot both be right: one has missed what the other saw, or has not searched long enough."""

    less: str
    """The method that finds less."""
    more: str
    """The method that finds more."""
    factor: float | None
    """How many times as much; None if the other finds nothing."""


class Answer:
    """How likely one thing is: everything that the scenario asks for, or a part of it."""

    def __init__(self, made: dict[str, Any]) -> None:
        self.name: str = made["name"]
        """What it is about."""
        self.estimates: list[Estimate] = [_estimate(one) for one in made["estimates"]]
        """The estimate of each method."""
        self.best: Estimate | None = made["best"] and _estimate(made["best"])
        """The largest estimate of a method that can be relied on; if there is none, the largest of all. None if no batch
        is made yet."""
        self.interval: tuple[float, float] = tuple(made["interval"])
        """What the 95 % intervals of all such methods cover together; from 0 to 1 if no batch is made yet."""
        self.doubts: list[dict[str, Any]] = made["doubts"]
        """Reasons not to trust it, each with its `kind`: `disagreement`, `few_batches`, `few_hits`, `few_ancestors`. If
        there are any, the probability may be higher than the interval."""

    @property
    def probability(self) -> float:
        """The best estimate; NaN if no batch is made yet."""
        return NAN if self.best is None else self.best.probability

    @property
    def error(self) -> float:
        """Its standard error; NaN if no batch is made yet."""
        return NAN if self.best is None else self.best.error

    @property
    def disagreements(self) -> list[Disagreement]:
        """Pairs of methods that cannot both be right: one has missed what the other saw."""
        pairs = (one for one in self.doubts if one["kind"] == "disagreement")
        return [Disagreement(one["less"], one["more"], one["factor"]) for one in pairs]

    @property
    def settled(self) -> bool:
        """Whether nothing speaks against it, as far as is known."""
        return not self.doubts

    def __repr__(self) -> str:
        doubt = "" if self.settled else ", not settled"
        return f"<{type(self).__name__} {self.name}: {self.probability:.3g} ± {self.error:.2g}{doubt}>"


def _estimate(made: dict[str, Any]) -> Estimate:
    return Estimate(**{**made, "interval": tuple(made["interval"])})


class Chance(Answer):
    """How likely it is, under its prior, that a scenario does what it asks for; `parts` has the same for each part.

    `plaus.chance` makes one; `Chance.open` reads one from a file that `plaus.chance` or the command wrote. `str` gives
    the text that the command prints.
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
        """An answer for each thing that is asked for, if there is more than one."""
        self.path: str | None = None if _path is None else os.fspath(_path)
        """The file that holds it."""
        self.ending: str | None = None
        """How the estimation ended: `complete`, `out_of_time`, `interrupted`, `callback`; None for one from a file."""
        self.seconds: float | None = None
        """Seconds that the estimation took this time; None for one from a file."""

    @classmethod
    def open(cls, path: Path) -> Chance:
        """Reads the file of a chance."""
        return cls(_plaus.read_chance(path), _path=path)

    @property
    def batches(self) -> tuple[int, int]:
        """Batches made, and batches planned, of all methods together."""
        return self.facts["batches_done"], self.facts["batches_due"]

    @property
    def methods(self) -> list[str]:
        """The methods used."""
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
    """How far the estimation is: the argument of a callback."""

    def __init__(self, state: dict[str, Any]) -> None:
        self.seconds: float = state["seconds"]
        """Seconds since it began."""
        self.simulations: int = state["simulations"]
        """Simulations since then."""
        self.batches: int = state["batches"]
        """Batches made."""
        self.batches_planned: int = state["batches_planned"]
        """Batches planned, of all methods; 0 until the first one is made."""

    @property
    def share(self) -> float:
        """Share of the batches that is made, in [0, 1]."""
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
    """Estimates how likely it is, under its prior, that a scenario does what it asks for.

    Four methods check each other: `counting` draws from the prior, `splitting` particles that climb the constraint,
    stepping `stones` between prior and target, and `importance` sampling from a widened prior. If `methods` names none,
    counting alone is used if 16 of the first 500 draws hit, and otherwise all that the scenario allows.

    - `out`: a file to keep batches in. If it already holds batches of the same estimate, that estimate is continued: so
      the same call continues after an interruption, and gives the same bytes as one that was never interrupted.
    - `seed`, `set`: as for `sample`. Only what the scenario asks for counts, not a `Requirement`.
    - `batches`: batches of each method (16); four times as many halve the error. `draws`: draws in a batch of counting
      or importance (500). `particles`: particles in a batch of splitting (100). `steps`: steps of each copied particle (20). `rungs`:
      rungs in a batch of stones (10). `iterations`: iterations of each rung (1600), after a quarter as many of warm-up.
    - `max_time`: stop after this many seconds, with the batches made so far; `threads`: 0 means one per core, and no
      result depends on it.
    - `callback`, called a few times a second with a `ChanceProgress`, and `progress`: as for `sample`.

    Ctrl-C returns the estimate from the batches made so far (`Chance.ending` is `"interrupted"`); a second Ctrl-C does
    not wait.

    Raises `ScenarioError` for a wrong scenario, `RunError` if the file holds something else or cannot be written, and
    `ValueError` for numbers out of range and unknown methods.
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
    # Even if it was asked to stop, it may be complete.
    found.ending = "complete" if done == due else why or "stopped"
    found.seconds = seconds
    return found
