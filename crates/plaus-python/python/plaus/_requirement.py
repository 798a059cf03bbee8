"""What no scenario file can say: a requirement of your own."""

from __future__ import annotations

from collections.abc import Callable
from contextlib import AbstractContextManager, nullcontext
from typing import TYPE_CHECKING, NamedTuple, Union

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
    """Seconds spent in it, with what it had simulated once more."""
    waited: float
    """Seconds that chains waited for their turn, and for answers of other processes to arrive."""

    @property
    def microseconds_a_call(self) -> float:
        """Mean time of a call."""
        return 1e6 * self.seconds / self.calls if self.calls else 0.0


class Requirement:
    """Something more that must happen, as a function of the outcome.

    `function` is called with an `Outcome` and returns `(log potential, met)`: the log of a factor that the sampled
    distribution gets (0 for no preference, `-inf` for impossible), and whether the requirement is met, so that the
    outcome may count as a solution. `True` stands for `(0, True)`, `False` for `(-inf, False)`; but a chain must be
    able to start, and finds its way much sooner along a slope than off a cliff.

    The function must depend on the outcome alone: equal outcomes, equal answers. Then the chain stays exact, and the
    same seed gives the same bits, whatever the number of threads.

    `most` is a number that the log potential never exceeds, 0 unless you say otherwise: with it, simulations that
    cannot be accepted any more still stop early, and the function is not asked about them. `None` where there is no
    such bound.

    Chains simulate on all cores, but Python runs one call at a time: where the function is slow, they wait for each
    other. With `processes`, so many further processes are started for each run, and calls go to them side by side;
    outcomes travel there and answers back, which takes about a tenth of a millisecond, so for quick functions it
    does not pay. The draws are the same. On Linux processes are forked, elsewhere the function must be importable; what
    it changes outside of itself stays in its process. What was spent is in `cost`.
    """

    def __init__(
        self, function: Judge, *, name: str | None = None, most: float | None = 0.0, processes: int = 0
    ) -> None:
        if not callable(function):
            raise TypeError(f"a requirement is a function of the outcome, not a {type(function).__name__}")
        self.function = function
        """The function."""
        self.name: str = name or getattr(function, "__name__", None) or type(function).__name__
        """What it is called in the run's manifest and in messages."""
        self.most = most
        """What its log potential never exceeds; None where there is no bound."""
        self.processes: int = _whole("processes", processes, 0) or 0
        """How many processes it is asked in; 0: in the one that samples, a call at a time."""
        self._asked = _plaus.Asked(function, self.name, most)

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
        """What the function says of an outcome, of one that an exception carries for example."""
        return self.function(outcome)

    def __repr__(self) -> str:
        cost = self.cost
        return f"<Requirement {self.name}: {cost.calls} calls, {cost.microseconds_a_call:.0f} µs each>"
