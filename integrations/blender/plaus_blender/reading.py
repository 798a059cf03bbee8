"""Reads a Blender scene: its rigid bodies, joints and wishes, in the extension's own terms."""

from __future__ import annotations

import math
from collections.abc import Generator, Iterator
from contextlib import contextmanager
from typing import Any

import bpy
import numpy as np
from mathutils import Matrix
from numpy.typing import NDArray

from . import instances, levels, meshes, settings
from .world import Joint, Key, Thing, World, find_ground, plain_name, room_below

Floats = NDArray[np.float64]

# An animated object keeps a key unless the ones beside it tell its place and turn to within this, in mm and radians.
KEY_MM, KEY_RAD = 0.05, 5e-4
# Scales of parents along different axes are alike if their squares are to within this share.
EVEN = 1e-4
NOTHING_MOVES = "Nothing moves: give an object Physics > Rigid Body, type Active"
# Blender's own damping is there to calm its simulator; resistance to rolling takes its place. Other values count.
DAMPING, ANGULAR_DAMPING = 0.04, 0.1


def unit_mm(scene: bpy.types.Scene) -> float:
    """Length of Blender's unit in mm."""
    units = scene.unit_settings
    return 1000.0 * (units.scale_length if units.system != "NONE" else 1.0)


def fps(scene: bpy.types.Scene) -> float:
    """Frames per second."""
    return float(scene.render.fps / scene.render.fps_base)


def bodies(scene: bpy.types.Scene) -> list[bpy.types.Object]:
    """The rigid bodies of a scene, and what shows copies of some, by name."""
    world = scene.rigidbody_world
    found = [each for each in (world.collection.objects if world and world.collection else []) if each.rigid_body]
    return sorted([*found, *filter(instances.parts, scene.objects)], key=lambda each: each.name)


@contextmanager
def first_frame(scene: bpy.types.Scene) -> Iterator[None]:
    """The scene at its first frame, and afterwards where it was."""
    was, part = scene.frame_current, scene.frame_subframe
    if (was, part) != (scene.frame_start, 0.0):
        scene.frame_set(scene.frame_start)
    try:
        yield
    finally:
        if (scene.frame_current, scene.frame_subframe) != (was, part):
            scene.frame_set(was, subframe=part)


def read(context: bpy.types.Context) -> tuple[World, dict[str, bpy.types.Object]]:
    """The world of the scene, with what is to be told about it, and the object of each thing."""
    steps = reading(context)
    while True:
        try:
            next(steps)
        except StopIteration as end:
            return end.value


def reading(context: bpy.types.Context) -> Generator[None, None, tuple[World, dict[str, bpy.types.Object]]]:
    """As `read`, object by object and frame by frame, so that a window can be drawn in between. The scene must not
    change meanwhile."""
    scene = context.scene
    unit = unit_mm(scene)
    world = World(duration=max(0.01, (scene.frame_end - scene.frame_start) / fps(scene)), fps=fps(scene))
    _gravity(scene, world)
    objects: dict[str, bpy.types.Object] = {}
    with first_frame(scene):
        view = context.view_layer
        graph = context.evaluated_depsgraph_get()
        found = bodies(scene)
        whole = [each for each in found if each.rigid_body and each.rigid_body.collision_shape == "COMPOUND"]
        pieces = {child for each in whole for child in each.children}
        for each in found:
            if each in pieces:
                continue
            if each.name not in view.objects:
                world.tell(each.name, "is not in this view layer: left out")
                continue
            if each.rigid_body and instances.is_active(each) and (above := _simulated_above(each)):
                words = "which Blender cannot play: left out. Clear the parent, keeping the transform"
                world.tell(each.name, f"its parent {above.name} is an active rigid body like itself, {words}")
                continue
            thing = yield from _thing(each, graph, world, unit, scene)
            if thing is not None:
                thing.name = plain_name(each.name, objects)
                objects[thing.name] = each
                world.things.append(thing)
            yield
        yield from _keys(scene, world, objects, unit)
        if scene.plaus.ground:
            world.ground = find_ground(world)
        if world.ground:
            world.tell(objects[world.ground].name, "counts as ground without edges")
        _joints(scene, world, objects, unit)
        held = {name for joint in world.joints for name in (joint.body, joint.to)}
        for each in world.bodies():
            if world.gravity and each.name not in held and math.isinf(room_below(each, world)):
                world.falls = True
                world.tell(objects[each.name].name, "has nothing below it and falls for ever: Add Floor puts a floor "
                           "under everything")
            yield
    _left_out(scene, world)
    if not world.bodies():
        world.tell("", NOTHING_MOVES, stops=True)
    elif not any(any(each.vary.values()) for each in world.bodies()):
        world.tell("", "Nothing may vary, so all endings would be the same: select objects and press Vary", stops=True)
    return world, objects


