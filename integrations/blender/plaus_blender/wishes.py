"""What must happen, in an animator's words, and the requirements of Plaus that say it. Knows nothing of Blender."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from .world import Table, Thing, World, number, numbers

# Kinds: how they are called, what they mean, and what they need beside an object.
KINDS: dict[str, tuple[str, str, tuple[str, ...]]] = {
    "ENDS_AT": ("Ends at", "It comes to rest with its middle near an empty, seen from above", ("other", "within")),
    "SIDE_UP": ("This side up", "One of its own axes points up at the end", ("axis",)),
    "ENDS_INSIDE": ("Ends inside", "Its middle is inside the box around another object at the end", ("other",)),
    "HITS": ("Hits at frame", "It first hits the other object, or anything, at this frame or marker",
             ("other?", "frame")),
    "TOUCHES": ("Touches", "It touches the other object at some time", ("other",)),
    "NEVER": ("Never touches", "It never touches the other object", ("other",)),
    "PASSES": ("Passes", "Its middle passes near an empty on the way", ("other", "within")),
    "STAYS": ("Stays", "Its middle stays near where it is at the start", ("within",)),
    "STANDS": ("Stays upright", "It ends as upright as it began, within 30 degrees", ()),
    "FALLS": ("Falls over", "It ends tilted by more than 45 degrees", ()),
    "BEFORE": ("Is hit before", "Something hits it faster than a walk of its own size before the other", ("other",)),
    "RESTS": ("Is at rest by", "It lies still from this frame on", ("frame",)),
}


@dataclass
class Place:
    """Where another object is: its middle, two corners of the box around it, and its name if it is in the world."""

    middle: NDArray[np.float64]
    low: NDArray[np.float64]
    high: NDArray[np.float64]
    name: str = ""


@dataclass
class Wish:
    """One thing that must happen."""

    kind: str
    thing: str
    """The object's name in the scenario."""
    other: Place | None = None
    within: float = 10.0
    """mm."""
    axis: str = "z"
    frame: float = 0.0
    """Frames since the start."""
    frames: float = 1.0
    """How many frames earlier or later will do."""
    said: str = field(default="")
    """What the user sees, for messages and for the names of requirements."""


def lacks(wish: Wish, world: World) -> str:
    """What a wish lacks, in words; "" if nothing."""
    thing = world.thing(wish.thing)
    if thing is None or thing.role != "body":
        return "choose an object that moves: a rigid body of the type Active"
    needs = KINDS[wish.kind][2]
    if "other" in needs and wish.other is None:
        return "choose the other object"
    physical = wish.kind in ("TOUCHES", "NEVER", "BEFORE") or (wish.kind == "HITS" and wish.other is not None)
    if physical and (wish.other is None or not wish.other.name):
        return "the other object must be a rigid body"
    if wish.kind == "BEFORE" and wish.other is not None:
        other = world.thing(wish.other.name)
        if other is None or other.role != "body":
            return "the other object must be a rigid body of the type Active"
    return ""


def requirement(wish: Wish, world: World) -> Table:
    """The requirement that says a wish, which lacks nothing."""
    thing = world.thing(wish.thing)
    assert thing is not None
    table = _plain(wish, thing, world)
    return {"named": {"name": wish.said[:60], "that": table}} if wish.said else table


def _plain(wish: Wish, thing: Thing, world: World) -> Table:
    body, other, kind = thing.name, wish.other, wish.kind
    near = number(max(wish.within, 1e-3))
    close = {"within_mm": near, "scale_mm": number(max(near / 2, 1e-3))}
    if kind == "SIDE_UP":
        return {"faces_up": {"body": body, "axis": thing.axis(wish.axis)}}
    if kind in ("STANDS", "FALLS"):
        least = 30 if kind == "STANDS" else 45
        up = {"faces_up": {"body": body, "axis": thing.axis(thing.upright()), "within_deg": least}}
        return up if kind == "STANDS" else {"not": up}
    if kind == "STAYS":
        middle = numbers((thing.low + thing.high) / 2)
        return {"inside": {"body": body, "centre_mm": middle, "radius_mm": near, "how": "always"}}
    window = {"at_s": number(wish.frame / world.fps), "within_ms": number(1000 * max(wish.frames, 0.5) / world.fps)}
    if kind == "RESTS":
        return {"rests": {"body": body, "when": {"to_s": window["at_s"]}}}
    if kind == "HITS":
        return {"impact": {"body": body, **({"with": other.name} if other else {}), "when": window}}
    assert other is not None
    if kind in ("ENDS_AT", "PASSES"):
        x, y, z = numbers(other.middle)
        if kind == "PASSES":
            return {"passes": {"body": body, "x_mm": x, "y_mm": y, "z_mm": z, **close}}
        return {"rests_at": {"body": body, "x_mm": x, "y_mm": y, **close}}
    if kind == "ENDS_INSIDE":
        ranges = {f"{axis}_mm": numbers((other.low[at], other.high[at])) for at, axis in enumerate("xyz")}
        scale = number(max(1e-3, float((other.high - other.low).max()) / 10))
        return {"inside": {"body": body, **ranges, "how": "at_end", "scale_mm": scale}}
    if kind == "TOUCHES":
        return {"touches": {"body": body, "with": other.name}}
    if kind == "NEVER":
        return {"not": {"touches": {"body": body, "with": other.name}}}
    # What merely stands on something is not hit.
    speed = number(min(1.0, 0.1 * (2 * world.gravity * thing.size / 1000) ** 0.5))
    events = ({"body": each, "what": "impact", "faster_than": speed} for each in (body, other.name))
    return {"before": dict(zip(("first", "then"), events))}
