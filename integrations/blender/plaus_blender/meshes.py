"""An object's mesh, and the shapes that it collides with."""

from __future__ import annotations

from collections.abc import Callable, Generator
from concurrent.futures import ThreadPoolExecutor, wait
from typing import TypeVar

import bmesh
import bpy
import numpy as np
from mathutils import Matrix, Vector
from numpy.typing import NDArray

from . import instances, shapes
from .shapes import Solid
from .world import World

Floats = NDArray[np.float64]
Made = TypeVar("Made")

# Most triangles of a mesh. The simulator takes five times as many, but takes long to prepare them.
MOST_TRIANGLES = 200_000
# Meshes with more triangles are looked at in a thread, while Blender goes on.
MANY = 2_000
# Seconds between two looks whether it is done.
LOOK = 0.002
# Shapes of Blender's collisions that fill the box around a mesh.
FILLING = {"BOX": "box", "SPHERE": "ball", "CAPSULE": "capsule", "CYLINDER": "cylinder", "CONE": "cone"}


def _aside(many: bool, work: Callable[[], Made]) -> Generator[None, None, Made]:
    """What `work` makes, which knows nothing of Blender: if it is much, in a thread of its own."""
    if not many:
        return work()
    pool = ThreadPoolExecutor(1)
    try:
        made = pool.submit(work)
        while not wait([made], LOOK).done:
            yield
        return made.result()
    finally:
        pool.shutdown(wait=False)


def _triangles(
    each: bpy.types.Object, graph: bpy.types.Depsgraph, unit: float, matrix: Floats, turn: Floats
) -> tuple[Floats, NDArray[np.int64]] | int:
    """Corners in mm along the object's own axes, with its scale applied, and triangles; or their number if it is too
    large. Modifiers are applied."""
    evaluated = each.evaluated_get(graph)
    try:
        mesh = evaluated.to_mesh()
    except RuntimeError:
        return 0
    try:
        if mesh is None:
            return 0
        mesh.calc_loop_triangles()
        count = len(mesh.loop_triangles)
        if count == 0 or count > MOST_TRIANGLES:
            return count
        corners = np.empty(len(mesh.vertices) * 3)
        mesh.vertices.foreach_get("co", corners)
        faces = np.empty(count * 3, dtype=np.int32)
        mesh.loop_triangles.foreach_get("vertices", faces)
    finally:
        evaluated.to_mesh_clear()
    scaled = turn.T @ matrix[:3, :3] * unit
    triangles = faces.reshape(-1, 3).astype(np.int64)
    if np.linalg.det(scaled) < 0:
        triangles = triangles[:, ::-1]
    return corners.reshape(-1, 3) @ scaled.T, triangles


def solids_of(
    each: bpy.types.Object, graph: bpy.types.Depsgraph, world: World, unit: float, role: str, matrix: Floats,
    turn: Floats, tolerance: float,
) -> Generator[None, None, list[Solid] | None]:
    """The shapes that an object collides with, a little at a time; None, with a finding, if it cannot collide."""
    shown = instances.placed(each)
    if shown or each.rigid_body.collision_shape == "COMPOUND":
        pieces: list[Solid] = []
        inwards = each.matrix_world.inverted()
        children = [(one, inwards @ one.matrix_world) for one in each.children if one.rigid_body]
        for child, within in shown or children:
            there = matrix @ np.array(within, dtype=np.float64)
            axes = np.array(Matrix(there.tolist()).to_quaternion().to_matrix(), dtype=np.float64)
            found = yield from _solids(child, graph, world, unit, role, there, axes, tolerance)
            if found is None:
                return None
            # From the child's axes to those of the whole.
            across, shift = turn.T @ axes, turn.T @ (there[:3, 3] - matrix[:3, 3]) * unit
            for made in found:
                made.turn, made.middle = across @ made.turn, across @ made.middle + shift
                if made.corners is not None:
                    made.corners = made.corners @ across.T + shift
            pieces += found
        if not pieces:
            world.tell(each.name, "is a Compound without children that are rigid bodies", stops=True)
            return None
        return pieces
    return (yield from _solids(each, graph, world, unit, role, matrix, turn, tolerance))


