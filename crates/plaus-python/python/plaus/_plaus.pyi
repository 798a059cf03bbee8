"""Compiled parts of plaus. Use the package."""

import os
from collections.abc import Callable, Mapping, Sequence
from typing import Any, Self, final

import numpy as np
from numpy.typing import NDArray

__all__ = [
    "chance",
    "read_chance",
    "Problem",
    "RunError",
    "ScenarioError",
    "WorldError",
    "Motion",
    "Parcels",
    "Asked",
    "Outcome",
    "RunFolder",
    "sample",
    "_scenario",
    "Scenario",
    "SimWorld",
    "CheckReport",
    "Functions",
    "Kernel",
    "Rng",
    "check",
    "sample_target",
    "command",
    "call",
    "__version__",
]

__version__: str

class ScenarioError(ValueError):
    """A scenario that cannot be sampled."""

    problems: list[Problem]
    """All that is wrong; the other attributes are those of the first."""
    message: str
    """What is wrong."""
    key: str
    """The key to blame, dotted from the root; empty where the text is no TOML."""
    line: int | None
    """Line in the text, from 1."""
    column: int | None
    """Column in characters, from 1."""
    hint: str | None
    """What would mend it, if that is known."""

class RunError(RuntimeError):
    """A run that cannot be made, read or gone on with."""

class WorldError(ValueError):
    """A world, or a start in it, that cannot be simulated."""

@final
class Problem:
    """One thing that is wrong with a scenario."""

    key: str
    """The key to blame, dotted from the root; empty where the text is no TOML."""
    message: str
    """What is wrong, with the allowed range where there is one."""
    hint: str | None
    """What would mend it, if that is known."""
    line: int | None
    """Line in the text, from 1; None for overrides and for tables that the text lacks."""
    column: int | None
    """Column in characters, from 1."""
    said: str | None
    """The override that said so, as `key=value`; None for the text itself."""

def _scenario(
    text: str, name: str, overrides: Sequence[str], files: Sequence[tuple[str, bytes]] = ...
) -> Scenario:
    """A scenario as it was pickled, with the files that it names."""

@final
class Scenario:
    """A scenario: a world, what must happen in it, and how it is sampled.

    Made by `from_file`, `from_text`, `from_dict` or `default`, which read and check it: what is wrong is raised as
    `ScenarioError`, all of it at once. A scenario never changes; `set` gives another one.
    """

    @staticmethod
    def from_file(path: str | os.PathLike[str]) -> Scenario:
        """Reads a scenario file (TOML)."""
    @staticmethod
    def from_text(text: str, name: str = "scenario.toml") -> Scenario:
        """Reads the text of a scenario file; `name` is what it is called in messages and in runs."""
    @staticmethod
    def from_dict(tables: Mapping[str, Any], name: str = "scenario.toml") -> Scenario:
        """A scenario from nested dictionaries, as the tables of a file are: `{"world": {"ball2d": {"target": 2}}}`."""
    @staticmethod
    def default(scene: str) -> Scenario:
        """The scenario of a scene (`ball2d`, `bowling`, `dice`, `spelling`) with all settings at their defaults."""
    def set(self, *overrides: str, **keys: Any) -> Scenario:
        """The same with some keys changed: `set("sigma_d=0.05")` as on the command line, or `set(sigma_d=0.05)`, or
        `set(**{"weights.aim": 2})`. A key is a full dotted name or an end of it that no other key has."""
    def check(self, *, draws: int | None = None) -> dict[str, Any]:
        """Every key with the value in force, defaults too, as nested dictionaries. What is wrong was raised when the
        scenario was made.

        With `draws`: so many animations are drawn from the prior, and what comes back is how many of them met each
        thing that is asked, the best margin of each, and pairs that were never met together: what `plaus check --draws
        N --json` prints."""
    @property
    def toml(self) -> str:
        """Every key with the value in force, as the text of a scenario file."""
    @property
    def scene(self) -> str:
        """The scene's name."""
    @property
    def text(self) -> str:
        """The text that it was read from, without what was set since."""
    @property
    def name(self) -> str:
        """What the text is called."""
    @property
    def overrides(self) -> list[str]:
        """Keys set since, as `key=value`."""

