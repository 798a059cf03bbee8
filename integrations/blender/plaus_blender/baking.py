"""Writes an ending as keyframes: an action for each object, or a track of its NLA stack."""

from __future__ import annotations

from typing import Any

import bpy
import numpy as np
from mathutils import Matrix
from numpy.typing import NDArray

from . import reading
from .sampling import Ending, Request, impacts, object_poses

Floats = NDArray[np.float64]

# Keys are this share of a frame apart at least, and this many steps of the numbers in which Blender keeps frames, of 24
# bits. Blender takes a moment within a ten-thousandth of a frame of a key for that of the key. An impact nearer to
# another key than this gets none: at 24 frames per second what hits at 5 m/s is then off by less than 0.1 mm.
APART, STEPS = 2.5e-4, 4
# A key is left out if it and its neighbours are alike to within this, in Blender's units and parts of a quaternion.
ALIKE = 1e-7
PATHS = (("location", 3), ("rotation_quaternion", 4))


def frames_of(ending: Ending, request: Request, name: str, begin: int) -> Floats:
    """Frames since the start, which is at frame `begin`, at which a body gets keys: all whole ones, and those of its
    impacts."""
    last = round(request.duration * request.fps)
    whole = np.arange(last + 1, dtype=np.float64)
    apart = max(APART, STEPS * float(np.spacing(np.float32(begin + last))))
    between: list[float] = []
    for frame in np.sort(impacts(ending, name) * request.fps):
        near = abs(frame - round(frame)) < apart or (between and frame - between[-1] < apart)
        if frame < last and not near:
            between.append(float(frame))
    return np.sort(np.concatenate([whole, between]))


def bake(
    scene: bpy.types.Scene, request: Request, objects: dict[str, bpy.types.Object], ending: Ending, label: str,
    as_tracks: bool = False,
) -> int:
    """Bakes an ending; returns the number of objects. The rigid body world is switched off, as it would move them
    instead; `restore` undoes all of it."""
    unit, begin = reading.unit_mm(scene), scene.frame_start
    found = [(name, objects[name]) for name in request.frames if name in objects]
    with reading.first_frame(scene):
        for _, each in found:
            _keep_start(each)
    if scene.rigidbody_world is not None:
        scene.rigidbody_world.enabled = False
    now = scene.frame_current, scene.frame_subframe
    # What hangs on something else comes after it.
    for name, each in sorted(found, key=lambda one: _depth(one[1])):
        frames = frames_of(ending, request, name, begin)
        places, turns = object_poses(ending, request, frames / request.fps)[name]
        location, rotation = _basis(scene, each, frames + begin, places / unit, turns)
        each.rotation_mode = "QUATERNION"
        columns = np.concatenate([location, rotation], axis=1)
        action = _action(each, f"{each.name} {label}", frames + begin, columns)
        if as_tracks:
            _as_track(each, action, label, begin)
    if (scene.frame_current, scene.frame_subframe) != now:
        scene.frame_set(now[0], subframe=now[1])
    return len(found)


def restore(scene: bpy.types.Scene) -> int:
    """Takes baked keys away and puts objects back where they were; returns how many there were."""
    count = 0
    for each in scene.objects:
        kept = each.plaus
        if not kept.started:
            continue
        data = each.animation_data
        if data is not None:
            for track in [one for one in data.nla_tracks if one.name.startswith("Plaus")]:
                data.nla_tracks.remove(track)
            data.action = kept.action
            if kept.action and hasattr(data, "action_slot"):
                data.action_slot = next((one for one in kept.action.slots if one.identifier == kept.slot), None)
            if not (data.action or data.nla_tracks or data.drivers):
                each.animation_data_clear()
        each.rotation_mode = kept.mode
        each.matrix_basis = _matrix(kept.basis)
        kept.action, kept.started = None, False
        count += 1
    if count and scene.rigidbody_world is not None:
        scene.rigidbody_world.enabled = True
    return count


def _keep_start(each: bpy.types.Object) -> None:
    kept, data = each.plaus, each.animation_data
    if not kept.started:
        kept.start = [part for row in each.matrix_world for part in row]
        kept.basis = [part for row in each.matrix_basis for part in row]
        kept.mode, kept.animated = each.rotation_mode, reading.is_animated(each)
        kept.action = data.action if data else None
        slot = getattr(data, "action_slot", None)
        kept.slot = slot.identifier if slot else ""
        kept.started = True


