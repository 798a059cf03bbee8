"""How much may vary: "a little", "some", "a lot", and the numbers behind these words. Knows nothing of Blender."""

from __future__ import annotations

from math import sqrt

NONE, LITTLE, SOME, LOT, OWN = "NONE", "LITTLE", "SOME", "LOT", "OWN"
LEVELS = (NONE, LITTLE, SOME, LOT, OWN)

# What a little, some, and a lot are.
# position: standard deviation, as a share of the object's size. rotation: standard deviation in degrees; a lot is any
# orientation. velocity and spin: standard deviation, as a share of the speed after a fall by the object's own size, and
# of that speed over its size. release: the latest time in seconds. mass and friction: relative spread. bounce: how far
# up and down.
NUMBERS: dict[str, tuple[float, float, float]] = {
    "position": (0.05, 0.3, 1.0),
    "rotation": (5.0, 30.0, 360.0),
    "velocity": (0.1, 0.4, 1.5),
    "spin": (0.1, 0.4, 1.5),
    "release": (0.05, 0.25, 1.0),
    "mass": (0.05, 0.2, 0.5),
    "friction": (0.05, 0.2, 0.5),
    "bounce": (0.05, 0.15, 0.4),
}
# A rotation this large means any orientation.
ANY_TURN = 180.0


def amount(what: str, level: str, own: float, size: float, gravity: float) -> float:
    """The number behind a level: in m, degrees, m/s, degrees/s, s, or as a share. `size` is in m, `gravity` in m/s².

    `own` is the user's number, in the same unit, which counts if the level is `OWN`.
    """
    if level == NONE:
        return 0.0
    if level == OWN:
        return max(0.0, own)
    number = NUMBERS[what][LEVELS.index(level) - 1]
    fall = sqrt(2 * max(gravity, 1e-3) * size)
    if what == "position":
        return number * size
    if what == "velocity":
        return number * fall
    if what == "spin":
        return number * fall / size * 57.29577951308232
    return number
