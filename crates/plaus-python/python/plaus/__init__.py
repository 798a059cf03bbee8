"""Tell a physical world what must happen, and get many different plausible ways in which it could.

    import plaus

    strikes = plaus.sample(plaus.Scenario.default("bowling"), solutions=12)
    strikes.gallery()

A `Scenario` says what must happen. `sample` draws animations from the distribution of all that fit, by Markov chain
Monte Carlo, and returns a `Run`: draws as arrays, solutions with their motion and impacts, a page that plays them.
`chance` estimates how likely it is that a random animation does what a scenario asks. A `Requirement` is a function of
yours that asks for what no scenario file can express. `plaus.sim` is the simulator alone. `recognize` tells which
solid a mesh is, and `convex_pieces` cuts a hollow one.

Lengths are metres, times seconds, angles radians unless a name says otherwise (`offset_mm`); y points up in motions.
"""

from typing import TYPE_CHECKING

from plaus._plaus import (
    CheckReport,
    Outcome,
    Problem,
    Rng,
    RunError,
    Scenario,
    ScenarioError,
    WorldError,
    __version__,
)
from plaus._chance import Answer, Chance, ChanceProgress, Disagreement, Estimate, chance
from plaus._motion import Events, Poses, Replay
from plaus._requirement import Requirement
from plaus._run import Gallery, Run, Sample, Solution, Table
from plaus._sampling import Progress, resume, sample
from plaus._shapes import ConvexPieces, Recognized, convex_pieces, recognize
from plaus._target import Move, Target, TargetRun, check_moves, sample_target

__all__ = [
    "Answer",
    "Chance",
    "ChanceProgress",
    "CheckReport",
    "ConvexPieces",
    "Disagreement",
    "Estimate",
    "Events",
    "Gallery",
    "Move",
    "Outcome",
    "Poses",
    "Problem",
    "Progress",
    "Recognized",
    "Replay",
    "Requirement",
    "Rng",
    "Run",
    "RunError",
    "Sample",
    "Scenario",
    "ScenarioError",
    "Solution",
    "Table",
    "Target",
    "TargetRun",
    "WorldError",
    "__version__",
    "chance",
    "check_moves",
    "convex_pieces",
    "recognize",
    "resume",
    "sample",
    "sample_target",
]


if TYPE_CHECKING:
    from plaus import sim as sim
else:

    def __getattr__(name: str) -> object:
        # The simulator is loaded when it is first asked for: `import plaus` stays quick.
        if name == "sim":
            import importlib

            return importlib.import_module("plaus.sim")
        raise AttributeError(f"module 'plaus' has no attribute {name!r}")
