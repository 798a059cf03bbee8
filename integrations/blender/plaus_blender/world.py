"""A scene in the extension's own terms, and the Plaus scenario that it becomes. Knows nothing of Blender.

Lengths are in millimetres, angles in degrees, z is up; rotations are matrices from an object's axes to the world's.
"""

from __future__ import annotations

import json
import math
import re
from collections.abc import Iterable
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .levels import ANY_TURN
from .shapes import Solid, signed_axis, volume

Floats = NDArray[np.float64]
Table = dict[str, Any]

# Resistances to rolling and spinning of everything, so that what rolls comes to rest: those of wood on wood.
ROLLING, SPINNING = 0.01, 0.01
# Name of the file with the triangles of meshes, beside the scenario.
SHAPES = "shapes.obj"
# Two solutions differ if a body ends elsewhere by this share of the smallest body's size.
DISTINCT = 0.5
# What moves is smaller than it looks by this share, so that things that touch in Blender, whose numbers have 7 digits,
# do not begin inside each other.
SHRINK = 3e-5
# How many times as wide as all that moves a floor must be to count as ground without edges.
WIDE = 3.0
# Friction and restitution that are not 0 stay above this when they vary.
LEAST = 1e-3


@dataclass
class Finding:
    """Something to be told about an object; `stops` if nothing can be sampled before it is mended."""

    thing: str
    words: str
    stops: bool = False


@dataclass
class Key:
    """Where an animated object is at a time in seconds."""

    time: float
    place: Floats
    turn: Floats


@dataclass
class Thing:
    """An object of the scene: one that moves, scenery, or one that follows keyframes."""

    name: str
    role: str
    """`body`, `fixed` or `driven`."""
    solids: list[Solid]
    place: Floats
    turn: Floats
    low: Floats = field(default_factory=lambda: np.zeros(3))
    high: Floats = field(default_factory=lambda: np.zeros(3))
    """Two corners of the box around it in the world."""
    mass: float = 1.0
    friction: float = 0.5
    bounce: float = 0.0
    damping: float = 0.0
    angular_damping: float = 0.0
    asleep: bool = False
    velocity: tuple[float, float, float] = (0.0, 0.0, 0.0)
    """m/s."""
    spin: tuple[float, float, float] = (0.0, 0.0, 0.0)
    """Degrees per second, about the world's axes."""
    colour: tuple[float, ...] = (0.7, 0.7, 0.7)
    vary: dict[str, float] = field(default_factory=dict)
    """What may vary by how much, as `levels.amount` says."""
    keys: list[Key] = field(default_factory=list)

    @property
    def size(self) -> float:
        """Its largest extent."""
        return float((self.high - self.low).max())

    def frame(self) -> tuple[Floats, Floats]:
        """The body's axes and origin in the object: a single solid whose axes are the object's, in any order, moves
        about its own middle; everything else about the object's origin."""
        [first, *others] = self.solids
        if not others and first.kind not in ("hull", "mesh") and signed_axis(first.turn) is not None:
            return np.asarray(signed_axis(first.turn), dtype=np.float64), first.middle
        return np.eye(3), np.zeros(3)

    def axis(self, axis: str) -> str:
        """The body's axis that is an axis of the object: `x` or `minus_z`, for example."""
        way = np.zeros(3)
        way["xyz".index(axis[-1])] = -1.0 if axis.startswith("minus") else 1.0
        own = np.round(self.frame()[0].T @ way)
        number = int(np.abs(own).argmax())
        return ("" if own[number] > 0 else "minus_") + "xyz"[number]

    def upright(self) -> str:
        """The object's axis that is nearest to upright at the start."""
        number = int(np.abs(self.turn[2]).argmax())
        return ("" if self.turn[2, number] > 0 else "minus_") + "xyz"[number]


@dataclass
class Joint:
    """A joint between two things, or between one and the world."""

    name: str
    body: str
    to: str
    place: Floats
    kind: Table


@dataclass
class World:
    """All that a scenario needs, but what must happen."""

    things: list[Thing] = field(default_factory=list)
    joints: list[Joint] = field(default_factory=list)
    gravity: float = 9.81
    """m/s²."""
    duration: float = 10.0
    """Seconds."""
    fps: float = 24.0
    ground: str = ""
    """Name of the thing that counts as ground without edges."""
    bottom: float | None = None
    falls: bool = False
    """Whether something has nothing below it."""
    findings: list[Finding] = field(default_factory=list)

    def thing(self, name: str) -> Thing | None:
        """The thing with this name."""
        return next((each for each in self.things if each.name == name), None)

    def bodies(self) -> list[Thing]:
        """What moves by itself."""
        return [each for each in self.things if each.role == "body"]

    def tell(self, thing: str, words: str, stops: bool = False) -> None:
        """Adds a finding."""
        self.findings.append(Finding(thing, words, stops))