def start_of(thing: bpy.types.Object) -> Matrix:
    """Where an object is at the start: where it was before an ending was baked, if one was."""
    kept = thing.plaus
    if kept.started:
        flat = list(kept.start)
        return Matrix([flat[row * 4 : row * 4 + 4] for row in range(4)])
    return thing.matrix_world.copy()


def stretch(thing: bpy.types.Object) -> Floats:
    """What an object's transform does at the start before it turns: its scale, mirrored or slanted by its parents'."""
    start, above = start_of(thing), thing.parent
    if not thing.plaus.started and (above is None or thing.parent_type == "OBJECT"):
        # At a later frame, what Blender itself simulates has lost what is mirrored. To turn it makes no difference.
        start = (above.matrix_world @ thing.matrix_parent_inverse if above else Matrix()) @ thing.matrix_basis
    return np.array(start.to_quaternion().to_matrix().transposed() @ start.to_3x3(), dtype=np.float64)


def _gravity(scene: bpy.types.Scene, world: World) -> None:
    metre = unit_mm(scene) / 1000.0
    pull = np.array(scene.gravity if scene.use_gravity else (0.0, 0.0, 0.0))
    rigid = scene.rigidbody_world
    if rigid is not None:
        pull = pull * rigid.effector_weights.gravity
        if rigid.time_scale != 1.0:
            world.tell("", f"The rigid body world's speed of {rigid.time_scale:g} is taken as 1")
    world.gravity = float(np.linalg.norm(pull)) * metre
    if pull[2] > 0 or np.abs(pull[:2]).max() > 1e-4 * max(1e-9, np.abs(pull).max()):
        world.tell("", "Gravity is taken to point straight down")
    if abs(metre - 1.0) > 1e-9 and abs(pull[2] + 9.81) < 0.01:
        world.tell(
            "", f"Gravity is {world.gravity:.3g} m/s² at this unit scale, as in Blender's own simulation: set it to "
            f"{-9.81 / metre:g} for that of the Earth",
        )


def _thing(
    each: bpy.types.Object, graph: bpy.types.Depsgraph, world: World, unit: float, scene: bpy.types.Scene
) -> Generator[None, None, Thing | None]:
    rigid = instances.rigid_of(each)
    moves = rigid.type == "ACTIVE" and rigid.enabled and not rigid.kinematic
    role = "body" if moves else "driven" if rigid.kinematic and is_animated(each) else "fixed"
    matrix = np.array(start_of(each), dtype=np.float64)
    turn = np.array(start_of(each).to_quaternion().to_matrix(), dtype=np.float64)
    solids = yield from meshes.solids_of(each, graph, world, unit, role, matrix, turn, scene.plaus.tolerance / 100.0)
    if solids is None:
        return None
    thing = Thing("", role, solids, matrix[:3, 3] * unit, turn)
    around = np.concatenate([meshes.around(solid) for solid in solids]) @ turn.T + thing.place
    thing.low, thing.high = around.min(axis=0), around.max(axis=0)
    shown = next((one.active_material for one in (each, *instances.parts(each)) if one.active_material), None)
    if shown:
        thing.colour = tuple(shown.diffuse_color[:3])
    thing.mass, thing.friction, thing.bounce = instances.mass(each), rigid.friction, rigid.restitution
    if any(path.startswith("rigid_body.") for path in _keyed(each)):
        words = "has keyframes of its rigid body settings, such as Animated"
        world.tell(each.name, f"{words}: those of the first frame count")
    if role == "fixed" and (is_animated(each) or moving_parent(each)):
        words = "follows its keyframes, or its parent's, only if its box Animated is ticked"
        world.tell(each.name, f"{words}: it stays where it is at the first frame")
    if moves:
        _moving(each, thing, world, unit)
    return thing


