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
    "recognize",
    "convex_pieces",
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
    """Everything that is wrong; the other attributes are those of the first problem."""
    message: str
    """What is wrong."""
    key: str
    """The key at fault, dotted from the root; empty if the text is not TOML."""
    line: int | None
    """Line in the text, from 1."""
    column: int | None
    """Column in characters, from 1."""
    hint: str | None
    """How to mend it, if that is known."""

class RunError(RuntimeError):
    """A run that cannot be made, read or continued."""

class WorldError(ValueError):
    """A world, or a start in it, that cannot be simulated."""

@final
class Problem:
    """One thing that is wrong with a scenario."""

    key: str
    """The key at fault, dotted from the root; empty if the text is not TOML."""
    message: str
    """What is wrong, with the allowed range if there is one."""
    hint: str | None
    """How to mend it, if that is known."""
    line: int | None
    """Line in the text, from 1; None for overrides and for tables that the text lacks."""
    column: int | None
    """Column in characters, from 1."""
    said: str | None
    """The override at fault, as `key=value`; None for the text itself."""

def _scenario(
    text: str, name: str, overrides: Sequence[str], files: Sequence[tuple[str, bytes]] = ...
) -> Scenario:
    """Restores a pickled scenario, with the files that it names."""

@final
class Scenario:
    """A scenario: a world, what must happen in it, and how it is sampled.

    `from_file`, `from_text`, `from_dict` and `default` read and check it. They raise one `ScenarioError` with
    everything that is wrong. A scenario never changes; `set` returns another one.
    """

    def __new__(cls, *_given: Any, **_named: Any) -> Self:
        """Says how to make one."""
    @staticmethod
    def from_file(path: str | os.PathLike[str]) -> Scenario:
        """Reads a scenario file (TOML)."""
    @staticmethod
    def from_text(text: str, name: str = "scenario.toml") -> Scenario:
        """Reads the text of a scenario file; `name` is its name in messages and in runs."""
    @staticmethod
    def from_dict(tables: Mapping[str, Any], name: str = "scenario.toml") -> Scenario:
        """A scenario from nested dictionaries, like the tables of a file: `{"world": {"ball2d": {"target": 2}}}`."""
    @staticmethod
    def default(scene: str) -> Scenario:
        """The scenario of a scene (`ball2d`, `bowling`, `dice`, `spelling`) with all settings at their defaults."""
    def set(self, *overrides: str, **keys: Any) -> Scenario:
        """The same scenario with some keys changed: `set("sigma_d=0.05")` as on the command line, or
        `set(sigma_d=0.05)`, or `set(**{"weights.aim": 2})`. A key is a full dotted name, or a unique ending of it."""
    def check(self, *, draws: int | None = None) -> dict[str, Any]:
        """Every key with its value, including defaults, as nested dictionaries. Errors were raised when the scenario
        was made.

        With `draws`: draws this many animations from the prior. Returns how many of them met each requirement, the best
        margin of each, and pairs that were never met together: what `plaus check --draws N --json` prints."""
    @property
    def toml(self) -> str:
        """Every key with its value, as the text of a scenario file."""
    @property
    def scene(self) -> str:
        """The scene's name."""
    @property
    def text(self) -> str:
        """The text that it was read from, without the keys set since."""
    @property
    def name(self) -> str:
        """The name of the text."""
    @property
    def overrides(self) -> list[str]:
        """Keys set since, as `key=value`."""

@final
class Outcome:
    """The outcome of a candidate, which a requirement judges.

    Scalars are available at once; motion and impacts are made when they are first used. Once a function has used them,
    they come from the simulation that runs anyway, if the scene keeps it, and otherwise from a further simulation.
    """

    def __getitem__(self, name: str, /) -> float:
        """One of the scene's scalars: `outcome["rest_x"]`."""
    @property
    def scalars(self) -> dict[str, float]:
        """The scene's scalars by name, as in the table of draws."""
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
        """The motion of all bodies, without the scenery."""
    @property
    def bodies(self) -> list[str]:
        """Names of the bodies."""
    @property
    def rest(self) -> dict[str, list[float]]:
        """Position of each body at the end, by name: x, y, z in m, y up."""
    @property
    def rest_orientation(self) -> dict[str, list[float]]:
        """Orientation of each body at the end, by name: a unit quaternion x, y, z, w from its axes to the world's."""