def plain_name(name: str, taken: Iterable[str]) -> str:
    """A name that a scenario can have: `Cube.001` becomes `Cube_001`, and a second one `Cube_001_2`."""
    plain = re.sub(r"[^A-Za-z0-9_-]", "_", name) or "thing"
    known, number, made = set(taken), 1, plain
    while made in known:
        number += 1
        made = f"{plain}_{number}"
    return made


def find_ground(world: World) -> str:
    """The level piece of scenery below everything, under all other things and several times as wide as all that moves:
    "" if there is none."""
    bodies = world.bodies()
    if not bodies:
        return ""
    low = np.min([each.low for each in bodies], axis=0)
    high = np.max([each.high for each in bodies], axis=0)
    for each in world.things:
        if each.role != "fixed" or len(each.solids) != 1 or each.solids[0].kind not in ("mesh", "box"):
            continue
        solid = each.solids[0]
        level = (each.high - each.low)[2] <= 1e-6 * each.size
        if solid.kind == "box":
            level = bool((np.abs(np.abs(each.turn @ solid.turn)[2]).max()) > 1 - 1e-9)
        others = [other for other in world.things if other is not each]
        below = all(each.high[2] <= other.low[2] + 1e-5 * max(other.size, 1.0) for other in others)
        under = all((each.low <= other.low)[:2].all() and (each.high >= other.high)[:2].all() for other in others)
        wide = bool((each.high - each.low)[:2].min() >= WIDE * (high - low)[:2].max())
        if level and below and under and wide:
            return each.name
    return ""


def room_below(thing: Thing, world: World) -> float:
    """How far a body is above what lies below it, by the boxes around things; infinite above nothing."""
    others = [other for other in world.things if other is not thing]
    if not others:
        return math.inf
    low, high = (np.array([getattr(other, end) for other in others]) for end in ("low", "high"))
    meets = ((low[:, :2] < thing.high[:2]) & (high[:, :2] > thing.low[:2])).all(axis=1)
    meets |= np.array([other.name == world.ground for other in others])
    # What is wholly above it is no obstacle on the way down.
    meets &= low[:, 2] <= thing.high[2] - 1e-5 * thing.size
    return float((thing.low[2] - high[meets, 2]).min(initial=math.inf))


def scenario(world: World, require: list[Table], seed: int) -> Table:
    """The scenario as nested tables."""
    custom: Table = {"duration_s": number(world.duration), "gravity": number(world.gravity)}
    sizes = [each.size for each in world.bodies()]
    custom["distinct_mm"] = number(max(0.001, DISTINCT * min(sizes, default=1.0)))
    if world.bottom is not None:
        custom["bottom_mm"] = number(world.bottom)
    materials: dict[str, Table] = {}
    for role, plural in (("fixed", "fixed"), ("body", "bodies"), ("driven", "driven")):
        custom[plural] = [_thing(each, world, materials) for each in world.things if each.role == role]
    custom["materials"] = [{"name": name, **table} for name, table in materials.items()]
    custom["joints"] = [
        {"name": each.name, "body": each.body, **({"to": each.to} if each.to else {}),
         "at_mm": numbers(each.place), "kind": each.kind}
        for each in world.joints
    ]
    tables = {"sampler": {"seed": seed}, "world": {"custom": custom}}
    return {**({"require": require} if require else {}), **tables}


