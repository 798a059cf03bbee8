"""Motions: poses at any time, and impacts."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any, NamedTuple, NoReturn

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from plaus import _plaus

    Floats = NDArray[np.float64]


class Poses(NamedTuple):
    """Where all bodies are, and how they are turned, at some times."""

    times: Floats
    """Seconds, one for each frame."""
    bodies: list[str]
    """Names, one for each body."""
    position: Floats
    """Metres, y up: (frame, body, xyz)."""
    orientation: Floats
    """Unit quaternions from the body's axes to the world's: (frame, body, xyzw)."""


class Events(dict[str, Any]):
    """Impacts in order of time, as columns: a dictionary that data frames accept unchanged.

    `t` (s), `body` and `other` (names), `x`, `y`, `z` (m), `nx`, `ny`, `nz` (unit normal towards `body`), `speed` (m/s,
    at which the two met along the normal), `impulse` (N s). `point` and `normal` hold places and normals as arrays
    (event, xyz).
    """

    def __init__(self, columns: dict[str, Any]) -> None:
        self.point: Floats = columns["point"]
        """Places in m: (event, xyz)."""
        self.normal: Floats = columns["normal"]
        """Unit normals of the surfaces hit, towards the bodies: (event, xyz)."""
        super().__init__(
            t=columns["t"],
            body=columns["body"],
            other=columns["other"],
            **{name: self.point[:, axis] for axis, name in enumerate("xyz")},
            **{f"n{name}": self.normal[:, axis] for axis, name in enumerate("xyz")},
            speed=columns["speed"],
            impulse=columns["impulse"],
        )

    @property
    def count(self) -> int:
        """Number of impacts."""
        return len(self["t"])

    def __repr__(self) -> str:
        return f"<Events: {self.count} impacts, columns {', '.join(self)}>"


class Replay:
    """A sample, simulated again from its draw: bit for bit as in the chain, unless another accuracy was asked for."""

    def __init__(self, facts: str, motion: _plaus.Motion) -> None:
        import json

        self._motion = motion
        self.facts: dict[str, Any] = json.loads(facts)
        """What is known of it: sample, iteration, seed, log p, scalars of the scene."""

    def __reduce__(self) -> NoReturn:
        raise TypeError(
            "a replay is not pickled, as it is made again from its run in a moment: pickle the run, its chain and its "
            "draw, and ask the run for the sample there"
        )

    @property
    def chain(self) -> int:
        """Its chain."""
        return int(self.facts["chain"])

    @property
    def draw(self) -> int:
        """Its number among the chain's draws after the warm-up, from 0."""
        return int(self.facts["draw"])

    @property
    def log_p(self) -> float:
        """Log probability density of prior and constraint together, up to a constant."""
        return float(self.facts["log_p"])

    @property
    def satisfied(self) -> bool:
        """Whether it satisfies the constraint, and the requirement if there is one."""
        return bool(self.facts["satisfied"])

    @property
    def scalars(self) -> dict[str, float]:
        """The scene's scalars, as in the table of draws."""
        return dict(self.facts["scalars"])

    @property
    def duration(self) -> float:
        """Duration in seconds."""
        return self._motion.duration

    @property
    def bodies(self) -> list[str]:
        """Names of the bodies."""
        return self._motion.bodies

    def poses(self, fps: float = 60.0, *, times: Sequence[float] | Floats | None = None) -> Poses:
        """Poses of all bodies at `fps` frames per second from 0, or at `times` (s). They come from closed forms, exact
        at any time."""
        at = None if times is None else [float(time) for time in times]
        moments, position, orientation = self._motion.poses(fps, at)
        return Poses(moments, self.bodies, position, orientation)

    @property
    def events(self) -> Events:
        """Impacts in order of time."""
        return Events(self._motion.events)

    def to_json(self) -> str:
        """The whole motion: closed-form pieces, impacts, shapes and scenery."""
        return self._motion.to_json()

    def __repr__(self) -> str:
        met = "satisfied" if self.satisfied else "not satisfied"
        return f"<Replay of {self.chain}:{self.draw}: {len(self.bodies)} bodies, {self.duration:.2f} s, {met}>"