@final
class Outcome:
    """What came of a candidate: what a requirement judges.

    Numbers are at hand; motion and impacts are made when they are first asked for. A function that asked for them once
    gets them from the simulation that was run anyway, where the scene keeps it; else by simulating once more.
    """

    def __getitem__(self, name: str, /) -> float:
        """One of the scene's numbers: `outcome["rest_x"]`."""
    @property
    def scalars(self) -> dict[str, float]:
        """The scene's numbers by name, as in the table of draws."""
    @property
    def log_prior(self) -> float:
        """Log prior density of the draw, up to a constant."""
    @property
    def log_constraint(self) -> float:
        """Log constraint of the scenario alone, up to a constant."""
    @property
    def satisfied(self) -> bool:
        """Whether the scenario's own constraint is satisfied."""
    @property
    def motion(self) -> Motion:
        """The motion of all bodies, without what stands still around them."""
    @property
    def bodies(self) -> list[str]:
        """Names of the bodies."""
    @property
    def rest(self) -> dict[str, list[float]]:
        """Where each body is at the end, by name: x, y, z in m, y up."""
    @property
    def rest_orientation(self) -> dict[str, list[float]]:
        """How each body is turned at the end, by name: a unit quaternion x, y, z, w from its axes to the world's."""

@final
class Parcels:
    """Opens outcomes that came from another process, of one scenario."""

    def __new__(cls, scenario: Scenario) -> Self: ...
    def open(self, parcel: bytes) -> Outcome:
        """The outcome in a parcel."""

@final
class Motion:
    """The motion of all bodies of one sample."""

    @property
    def duration(self) -> float:
        """Seconds."""
    @property
    def bodies(self) -> list[str]:
        """Names of the bodies."""
    @property
    def events(self) -> dict[str, Any]:
        """Impacts in order of time, as columns: t (s), body, other, point (m), normal, speed (m/s), impulse (N s)."""
    def poses(self, fps: float = 60.0, times: list[float] | None = None) -> list[NDArray[np.float64]]:
        """Times (s), positions (time, body, xyz; m, y up) and unit quaternions (time, body, xyzw) at `times`, or at
        `fps` frames a second."""
    def to_json(self) -> str:
        """The motion whole, in closed-form pieces, as JSON."""

@final
class Asked:
    """A requirement, with what it has cost."""

    def __new__(cls, function: Callable[[Outcome], Any], name: str, most: float | None) -> Self: ...
    @property
    def cost(self) -> tuple[int, float, float]:
        """Calls, seconds spent in them, and seconds that chains waited for their turn."""

@final
class RunFolder:
    """A run in a folder."""

    def __new__(cls, path: str | os.PathLike[str], salvage: bool = False) -> Self: ...
    def manifest(self) -> str:
        """What the run is, as JSON."""
    def size(self) -> tuple[int, int, int]:
        """Draws of the warm-up and of the sampling phase that each chain has, and iterations done."""
    def chains(self) -> tuple[int, int]:
        """Numbers of the chains that the folder holds: the first, and one past the last."""
    def is_being_written(self) -> bool:
        """Whether another process is writing the run now, as far as can be told."""
    def columns(self, warmup: bool) -> list[tuple[str, str, str, Any]]:
        """Columns of a phase: name, unit, role, and an array (chain, draw)."""
    def solutions(self) -> list[tuple[int, int, int, float, bool]]:
        """The first draw of each distinct solution: chain, draw, iteration, log p, and whether it is of the warm-up."""
    def replay(self, samples: Sequence[tuple[int, int, bool]], accuracy: str | None = None) -> list[tuple[str, Motion]]:
        """What is known of samples that are simulated again, as JSON, and their motions."""
    def gallery(self, count: int) -> tuple[str, int, int]:
        """A page that plays solutions, how many it shows, and how many there are."""
    def diagnose(self, most: int | None = None) -> str:
        """What `plaus diagnose --json` says."""

def sample(
    scenario: Scenario | None,
    folder: str | os.PathLike[str],
    *,
    overrides: Sequence[str],
    solutions: int | None,
    iterations: int | None,
    threads: int | None,
    fleeting: bool,
    max_time: float | None,
    asked: Asked | None,
    others: Callable[[bytes], tuple[float, object]] | None,
    poll: Callable[[dict[str, Any]], bool] | None,
    interval: float,
) -> tuple[str, float]:
    """Samples into `folder`, or goes on with the run there where `scenario` is None; gives how it ended, and
    seconds."""