def _depth(each: bpy.types.Object) -> int:
    return 0 if each.parent is None else 1 + _depth(each.parent)


def _matrix(flat: Any) -> Matrix:
    return Matrix([list(flat)[row * 4 : row * 4 + 4] for row in range(4)])


def _basis(
    scene: bpy.types.Scene, each: bpy.types.Object, frames: Floats, places: Floats, turns: Floats
) -> tuple[Floats, Floats]:
    """Location and rotation channels of an object for places and rotations in the world at some frames."""
    count = len(places)
    there = np.zeros((count, 4, 4))
    there[:, :3, :3], there[:, :3, 3], there[:, 3, 3] = turns @ reading.stretch(each), places, 1.0
    if each.parent is not None:
        moves = reading.moving_parent(each) is not None
        above = np.empty((count if moves else 1, 4, 4))
        for number, frame in enumerate(frames[: len(above)]):
            if moves:
                scene.frame_set(int(frame), subframe=frame % 1.0)
            above[number] = (
                each.parent.matrix_world @ each.matrix_parent_inverse
                if each.parent_type == "OBJECT"
                else each.matrix_world @ each.matrix_basis.inverted()
            )
        there = np.linalg.inv(above) @ there
    # What its own scale does, a mirrored one too, comes before its rotation.
    quaternions = _quaternions(there[:, :3, :3] / np.array(each.scale))
    return there[:, :3, 3], quaternions


def _quaternions(turns: Floats) -> Floats:
    """Unit quaternions w, x, y, z of matrices, each on the side of the one before it."""
    made = np.array([Matrix(turn.tolist()).to_quaternion() for turn in turns])
    flips = np.sign(np.einsum("ij,ij->i", made[1:], made[:-1]))
    flips[flips == 0] = 1.0
    made[1:] *= np.cumprod(flips)[:, None]
    return made


def _action(each: bpy.types.Object, name: str, frames: Floats, columns: Floats) -> bpy.types.Action:
    """A new action of the object, with linear keys."""
    # What is still, at the end above all, needs no keys.
    alike = np.abs(np.diff(columns, axis=0)).max(axis=1) < ALIKE
    keep = np.ones(len(frames), dtype=bool)
    keep[1:-1] = ~(alike[:-1] & alike[1:])
    frames, columns = frames[keep], columns[keep]
    action = bpy.data.actions.new(name)
    data = each.animation_data or each.animation_data_create()
    data.action = action
    curves = _curves(action, each, data)
    column = 0
    for path, width in PATHS:
        for index in range(width):
            curve = curves.new(path, index=index)
            curve.keyframe_points.add(len(frames))
            flat = np.stack([frames, columns[:, column]], axis=1).astype(np.float32).ravel()
            for what in ("co", "handle_left", "handle_right"):
                curve.keyframe_points.foreach_set(what, flat)
            linear = bpy.types.Keyframe.bl_rna.properties["interpolation"].enum_items["LINEAR"].value
            curve.keyframe_points.foreach_set("interpolation", np.full(len(frames), linear, dtype=np.int32))
            column += 1
    # `update` of a curve would join keys within a hundredth of a frame. These are in order already.
    action.update_tag()
    return action


def _curves(action: bpy.types.Action, each: bpy.types.Object, data: Any) -> Any:
    """Where an action keeps the curves of an object: in a slot of it from Blender 4.4 on."""
    if not hasattr(action, "slots"):
        return action.fcurves
    slot = action.slots.new("OBJECT", each.name)
    data.action_slot = slot
    layer = action.layers.new("Layer")
    return layer.strips.new(type="KEYFRAME").channelbag(slot, ensure=True).fcurves


def _as_track(each: bpy.types.Object, action: bpy.types.Action, label: str, begin: int) -> None:
    """Moves the action into a new track that plays alone of all that Plaus made."""
    data = each.animation_data
    data.action = None
    for other in data.nla_tracks:
        if other.name.startswith("Plaus"):
            other.mute = True
    track = data.nla_tracks.new()
    track.name = f"Plaus {label}"
    strip = track.strips.new(action.name, begin, action)
    strip.blend_type, strip.extrapolation = "REPLACE", "HOLD"
    if hasattr(strip, "action_slot") and strip.action_slot is None:
        strip.action_slot = action.slots[0]
