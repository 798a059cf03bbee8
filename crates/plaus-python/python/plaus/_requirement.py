"""Requirements written in Python, for what no scenario file can express."""

from __future__ import annotations

from collections.abc import Callable
from contextlib import AbstractContextManager, nullcontext
from typing import TYPE_CHECKING, Any, NamedTuple, Union

from plaus import _plaus
from plaus._numbers import _whole

if TYPE_CHECKING:
    from plaus._processes import Processes

    Judge = Callable[[_plaus.Outcome], Union[tuple[float, bool], bool]]


class Cost(NamedTuple):
    """What a requirement has cost so far."""

    calls: int
    """How often the function was called."""
    seconds: float
    """Seconds spent in it, including further simulations that it caused."""
    waited: float
    """Seconds that chains waited for their turn, and for answers from other processes."""

    @property
    def microseconds_a_call(self) -> float:
        """Mean time of a call."""
        return 1e6 * self.seconds / self.calls if self.calls else 0.0


def _restored(function: Judge, name: str, most: float | None, processes: int) -> Requirement:
    return Requirement(function, name=name, most=most, processes=processes)


class Requirement:
    """Something further that must happen, as a function of the outcome.

    `function` is called with an `Outcome` and returns `(log potential, met)`: the log of a factor in the sampled
    distribution (0 for no preference, `-inf` for impossible), and whether the requirement is met, so that the outcome
    may count as a solution. `True` stands for `(0, True)`, `False` for `(-inf, False)`. But a chain must be able to
    start, and it reaches the goal much sooner if the potential rises towards it than if it jumps there.

    The function must depend on the outcome alone: equal outcomes must give equal answers. Then the chain remains exact,
    and the same seed gives the same bits, whatever the number of threads.

    `most` is a number that the log potential never exceeds; the default is 0. With it, simulations that can no longer
    be accepted still stop early, and the function is not called for them. `None` means that there is no such bound.

    Chains simulate on all cores, but Python runs one call at a time: if the function is slow, chains wait for each
    other. `processes` is the number of further processes to start for each run; they run calls in parallel. Sending an
    outcome and its answer takes about a tenth of a millisecond, so this does not pay off for quick functions. The draws
    are the same. On Linux, processes are forked; elsewhere, the function must be importable. Changes that it makes
    outside of itself stay in its process. `cost` says how much time was spent.
    """

    def __init__(
        self, function: Judge, *, name: str | None = None, most: float | None = 0.0, processes: int = 0
    ) -> None:
        if not callable(function):
            raise TypeError(f"a requirement is a function of the outcome, not a {type(function).__name__}")
        self.function = function
        """The function."""
        self.name: str = name or getattr(function, "__name__", None) or type(function).__name__
        """Its name in the run's manifest and in messages."""
        self.most = most
        """A number that its log potential never exceeds; None if there is no bound."""
        self.processes: int = _whole("processes", processes, 0) or 0
        """Number of processes that evaluate it; 0: only the one that samples, one call at a time."""
        self._asked = _plaus.Asked(function, self.name, most)

    def __reduce__(self) -> tuple[Any, ...]:
        # A copy has its own cost. Pickle sends a function by the name by which it is imported.
        return _restored, (self.function, self.name, self.most, self.processes)

    @property
    def cost(self) -> Cost:
        """What it has cost so far."""
        return Cost(*self._asked.cost)

    def _asking(self, scenario: _plaus.Scenario) -> AbstractContextManager[Processes | None]:
        """Its processes, for one run."""
        if self.processes == 0:
            return nullcontext()
        from plaus._processes import Processes

        return Processes(self.function, scenario, self.processes)

    def __call__(self, outcome: _plaus.Outcome) -> tuple[float, bool] | bool:
        """The function's answer for an outcome, for example one that an exception carries."""
        return self.function(outcome)

    def __repr__(self) -> str:
        cost = self.cost
        return f"<Requirement {self.name}: {cost.calls} calls, {cost.microseconds_a_call:.0f} µs each>"