def _moving(each: bpy.types.Object, thing: Thing, world: World, unit: float) -> None:
    rigid, own = instances.rigid_of(each), each.plaus
    for rate, usual, key in (
        (rigid.linear_damping, DAMPING, "damping"),
        (rigid.angular_damping, ANGULAR_DAMPING, "angular_damping"),
    ):
        if abs(rate - usual) > 1e-6:
            setattr(thing, key, -math.log(max(1e-6, 1.0 - rate)))
    thing.asleep = rigid.use_deactivation and rigid.use_start_deactivated
    if not thing.asleep:
        thing.velocity = tuple(float(part) * unit / 1000.0 for part in own.thrown)
        thing.spin = tuple(float(part) for part in own.turning)
    size, metre = thing.size / 1000.0, unit / 1000.0
    for what in settings.VARIES:
        given = getattr(own, f"{what}_own") * (metre if what in ("position", "velocity") else 1.0)
        thing.vary[what] = levels.amount(what, getattr(own, what), given, size, world.gravity)
    if thing.asleep and any(thing.vary[what] for what in ("velocity", "spin", "release")):
        world.tell(each.name, "starts deactivated: its velocity, spin and time of release do not vary")
        thing.vary |= {"velocity": 0.0, "spin": 0.0, "release": 0.0}
    if rigid.use_margin and rigid.collision_margin > 0:
        world.tell(each.name, "its collision margin is not used: surfaces meet where they are seen")
    if own.animated if own.started else is_animated(each):
        world.tell(each.name, "has keyframes: only its place at the first frame counts")
    if each.constraints:
        world.tell(each.name, "has object constraints, which will act on top of what is baked")
    if above := moving_parent(each):
        world.tell(each.name, f"its parent {above.name} moves: at the start it is where the parent has it at the first "
                   "frame, and from then on it moves by itself")
    above = np.array((each.matrix_world @ each.matrix_basis.inverted_safe()).to_3x3(), dtype=np.float64)
    squares = above.T @ above
    if np.abs(squares - squares[0, 0] * np.eye(3)).max() > EVEN * np.abs(squares).max():
        world.tell(each.name, "its parents are scaled unevenly, so that it would change its shape as it turns: apply "
                   "their scale, or clear the parent", stops=True)
    if any(np.abs(each.delta_location) > 0) or any(abs(part - 1) > 1e-6 for part in each.delta_scale):
        world.tell(each.name, "has delta transforms: apply them", stops=True)
    if not any(rigid.collision_collections[layer] for layer in range(20)) or not rigid.collision_collections[0]:
        world.tell(each.name, "its collision collections are not used: everything can touch everything")


def moving_parent(each: bpy.types.Object) -> bpy.types.Object | None:
    """The nearest of the objects above it that moves."""
    above = each.parent
    while above and not (is_animated(above) or above.constraints or instances.is_active(above)):
        above = above.parent
    return above


def _simulated_above(each: bpy.types.Object) -> bpy.types.Object | None:
    """The nearest of the objects above it that is simulated: Blender then finds a cycle of dependencies."""
    above = each.parent
    while above and not (above.rigid_body and above.rigid_body.type == "ACTIVE"):
        above = above.parent
    return above


def is_animated(each: bpy.types.Object) -> bool:
    """Whether it, or what it hangs on, has keyframes, tracks or drivers."""
    data = each.animation_data
    return bool(data and (data.action or data.nla_tracks or data.drivers)) or bool(
        each.parent and is_animated(each.parent)
    )


def _keyed(each: bpy.types.Object) -> list[str]:
    """The properties of an object that have keyframes of its own."""
    data, own = each.animation_data, each.plaus
    action = own.action if own.started else data.action if data else None
    if action is None:
        return []
    if not hasattr(action, "slots"):
        return [curve.data_path for curve in action.fcurves]
    bags = [bag for layer in action.layers for strip in layer.strips for bag in strip.channelbags]
    return [curve.data_path for bag in bags for curve in bag.fcurves]


