"""Targets of your own, for toy problems: sampled by plaus's chains, checked by plaus's checks."""

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
    """A distribution over points: prior times density, each by a function.

    - `start(rng)` draws a point, from the prior itself unless you know better; with an `Rng`, so that runs repeat.
    - `log_prior(x)` is the log density of the prior at `x`, up to a constant; `-inf` where there is none.
    - `log_density(x)` is the log of the factor on top of it, as a constraint brings it; no factor where it is not
      given.
    - `met(x)` says whether `x` is a solution: `True`, `False`, or whole numbers that tell solutions of one kind from
      others.

    Points are arrays of floats of one length. Functions must depend on their arguments alone.
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
        """How long its points are."""
        made = self._start(_plaus.Rng(0))
        return len(made) if hasattr(made, "__len__") else 1


def _nothing(_: Any) -> float:
    return 0.0


class Move:
    """A way to propose another point.

    `propose(x, rng)` gives the candidate, `None` to stay, or `(candidate, log ratio)`. `log_ratio(x, y)` is
    `log q(x | y) - log q(y | x)`, by which the way back from `y` is likelier than the way there; without it, both are
    taken to be equally likely. `check_moves` says whether that is right.
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
        """What it is called in reports."""
        self.weight = float(weight)
        """How often it is chosen, beside the others' weights."""
        self._kernel = _plaus.Kernel(self.name, self.weight, propose, log_ratio)

    @classmethod
    def redraw(cls, *, weight: float = 1.0) -> Move:
        """Proposes a new start. Right where `start` draws from the prior."""
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
        """Accepted share of each move's proposals, warm-up included."""
        self.ending: str = made["ending"]
        """How sampling ended."""

    def to_datatree(self) -> xarray.DataTree:
        """The draws as ArviZ and xarray take them. Needs xarray."""
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
    """Samples a target by these moves, chosen by their weights. Ctrl-C gives what all chains have.

    With `solutions` it stops once so many distinct ones are found, and there is no warm-up: each counts from the first
    on.

    Raises what a function of the target or of a move raises, with a note that says in which chain and iteration.
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
    """Checks moves as the scenes' own moves are checked.

    Ratios are held against their reverse; then a step is made from each of `samples` exact draws, which must leave
    their law as it is: draws of the prior, with the factor switched off, and where `bound` is given, a number that
    `log_density` never
    exceeds, draws of the target by rejection as well. `target.start` must draw from the prior.

    A report is true where nothing was found; its text says what was. By chance it is false with probability
    `false_alarm`. A fault that shifts a law by a share s of its standard deviation shows from about 100 / s² samples
    on.
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