def chance(
    scenario: Scenario,
    *,
    overrides: Sequence[str],
    numbers: Mapping[str, int | None],
    methods: Sequence[str],
    out: str | os.PathLike[str] | None,
    threads: int | None,
    max_time: float | None,
    poll: Callable[[dict[str, Any]], bool] | None,
    interval: float,
) -> tuple[tuple[str, str, str, str], str | None, float]:
    """Asks how likely what a scenario demands is; gives what is known (JSON, words, the scenario's name and text), why
    it was stopped, and seconds."""

def read_chance(path: str | os.PathLike[str]) -> tuple[str, str, str, str]:
    """Reads a file that an inquiry was kept in."""

def command(arguments: Sequence[str]) -> int:
    """Does what a command line says, its first word being the program's name, and gives the exit code."""

def call(arguments: Sequence[str]) -> None:
    """Does what a command line without the program's name says; what is wrong is raised."""

@final
class SimWorld:
    """A world that can be run."""

    def __new__(
        cls,
        bodies: Sequence[dict[str, Any]],
        surfaces: Sequence[dict[str, Any]],
        laws: Sequence[dict[str, Any]],
        *,
        engine: str,
        materials: int,
        gravity: Sequence[float],
        duration: float,
        accuracy: str,
        events: int | None,
    ) -> Self: ...
    @staticmethod
    def bins(count: int, duration: float, accuracy: str, events: int | None) -> SimWorld:
        """Marbles over the bins of the paper's figure 10."""
    @staticmethod
    def dice(count: int, accuracy: str, events: int | None) -> SimWorld:
        """Dice of 16 mm on a flat table."""
    @staticmethod
    def of_scenario(scenario: Scenario) -> SimWorld:
        """The world of a scenario, with all that is random left out."""
    @property
    def places(self) -> list[list[float]]:
        """Where bodies may start, one a row; none where the world was built by hand."""
    @property
    def bodies(self) -> int:
        """How many bodies there are."""
    def run(
        self,
        position: Any,
        *,
        velocity: Any,
        spin: Any,
        orientation: Any,
        release: Any,
        until: float,
        times: Sequence[float],
        events: bool,
        threads: int | None,
    ) -> dict[str, Any]:
        """Runs from every start, on all threads; arrays by name."""

@final
class Rng:
    """Random numbers of one iteration: the same for the same seed, chain and iteration, whatever else is drawn."""

    def __new__(cls, seed: int) -> Self:
        """Numbers of a seed, outside of any chain."""
    def uniform(self, low: float = 0.0, high: float = 1.0) -> float:
        """Uniform between `low` and `high`, without the ends."""
    def normal(self, mean: float = 0.0, sd: float = 1.0) -> float:
        """Normal with this mean and standard deviation."""
    def below(self, count: int) -> int:
        """A whole number from 0 to `count` - 1, each equally likely."""

@final
class Functions:
    """The functions of a target."""

    def __new__(cls, start: Any, log_prior: Any, log_density: Any, met: Any) -> Self: ...

@final
class Kernel:
    """A move: what it proposes, and how much likelier the way back is."""

    def __new__(cls, name: str, weight: float, propose: Any, log_ratio: Any) -> Self: ...

@final
class CheckReport:
    """What checks of moves found. True where that is nothing; as text, what it is."""

    passed: bool
    """Whether nothing was found."""
    text: str
    """What each check found, in words."""
    p: float
    """Smallest p-value of the statistical checks."""
    accepted: float
    """Share of candidates that were accepted in them: a move that is never accepted has not been tested."""
    def __bool__(self) -> bool: ...

def check(
    functions: Functions,
    kernels: Sequence[Kernel],
    *,
    dimensions: int,
    samples: int | None,
    pairs: int | None,
    seed: int | None,
    false_alarm: float,
    bound: float | None,
) -> CheckReport:
    """Checks moves: their ratios against each other, and that a step from exact draws leaves the law of exact draws."""

def sample_target(
    functions: Functions,
    kernels: Sequence[Kernel],
    *,
    chains: int | None,
    warmup: int | None,
    iterations: int | None,
    seed: int | None,
    solutions: int | None,
) -> dict[str, Any]:
    """Samples a target; arrays by name."""