def _keys(
    scene: bpy.types.Scene, world: World, objects: dict[str, bpy.types.Object], unit: float
) -> Iterator[None]:
    """The keyframes of animated objects: their places at all frames, without those that their neighbours tell."""
    driven = [each for each in world.things if each.role == "driven"]
    if not driven:
        return
    for frame in range(scene.frame_start, scene.frame_end + 1):
        scene.frame_set(frame)
        for each in driven:
            place, turn, _ = objects[each.name].matrix_world.decompose()
            where = np.array(place, dtype=np.float64) * unit
            time = (frame - scene.frame_start) / world.fps
            each.keys.append(Key(time, where, np.array(turn.to_matrix(), dtype=np.float64)))
        yield
    scene.frame_set(scene.frame_start)
    for each in driven:
        each.keys = _thinned(each.keys)


def _thinned(keys: list[Key]) -> list[Key]:
    """The same motion with fewer keys: one is left out if it lies on the way from the last kept one to the next."""
    kept = keys[:1]
    for now, after in zip(keys[1:], keys[2:]):
        last = kept[-1]
        share = (now.time - last.time) / (after.time - last.time)
        far = np.abs(last.place + share * (after.place - last.place) - now.place).max()
        way = Matrix(last.turn.tolist()).to_quaternion().slerp(Matrix(after.turn.tolist()).to_quaternion(), share)
        if far > KEY_MM or np.abs(np.array(way.to_matrix()) - now.turn).max() > KEY_RAD:
            kept.append(now)
    return [*kept, *keys[-1:]] if len(keys) > 1 else kept


def _joints(scene: bpy.types.Scene, world: World, objects: dict[str, bpy.types.Object], unit: float) -> None:
    rigid = scene.rigidbody_world
    names = {each.name: name for name, each in objects.items()}
    for each in list(rigid.constraints.objects) if rigid and rigid.constraints else []:
        joint = each.rigid_body_constraint
        if joint is None or not joint.enabled:
            continue
        ends = [names.get(end.name, "") if end else "" for end in (joint.object1, joint.object2)]
        body, to = ends[::-1]
        sign = 1.0
        if not (thing := world.thing(body)) or thing.role != "body":
            body, to, sign = to, body, -1.0
        thing = world.thing(body)
        if thing is None or thing.role != "body":
            world.tell(each.name, "holds nothing that moves: left out")
            continue
        if thing.asleep or thing.vary.get("release"):
            world.tell(each.name, f"what it holds must neither start deactivated nor be released later: {thing.name}",
                       stops=True)
        if (end := world.thing(to)) and end.role == "fixed":
            to = ""
        kind: dict[str, Any] | None = None
        if joint.type == "FIXED":
            kind = {"weld": {"breaks_at_n_s": joint.breaking_threshold} if joint.use_breaking else {}}
        elif joint.type == "POINT":
            kind = {"ball": {}}
        elif joint.type == "HINGE":
            matrix = each.matrix_world
            hinge: dict[str, Any] = {"axis": [round(float(matrix[row][2]), 9) for row in range(3)]}
            if joint.use_limit_ang_z:
                limits = sorted(math.degrees(sign * way) for way in (joint.limit_ang_z_lower, joint.limit_ang_z_upper))
                hinge["limits_deg"] = [round(way, 6) for way in limits]
            kind = {"hinge": hinge}
        if kind is None:
            world.tell(each.name, f"is a constraint of type {joint.type.title()}, which Plaus does not have: left out")
            continue
        if joint.use_breaking and joint.type != "FIXED":
            world.tell(each.name, "breaks only if its type is Fixed: it holds")
        place = np.array(each.matrix_world.translation, dtype=np.float64) * unit
        world.joints.append(Joint(plain_name(each.name, [one.name for one in world.joints]), body, to, place, kind))


def _left_out(scene: bpy.types.Scene, world: World) -> None:
    for each in scene.objects:
        if found := instances.parts(each):
            names = ", ".join(one.name for one in found)
            world.tell(each.name, f"is one body of what it shows: {names}")
        if each.instance_type in ("VERTS", "FACES") and any(one.rigid_body for one in each.children):
            world.tell(each.name, "shows copies of a rigid body, of which only the original moves: Object > Apply > "
                       "Make Instances Real")
        elif each.type == "EMPTY" and each.field and each.field.type != "NONE":
            world.tell(each.name, f"its force field ({each.field.type.title()}) is left out")
        if any(one.type == "CLOTH" or one.type == "SOFT_BODY" for one in each.modifiers):
            world.tell(each.name, "is soft: Plaus simulates rigid bodies only")
