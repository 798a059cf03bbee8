"""Empties that show a collection: the rigid bodies in it, and in collections that it shows, count as one, which moves
with the empty."""

from __future__ import annotations

import bpy
from mathutils import Matrix


def placed(each: bpy.types.Object) -> list[tuple[bpy.types.Object, Matrix]]:
    """The rigid bodies of the collection that an object shows, by name, and where they are in the object; none if it
    shows none."""
    if each.instance_type != "COLLECTION" or each.instance_collection is None:
        return []
    inwards, found = Matrix.Translation(-each.instance_collection.instance_offset), []
    for one in sorted(each.instance_collection.all_objects, key=lambda one: one.name):
        there = inwards @ one.matrix_world
        found += [(one, there)] if one.rigid_body else [(inner, there @ matrix) for inner, matrix in placed(one)]
    return found


def parts(each: bpy.types.Object) -> list[bpy.types.Object]:
    """The rigid bodies of the collection that an object shows."""
    return [one for one, _ in placed(each)]


def rigid_of(each: bpy.types.Object) -> bpy.types.RigidBodyObject | None:
    """The rigid body settings of an object, or of the first in the collection that it shows: of one that moves, if any
    does."""
    if each.rigid_body:
        return each.rigid_body
    found = [one.rigid_body for one in parts(each)]
    return next((one for one in found if one.type == "ACTIVE"), found[0] if found else None)


def is_active(each: bpy.types.Object) -> bool:
    """Whether an object is a rigid body of the type Active, or shows one."""
    rigid = rigid_of(each)
    return rigid is not None and rigid.type == "ACTIVE"


def mass(each: bpy.types.Object) -> float:
    """The mass of an object in kg: of all that it shows that is of the type Active."""
    active = [one.rigid_body.mass for one in parts(each) if one.rigid_body.type == "ACTIVE"]
    return float(each.rigid_body.mass if each.rigid_body else sum(active))