def _solids(
    each: bpy.types.Object, graph: bpy.types.Depsgraph, world: World, unit: float, role: str, matrix: Floats,
    turn: Floats, tolerance: float,
) -> Generator[None, None, list[Solid] | None]:
    found = _triangles(each, graph, unit, matrix, turn)
    if isinstance(found, int):
        if found:
            few = f"{MOST_TRIANGLES:,}"
            world.tell(each.name, f"has {found:,} triangles, more than {few}: add a Decimate modifier", stops=True)
        else:
            world.tell(each.name, "has no faces", stops=role != "fixed")
        return None
    many = len(found[1]) > MANY
    corners, faces = yield from _aside(many, lambda: shapes.cleaned(*found))
    if len(faces) == 0 or (shapes.is_flat(corners) and role != "fixed"):
        world.tell(each.name, "has no volume: give it thickness, with a Solidify modifier for example", stops=True)
        return None
    rigid = each.rigid_body
    if rigid.collision_shape in FILLING and not shapes.is_flat(corners):
        return [shapes.of_bounds(FILLING[rigid.collision_shape], corners)]
    solid = yield from _aside(many, lambda: shapes.recognised(corners, faces, tolerance))
    if solid is not None:
        _, edges = shapes.extents(corners)
        if solid.off > 1e-4 * edges.max():
            world.tell(each.name, f"is taken as a {solid.kind}, {solid.off:.3g} mm off at most")
        return [solid]
    if role == "fixed" and (rigid.collision_shape == "MESH" or shapes.is_flat(corners)):
        return [Solid("mesh", corners=corners, faces=faces)]
    if rigid.collision_shape == "MESH":
        if (yield from _aside(many, lambda: shapes.is_closed(faces))):
            cut = yield from _aside(True, lambda: shapes.cut(corners, faces))
            if cut is not None:
                off = f"stand out of it by up to {cut.deviation:.3g} mm, and it out of them by {cut.lack:.3g} mm"
                world.tell(each.name, f"is hollow, and collides as {len(cut.corners)} convex pieces, which {off}")
                return [_hull(piece) for piece in cut.corners]
        else:
            world.tell(each.name, "has holes or loose faces, and collides as its convex hull: hollows are filled")
    return [_hull((yield from _aside(many, lambda: shapes.outermost(corners))))]


def _hull(corners: Floats) -> Solid:
    """The convex hull of points, which has a volume."""
    made = bmesh.new()
    try:
        for corner in corners.tolist():
            made.verts.new(corner)
        found = bmesh.ops.convex_hull(made, input=list(made.verts), use_existing_faces=False)
        inside = (*found["geom_interior"], *found["geom_unused"])
        gone = {each for each in inside if isinstance(each, bmesh.types.BMVert)}
        bmesh.ops.delete(made, geom=list(gone), context="VERTS")
        bmesh.ops.triangulate(made, faces=list(made.faces))
        bmesh.ops.recalc_face_normals(made, faces=list(made.faces))
        made.verts.index_update()
        places = np.array([tuple(each.co) for each in made.verts], dtype=np.float64)
        faces = np.array([[each.index for each in face.verts] for face in made.faces], dtype=np.int64)
        return Solid("hull", corners=places, faces=faces)
    finally:
        made.free()


def bounds(objects: list[bpy.types.Object]) -> tuple[Floats, Floats]:
    """Two corners of the box around objects, and around what they show, in Blender's unit."""
    shown = [
        (one, each.matrix_world @ there)
        for each in objects
        for one, there in instances.placed(each) or [(each, Matrix())]
    ]
    corners = np.array([matrix @ Vector(corner) for one, matrix in shown for corner in one.bound_box])
    return corners.min(axis=0), corners.max(axis=0)


def around(solid: Solid) -> Floats:
    """Points whose box is that around a shape, in the object's axes."""
    if solid.corners is not None:
        return solid.corners
    size = solid.size
    half = {
        "ball": (size[0],) * 3,
        "box": tuple(edge / 2 for edge in size),
        "capsule": (size[0], size[0], size[-1] / 2 + size[0]),
    }.get(solid.kind, (size[0], size[0], size[-1] / 2))
    signs = np.array([[x, y, z] for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)])
    return np.asarray(signs * np.array(half) @ solid.turn.T + solid.middle)
