"""Targets written in Python, for toy problems: sampled by plaus's chains, checked by plaus's checks."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING, Any, Union

from plaus import _plaus

if TYPE_CHECKING:
    import numpy as np
    import xarray
    from numpy.typing import NDArray

    Point = NDArray[np.float64]
    Given = Union[float, Sequence[float], Point]
    Met = Callable[[Point], Union[bool, int, Sequence[int], None]]


class Target:
    """A distribution over points: a prior times a density, each given by a function.

    - `start(rng)` draws a point, usually from the prior itself. It uses an `Rng`, so that runs can be repeated.
    - `log_prior(x)` is the log density of the prior at `x`, up to a constant; `-inf` outside its support.
    - `log_density(x)` is the log of a further factor, such as a constraint. Without it there is no such factor.
    - `met(x)` says whether `x` is a solution: `True`, `False`, or whole numbers that distinguish kinds of solutions.

    Points are arrays of floats, all of the same length. Functions must depend on their arguments alone.
    """

    def __init__(
        self,
        start: Callable[[_plaus.Rng], Given],
        log_prior: Callable[[Point], float],
        log_density: Callable[[Point], float] | None = None,
        *,
        met: Met | None = None,
    ) -> None:
        for name, function in [("start", start), ("log_prior", log_prior), ("log_density", log_density), ("met", met)]:
            if function is not None and not callable(function):
                raise TypeError(f"{name}: a function is expected, not a {type(function).__name__}")
        self._functions = _plaus.Functions(start, log_prior, log_density or _nothing, met)
        self._start = start

    def _dimensions(self) -> int:
        """The length of its points."""
        made = self._start(_plaus.Rng(0))
        return len(made) if hasattr(made, "__len__") else 1


def _nothing(_: Any) -> float:
    return 0.0


class Move:
    """A way to propose another point.

    `propose(x, rng)` returns the candidate, `None` to stay, or `(candidate, log ratio)`. `log_ratio(x, y)` is
    `log q(x | y) - log q(y | x)`: how much likelier the way back from `y` is than the way there. Without it, both are
    taken to be equally likely. `check_moves` tests whether that is right.
    """

    def __init__(
        self,
        propose: Callable[[Point, _plaus.Rng], Any],
        log_ratio: Callable[[Point, Point], float] | None = None,
        *,
        weight: float = 1.0,
        name: str | None = None,
    ) -> None:
        if not callable(propose) or not (log_ratio is None or callable(log_ratio)):
            raise TypeError("propose and log_ratio are functions")
        self.name: str = name or str(getattr(propose, "__name__", type(propose).__name__))
        """Its name in reports."""
        self.weight = float(weight)
        """How often it is chosen, relative to the others' weights."""
        self._kernel = _plaus.Kernel(self.name, self.weight, propose, log_ratio)

    @classmethod
    def redraw(cls, *, weight: float = 1.0) -> Move:
        """Proposes a new start. This is correct if `start` draws from the prior."""
        made = cls.__new__(cls)
        made.name, made.weight = "redraw_all", float(weight)
        made._kernel = _plaus.Kernel(made.name, made.weight, None, None)
        return made

    @classmethod
    def walk(cls, scale: float, *, weight: float = 1.0) -> Move:
        """Proposes a Gaussian step of standard deviation `scale` along every axis."""
        if not scale > 0.0:
            raise ValueError(f"scale is {scale}, but must be above 0")

        def walk(x: Point, rng: _plaus.Rng) -> list[float]:
            return [number + rng.normal(0.0, scale) for number in x]

        return cls(walk, weight=weight)


class TargetRun:
    """Chains of a target: draws after the warm-up."""

    def __init__(self, made: dict[str, Any]) -> None:
        self.x: NDArray[np.float64] = made["x"]
        """The points: (chain, draw, axis)."""
        self.log_p: NDArray[np.float64] = made["lp"]
        """Log density of prior and factor together: (chain, draw)."""
        self.satisfied: NDArray[np.bool_] = made["satisfied"]
        """Whether `met` said so: (chain, draw)."""
        self.acceptance: dict[str, float] = dict(made["acceptance"])
        """Share of each move's proposals that was accepted, including the warm-up."""
        self.ending: str = made["ending"]
        """How sampling ended."""

    def to_datatree(self) -> xarray.DataTree:
        """The draws for ArviZ and xarray. Needs xarray."""
        import numpy
        import xarray

        chains, draws, axes = self.x.shape
        index = {"chain": numpy.arange(chains), "draw": numpy.arange(draws)}
        posterior = xarray.Dataset({"x": (("chain", "draw", "axis"), self.x)}, {**index, "axis": numpy.arange(axes)})
        stats = {"lp": (("chain", "draw"), self.log_p), "satisfied": (("chain", "draw"), self.satisfied)}
        return xarray.DataTree.from_dict({"posterior": posterior, "sample_stats": xarray.Dataset(stats, index)})

    def __repr__(self) -> str:
        chains, draws, axes = self.x.shape
        return f"<TargetRun: {chains} chains of {draws:,} draws of {axes} numbers, {self.ending.replace('_', ' ')}>"


def sample_target(
    target: Target,
    moves: Sequence[Move],
    *,
    chains: int = 4,
    warmup: int = 1000,
    iterations: int = 10_000,
    seed: int = 1,
    solutions: int | None = None,
) -> TargetRun:
    """Samples a target with these moves, chosen by their weights. Ctrl-C returns what all chains have so far.

    With `solutions`, it stops once this many distinct ones are found. There is then no warm-up: every iteration counts.

    Exceptions of the target's or a move's functions are raised with a note that names the chain and the iteration.
    """
    from plaus._numbers import _whole

    return TargetRun(
        _plaus.sample_target(
            target._functions,
            [move._kernel for move in moves],
            chains=_whole("chains", chains, 1),
            warmup=_whole("warmup", warmup, 0),
            iterations=_whole("iterations", iterations, 1),
            seed=_whole("seed", seed, 0),
            solutions=_whole("solutions", solutions, 1),
        )
    )


def check_moves(
    target: Target,
    moves: Sequence[Move],
    *,
    samples: int = 20_000,
    pairs: int = 1000,
    seed: int = 0,
    false_alarm: float = 1e-6,
    bound: float | None = None,
) -> _plaus.CheckReport:
    """Checks moves in the way in which the scenes' own moves are checked.

    Each ratio is compared with that of the reverse step. Then one step is made from each of `samples` exact draws,
    which must preserve their law. These are draws from the prior, with the factor switched off. If `bound` is given, a
    number that `log_density` never exceeds, draws from the target by rejection are used as well. `target.start` must
    draw from the prior.

    A report is true if nothing was found; its text describes any findings. It is false by chance with probability
    `false_alarm`. To detect a fault that shifts a law by a fraction s of its standard deviation takes about 100 / s²
    samples.
    """
    from plaus._numbers import _whole

    return _plaus.check(
        target._functions,
        [move._kernel for move in moves],
        dimensions=target._dimensions(),
        samples=_whole("samples", samples, 1000),
        pairs=_whole("pairs", pairs, 1),
        seed=_whole("seed", seed, 0),
        false_alarm=float(false_alarm),
        bound=bound,
    )