@final
class Parcels:
    """Opens outcomes of one scenario that came from another process."""

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
        `fps` frames per second; NaN where a body has not appeared."""
    def to_json(self) -> str:
        """The whole motion, in closed-form pieces, as JSON."""

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
        """Numbers of each chain: draws of the warm-up, draws after it, and iterations done."""
    def chains(self) -> tuple[int, int]:
        """Numbers of the chains that the folder holds: the first, and one past the last."""
    def is_being_written(self) -> bool:
        """Whether another process is writing the run now, as far as is known."""
    def columns(self, warmup: bool) -> list[tuple[str, str, str, Any]]:
        """Columns of a phase: name, unit, role, and an array (chain, draw)."""
    def solutions(self) -> list[tuple[int, int, int, float, bool]]:
        """The first draw of each distinct solution: chain, draw, iteration, log p, whether it is from the warm-up."""
    def most_different(self, count: int) -> list[tuple[int, int, int, float, bool]]:
        """Up to `count` distinct solutions: the likeliest, then always the one that looks least like those before."""
    def replay(self, samples: Sequence[tuple[int, int, bool]], accuracy: str | None = None) -> list[tuple[str, Motion]]:
        """Simulates samples again: what is known of each, as JSON, and its motion."""
    def gallery(self, count: int) -> tuple[str, int, int]:
        """A page that plays solutions, how many it shows, and how many there are."""
    def diagnose(self, most: int | None = None) -> str:
        """What `plaus diagnose --json` prints."""

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
    """Samples into `folder`, or continues the run there if `scenario` is None; returns how it ended, and seconds."""

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
    """Estimates how likely it is that a scenario does what it asks for. Returns what is known (JSON, words, the
    scenario's name and text), why it was stopped, and seconds."""

def read_chance(path: str | os.PathLike[str]) -> tuple[str, str, str, str]:
    """Reads the file of an estimate."""

def recognize(
    vertices: Any, triangles: Any, tolerance: float
) -> tuple[str, list[float], NDArray[np.float64], NDArray[np.float64], float, float] | None:
    """The solid that a mesh is: kind, sizes, middle, axes, deviations of vertices and of the surface."""

def convex_pieces(vertices: Any, triangles: Any) -> tuple[list[NDArray[np.float64]], float, float] | None:
    """The convex pieces of a hollow mesh: their corners, how far they stand out of the mesh, and it out of them."""

def command(arguments: Sequence[str]) -> int:
    """Runs a command line, whose first word is the program's name, and returns the exit code."""

def call(arguments: Sequence[str]) -> None:
    """Runs a command line that begins without the program's name; raises errors."""

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
        """The world of a scenario without its randomness."""
    @property
    def places(self) -> list[list[float]]:
        """Places where bodies can start, one in each row; none for a world that the user built."""
    @property
    def bodies(self) -> int:
        """Number of bodies."""
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
        """Runs from every start, on all threads; returns arrays by name."""

@final
class Rng:
    """Random numbers of one iteration: the same for the same seed, chain and iteration, whatever else is drawn."""

    def __new__(cls, seed: int) -> Self:
        """Random numbers of a seed, outside any chain."""
    def uniform(self, low: float = 0.0, high: float = 1.0) -> float:
        """Uniform between `low` and `high`, excluding both."""
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
    """The findings of checks of moves. True if there are none; as text, the findings."""

    passed: bool
    """Whether nothing was found."""
    text: str
    """What each check found, in words."""
    p: float
    """Smallest p-value of the statistical checks."""
    accepted: float
    """Share of candidates accepted in them: a move that is never accepted has not been tested."""
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
    """Checks moves: that ratios match those of the reverse steps, and that a step preserves the law of exact draws."""

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
    """Samples a target; returns arrays by name."""