def probe(world: World) -> Table | None:
    """A scenario whose bodies float where nothing touches them, unturned: where their poses are at the start tells
    where their centres of gravity are. None if every body's is its middle."""
    bodies = []
    for place, each in enumerate(_uncentred(world)):
        table = {"name": each.name, "shape": _shape(each), "gravity_scale": 0}
        bodies.append({**table, "at_mm": [place * 1e5 % 9e5, place // 9 * 1e5 % 9e5, place // 81 * 1e5]})
    if not bodies:
        return None
    custom = {"duration_s": 0.01, "fixed": [], "bodies": bodies}
    return {"sampler": {"chains": 1, "warmup": 0, "iterations": 1}, "world": {"custom": custom}}


def _uncentred(world: World) -> list[Thing]:
    balanced = ("ball", "box", "cylinder", "capsule")
    return [
        each
        for each in world.bodies()
        if len(each.solids) > 1 or each.solids[0].kind not in balanced or signed_axis(each.solids[0].turn) is None
    ]


def shapes_obj(world: World) -> str:
    """The triangles of all meshes, as an OBJ file; "" if there are none."""
    lines: list[str] = []
    count = 0
    for each in world.things:
        for place, solid in enumerate(each.solids):
            if solid.corners is None or solid.faces is None:
                continue
            lines.append(f"o {_object(each, place)}")
            middle = solid.corners.mean(axis=0)
            corners = middle + _fitting(each) * (solid.corners - middle)
            lines += [f"v {x:.6f} {y:.6f} {z:.6f}" for x, y, z in corners.tolist()]
            lines += [f"f {a} {b} {c}" for a, b, c in (solid.faces + count + 1).tolist()]
            count += len(solid.corners)
    return "\n".join([*lines, ""]) if lines else ""


def number(value: float, places: int = 6) -> float | int:
    """A number to a millionth, as a whole one where it is whole."""
    near = round(float(value), places)
    return int(near) if near == int(near) else near


def numbers(values: Iterable[float]) -> list[Any]:
    """Lengths in mm and angles in degrees to 1e-5: what is finer is noise, as Blender keeps 7 digits."""
    return [number(each, 5) for each in values]


def angles(turn: Floats) -> list[float]:
    """The angles in degrees about the world's x, y and z axes, one after another, that make a rotation."""
    across = math.hypot(turn[0, 0], turn[1, 0])
    if across > 1e-9:
        made = (math.atan2(turn[2, 1], turn[2, 2]), math.atan2(-turn[2, 0], across), math.atan2(turn[1, 0], turn[0, 0]))
    else:
        made = (math.atan2(-turn[1, 2], turn[1, 1]), math.atan2(-turn[2, 0], across), 0.0)
    return [math.degrees(each) for each in made]


def _fitting(thing: Thing) -> float:
    return 1.0 - SHRINK if thing.role == "body" else 1.0


def _object(thing: Thing, place: int) -> str:
    return thing.name if len(thing.solids) == 1 else f"{thing.name}-{place}"


def _form(thing: Thing, place: int) -> Table:
    solid = thing.solids[place]
    size = numbers(_fitting(thing) * np.array(solid.size))
    if solid.kind == "ball":
        return {"ball": {"radius_mm": size[0]}}
    if solid.kind == "box":
        return {"box": {"size_mm": size}}
    if solid.kind in ("cylinder", "cone"):
        return {solid.kind: {"radius_mm": size[0], "height_mm": size[1]}}
    if solid.kind == "capsule":
        return {"capsule": {"radius_mm": size[0], "length_mm": size[1]}}
    file = {"file": SHAPES, "object": _object(thing, place), "up": "z", "unit_mm": 1}
    return {"mesh" if solid.kind == "mesh" else "hull_of": file}


def _shape(thing: Thing) -> Table:
    [first, *others] = thing.solids
    frame, _ = thing.frame()
    alone = not others and (first.kind in ("hull", "mesh") or bool(np.allclose(frame, first.turn)))
    if alone:
        return _form(thing, 0)
    pieces = []
    for place, solid in enumerate(thing.solids):
        piece = {"shape": _form(thing, place)}
        if solid.kind not in ("hull", "mesh"):
            piece |= {"at_mm": numbers(solid.middle), "turn_deg": numbers(angles(solid.turn))}
        pieces.append(piece)
    return {"compound": {"pieces": pieces}}


def _material(thing: Thing, materials: dict[str, Table]) -> str:
    """The name of the thing's material. Blender multiplies the values of two things that meet; as Plaus takes the
    root of their product, each has the square of its own."""
    friction: Any = number(thing.friction**2)
    bounce: Any = number(min(thing.bounce, 1.0) ** 2)
    spread = thing.vary.get("friction", 0.0)
    if spread and friction > LEAST:
        friction = {"log_normal": {"median": friction, "spread": number(min(3.0, 2 * spread))}}
    spread = thing.vary.get("bounce", 0.0)
    if spread:
        low, high = max(0.0, thing.bounce - spread), min(1.0, thing.bounce + spread)
        bounce = {"uniform": [number(low**2), number(high**2)]}
    table: Table = {"friction": friction, "restitution": bounce, "rolling": ROLLING, "spinning": SPINNING}
    if thing.role == "body":
        # Exact for recognised shapes; of hulls, to the fineness to which a hull is kept.
        whole = sum(volume(each) for each in thing.solids) * 1e-9
        density: Any = float(f"{thing.mass / whole:.9g}")
        if thing.vary.get("mass"):
            density = {"log_normal": {"median": density, "spread": number(min(3.0, thing.vary["mass"]))}}
        table["density"] = density
    varies = any(isinstance(each, (dict, str)) for each in table.values())
    for name, known in materials.items():
        if known == table and not varies:
            return name
    name = plain_name(f"of_{thing.name}", materials)
    materials[name] = table
    return name


def _thing(thing: Thing, world: World, materials: dict[str, Table]) -> Table:
    table: Table = {"name": thing.name, "material": _material(thing, materials)}
    if thing.name == world.ground:
        return {**table, "shape": {"plane": {}}, "at_mm": [0, 0, number(thing.high[2])]}
    table["shape"] = _shape(thing)
    frame, origin = thing.frame()
    if thing.role == "driven":
        keys = [
            {"at_s": number(each.time), "at_mm": numbers(each.place + each.turn @ origin),
             "turn_deg": numbers(angles(each.turn @ frame))}
            for each in thing.keys
        ]
        return {**table, "keys": keys}
    at: list[Any] = numbers(thing.place + thing.turn @ origin)
    turn: list[Any] = numbers(angles(thing.turn @ frame))
    if thing.role == "body":
        table |= _uncertain(thing, world, at, turn)
    return {**table, "at_mm": at, **({} if "any_turn" in table else {"turn_deg": turn})}


def _uncertain(thing: Thing, world: World, at: list[Any], turn: list[Any]) -> Table:
    """What a body has beyond its place. A body that stands on something moves and turns on the level only."""
    vary, table = thing.vary, {}
    far = vary.get("position", 0.0) * 1000.0
    room = room_below(thing, world)
    aloft = room > max(0.1 * thing.size, 2 * far)
    for axis in range(3 if aloft else 2):
        at[axis] = _spread(at[axis], far)
    turned = vary.get("rotation", 0.0)
    if turned >= ANY_TURN and room > 0.5 * thing.size:
        table["any_turn"] = True
    elif turned >= ANY_TURN:
        turn[2] = {"uniform": numbers((turn[2] - 180.0, turn[2] + 180.0))}
    else:
        for axis in range(3) if room > 0.5 * thing.size else (2,):
            turn[axis] = _spread(turn[axis], turned)
    if thing.asleep:
        return {**table, "asleep": True}
    for key, own, spread in (
        ("velocity_m_s", thing.velocity, vary.get("velocity", 0.0)),
        ("spin_deg_s", thing.spin, vary.get("spin", 0.0)),
    ):
        level = (0, 1, 2) if aloft else (0, 1) if key == "velocity_m_s" else (2,)
        each = [_spread(number(own[axis]), spread if axis in level else 0.0) for axis in range(3)]
        if any(value != 0 for value in each):
            table[key] = each
    if vary.get("release"):
        table["release_s"] = {"uniform": [0, number(vary["release"])]}
    for key, rate in (("damping", thing.damping), ("angular_damping", thing.angular_damping)):
        if rate:
            table[key] = number(rate)
    return table


def _spread(mean: Any, spread: float) -> Any:
    return {"normal": [mean, number(spread)]} if number(spread) > 0 else mean


def to_toml(tables: Table) -> str:
    """The text of a scenario: each thing and each requirement a table of its own."""
    lines: list[str] = []

    def put(path: str, table: Table) -> None:
        # Keys before tables, as a table's keys are those up to the next header.
        later = []
        for key, value in table.items():
            listed = isinstance(value, list) and value and all(isinstance(each, dict) for each in value)
            if listed or (isinstance(value, dict) and path in ("", "world")):
                later.append((key, value))
            else:
                lines.append(f"{key} = {_inline(value)}")
        for key, value in later:
            full = f"{path}.{key}".lstrip(".")
            for each in value if isinstance(value, list) else [value]:
                if full != "world":
                    lines.append(f"\n[[{full}]]" if isinstance(value, list) else f"\n[{full}]")
                if isinstance(value, list):
                    lines.extend(f"{name} = {_inline(part)}" for name, part in each.items())
                else:
                    put(full, each)

    put("", tables)
    return "\n".join(lines).lstrip() + "\n"


def _inline(value: Any) -> str:
    if isinstance(value, dict):
        return "{ " + ", ".join(f"{key} = {_inline(each)}" for key, each in value.items()) + " }" if value else "{}"
    if isinstance(value, list):
        return "[" + ", ".join(map(_inline, value)) + "]"
    return json.dumps(value, ensure_ascii=False)
