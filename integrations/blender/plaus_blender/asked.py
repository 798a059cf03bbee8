"""What must happen, as read from a Blender scene, and whether a scene is still the one that was sampled."""

from __future__ import annotations

import hashlib
from typing import Any

import bpy
import numpy as np

from . import instances, reading, settings, wishes
from .world import World


def wishes_of(
    context: bpy.types.Context, world: World, objects: dict[str, bpy.types.Object]
) -> list[wishes.Wish]:
    """What must happen. What cannot be asked for becomes a finding of the world."""
    scene, made = context.scene, []
    unit = reading.unit_mm(scene)
    names = {each.name: name for name, each in objects.items()}
    if not len(scene.plaus.wishes):
        world.tell("", "Nothing must happen yet: select objects and add something under What Must Happen", stops=True)
    for each in scene.plaus.wishes:
        said = words(each)
        other = None if each.other is None else _place(each.other, names, world, unit)
        wish = wishes.Wish(
            each.kind, names.get(each.thing.name, "") if each.thing else "", other, each.within * unit, each.axis,
            (frame_of(scene, each) or 0) - scene.frame_start, each.frames, said,
        )
        lack = wishes.lacks(wish, world)
        if frame_of(scene, each) is None:
            lack = f"there is no marker {each.marker} any more"
        if lack:
            world.tell(each.thing.name if each.thing else "", f"{said}: {lack}", stops=True)
        else:
            made.append(wish)
    return made


def frame_of(scene: bpy.types.Scene, wish: Any) -> int | None:
    """The frame that a wish is about: that of its marker, if it has one; None if that is gone."""
    if not wish.marker or "frame" not in wishes.KINDS[wish.kind][2]:
        return int(wish.frame)
    marker = scene.timeline_markers.get(wish.marker)
    return None if marker is None else int(marker.frame)


def words(wish: Any) -> str:
    """A wish as a sentence."""
    name, _, needs = wishes.KINDS[wish.kind]
    parts = [wish.thing.name if wish.thing else "?", name.lower()]
    if "frame" in needs:
        parts.append(wish.marker or str(wish.frame))
    if "axis" in needs:
        parts.append(wish.axis.replace("minus_", "-").upper())
    if "other" in needs or ("other?" in needs and wish.other):
        parts.append(wish.other.name if wish.other else "?")
    return " ".join(parts)


def _place(other: bpy.types.Object, names: dict[str, str], world: World, unit: float) -> wishes.Place:
    name = names.get(other.name, "")
    thing = world.thing(name)
    if thing is not None:
        return wishes.Place((thing.low + thing.high) / 2, thing.low, thing.high, name)
    matrix = np.array(other.matrix_world, dtype=np.float64)
    half = other.empty_display_size if other.type == "EMPTY" else 1.0
    box = [[x * half, y * half, z * half] for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)]
    corners = np.array(box if other.type == "EMPTY" else other.bound_box, dtype=np.float64)
    there = (corners @ matrix[:3, :3].T + matrix[:3, 3]) * unit
    middle = matrix[:3, 3] * unit if other.type == "EMPTY" else (there.min(axis=0) + there.max(axis=0)) / 2
    return wishes.Place(middle, there.min(axis=0), there.max(axis=0), name)


def fingerprint(scene: bpy.types.Scene) -> str:
    """Text that another start, shape, setting or requirement changes; baking and playing do not. What is animated or
    modified counts by its names alone, as reading it takes long."""
    metre = reading.unit_mm(scene)
    told: list[Any] = [metre, tuple(scene.gravity), scene.use_gravity, scene.frame_start, scene.frame_end]
    told += [reading.fps(scene), scene.plaus.ground, round(scene.plaus.tolerance, 4)]
    for each in reading.bodies(scene):
        rigid, own = instances.rigid_of(each), each.plaus
        told += [[part for row in there for part in row] for _, there in instances.placed(each)]
        told += [rigid.type, rigid.enabled, rigid.kinematic, instances.mass(each), rigid.friction]
        told += [rigid.restitution, rigid.collision_shape, rigid.use_deactivation, rigid.use_start_deactivated]
        told += [rigid.linear_damping, rigid.angular_damping, tuple(own.thrown), tuple(own.turning)]
        told += [(getattr(own, what), getattr(own, f"{what}_own")) for what in settings.VARIES]
        if not (own.animated if own.started else reading.is_animated(each)):
            basis = own.basis if own.started else [part for row in each.matrix_basis for part in row]
            told.append([round(part, 4) for part in basis])
        told += [len(each.data.vertices) if each.type == "MESH" else 0, [one.name for one in each.modifiers]]
    rigid = scene.rigidbody_world
    for each in list(rigid.constraints.objects) if rigid and rigid.constraints else []:
        joint = each.rigid_body_constraint
        if joint is not None:
            told += [joint.type, joint.enabled, joint.use_breaking, joint.breaking_threshold, joint.use_limit_ang_z]
            told += [joint.limit_ang_z_lower, joint.limit_ang_z_upper, [round(part, 4) for part in each.location]]
    for wish in scene.plaus.wishes:
        told += [words(wish), frame_of(scene, wish), wish.within, wish.frames, wish.axis]
        if wish.other and instances.rigid_of(wish.other) is None:
            told.append([round(part, 4) for row in wish.other.matrix_world for part in row])
    return hashlib.sha256(repr(told).encode()).hexdigest()[:16]
