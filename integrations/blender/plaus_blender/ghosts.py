"""Endings as ghosts in the viewport: the chosen one at the current frame, and where things end in all of them."""

from __future__ import annotations

from typing import Any

import bpy
import numpy as np
from mathutils import Matrix

from . import instances, reading, session

# Colours of the chosen ending, of the one it is compared with, and of where things end in the others.
CHOSEN, COMPARED, OTHERS = (1.0, 0.55, 0.1, 0.5), (0.2, 0.8, 0.3, 0.4), (0.3, 0.6, 1.0, 0.12)
# Most triangles of a ghost; of a mesh with more, the box around it is drawn.
MOST = 20_000
# Most endings of which the ends are drawn.
MOST_ENDS = 24

_handle: Any = None
_batches: dict[tuple[int, int], Any] = {}


def poses(scene: bpy.types.Scene) -> list[tuple[bpy.types.Object, Matrix, tuple[float, ...]]]:
    """What to draw: objects, their places in the world, and colours."""
    kept, at_hand = scene.plaus, session.of(scene)
    if at_hand is None or not kept.ghosts:
        return []
    objects, unit = session.objects_of(scene), reading.unit_mm(scene)
    stretches = {name: _stretch(each) for name, each in objects.items()}
    samples = [each.sample for each in at_hand.endings]
    # Blended in this order, the chosen one comes last.
    others = range(min(MOST_ENDS, len(samples))) if kept.all_ends else ()
    todo = [(number, OTHERS) for number in others if samples[number] != kept.compared and number != kept.ending]
    if kept.compared in samples and samples.index(kept.compared) != kept.ending:
        todo.append((samples.index(kept.compared), COMPARED))
    made = []
    for number, colour in [*todo, (kept.ending, CHOSEN)]:
        for name, (places, turns) in session.poses(scene, number).items():
            if name not in objects:
                continue
            moment = scene.frame_current - scene.frame_start
            frame = -1 if colour == OTHERS else min(max(moment, 0), len(places) - 1)
            matrix = Matrix(turns[frame].tolist()).to_4x4()
            matrix.translation = places[frame] / unit
            for shown, there in _shown(objects[name]):
                made.append((shown, matrix @ stretches[name] @ there, colour))
    return made


def _shown(each: bpy.types.Object) -> list[tuple[bpy.types.Object, Matrix]]:
    """The objects with the meshes of one, and where they are in it."""
    return instances.placed(each) or [(each, Matrix())]


def _stretch(each: bpy.types.Object) -> Matrix:
    """What an object's transform does beyond placing and turning: its scale."""
    return Matrix(reading.stretch(each).tolist()).to_4x4()


def _batch(each: bpy.types.Object, shader: Any) -> Any:
    from gpu_extras.batch import batch_for_shader

    mesh = each.data
    key = (each.session_uid, len(mesh.polygons) if hasattr(mesh, "polygons") else 0)
    if key not in _batches:
        evaluated = each.evaluated_get(bpy.context.evaluated_depsgraph_get())
        surface = evaluated.to_mesh()
        surface.calc_loop_triangles()
        if 0 < len(surface.loop_triangles) <= MOST:
            corners = np.empty((len(surface.vertices), 3), dtype=np.float32)
            surface.vertices.foreach_get("co", corners.ravel())
            faces = np.empty((len(surface.loop_triangles), 3), dtype=np.int32)
            surface.loop_triangles.foreach_get("vertices", faces.ravel())
        else:
            corners = [tuple(corner) for corner in each.bound_box]
            faces = [(0, 1, 2), (0, 2, 3), (4, 6, 5), (4, 7, 6), (0, 4, 5), (0, 5, 1), (1, 5, 6), (1, 6, 2), (2, 6, 7),
                     (2, 7, 3), (3, 7, 4), (3, 4, 0)]
        evaluated.to_mesh_clear()
        _batches[key] = batch_for_shader(shader, "TRIS", {"pos": corners}, indices=faces)
    return _batches[key]


def draw() -> None:
    """Draws them; Blender calls this for each 3D viewport."""
    import gpu

    todo = poses(bpy.context.scene)
    if not todo:
        return
    shader = gpu.shader.from_builtin("UNIFORM_COLOR")
    gpu.state.blend_set("ALPHA")
    gpu.state.depth_test_set("LESS_EQUAL")
    shader.bind()
    for each, matrix, colour in todo:
        with gpu.matrix.push_pop():
            gpu.matrix.multiply_matrix(matrix)
            shader.uniform_float("color", colour)
            _batch(each, shader).draw(shader)
    gpu.state.depth_test_set("NONE")
    gpu.state.blend_set("NONE")


def register() -> None:
    """Begins to draw."""
    global _handle
    if not bpy.app.background:
        _handle = bpy.types.SpaceView3D.draw_handler_add(draw, (), "WINDOW", "POST_VIEW")


def unregister() -> None:
    """Stops."""
    global _handle
    if _handle is not None:
        bpy.types.SpaceView3D.draw_handler_remove(_handle, "WINDOW")
        _handle = None
    _batches.clear()
