"""Shapes of meshes, against Blender's own primitives."""

import math

import bmesh
import numpy as np
import pytest
from mathutils import Euler

from plaus_blender import shapes


def mesh(make, **keys):
    """Corners and triangles of a mesh that `bmesh` makes."""
    made = bmesh.new()
    make(made, **keys)
    bmesh.ops.triangulate(made, faces=made.faces)
    made.verts.index_update()
    corners = np.array([tuple(each.co) for each in made.verts], dtype=float)
    faces = np.array([[each.index for each in face.verts] for face in made.faces])
    made.free()
    return corners, faces


def capsule(radius, length):
    """A ball drawn apart at its equator."""
    corners, faces = mesh(bmesh.ops.create_uvsphere, u_segments=32, v_segments=16, radius=radius)
    corners[:, 2] += np.sign(np.round(corners[:, 2], 6)) * length / 2
    # The equator's corners stay in the middle: they lie on the side of the rod.
    return corners, faces


CONE = {"segments": 32, "cap_ends": True}
BOX = mesh(bmesh.ops.create_cube, size=1.0)
CASES = [
    ("box", (1.0, 2.0, 3.0), (BOX[0] * (1.0, 2.0, 3.0), BOX[1])),
    ("ball", (2.0,), mesh(bmesh.ops.create_uvsphere, u_segments=32, v_segments=16, radius=2.0)),
    ("ball", (1.0,), mesh(bmesh.ops.create_icosphere, subdivisions=3, radius=1.0)),
    ("cylinder", (1.0, 3.0), mesh(bmesh.ops.create_cone, radius1=1, radius2=1, depth=3, **CONE)),
    ("cone", (1.0, 2.0), mesh(bmesh.ops.create_cone, radius1=1, radius2=0, depth=2, **CONE)),
    ("capsule", (0.5, 2.0), capsule(0.5, 2.0)),
]


@pytest.mark.parametrize("turn", [(0, 0, 0), (math.pi / 2, 0, 0), (0, math.pi / 2, 0), (0.3, -0.7, 1.1)])
@pytest.mark.parametrize("kind, size, found", CASES, ids=[f"{case[0]}-{number}" for number, case in enumerate(CASES)])
def test_primitives_are_recognised_in_any_orientation(kind, size, found, turn):
    corners, faces = found
    axes = np.array(Euler(turn).to_matrix(), dtype=float)
    moved = corners @ axes.T + (0.3, -2.0, 5.0)
    solid = shapes.recognised(moved, faces)
    assert solid is not None and solid.kind == kind
    if kind == "box":
        assert np.allclose(sorted(solid.size), size, atol=1e-5)
    else:
        assert np.allclose(solid.size, size, atol=1e-5)
    assert np.allclose(solid.middle, (0.3, -2.0, 5.0), atol=1e-5)
    assert np.allclose(solid.turn @ solid.turn.T, np.eye(3)) and np.linalg.det(solid.turn) > 0
    if kind == "cone":
        assert np.allclose(solid.turn[:, 2], axes[:, 2], atol=1e-5), "the tip points where it should"
    # A ball of 320 triangles is 2.4 % of its radius outside of them, one of 8 sides 14 %.
    assert solid.off < 0.07 * max(solid.size)


def test_what_is_nearly_a_shape_is_none():
    prism = mesh(bmesh.ops.create_cone, radius1=1, radius2=1, depth=3, segments=6, cap_ends=True)
    assert shapes.recognised(*prism) is None, "six sides are no cylinder"
    # A cup: a cylinder without its upper face.
    corners, faces = mesh(bmesh.ops.create_cone, radius1=1, radius2=1, depth=3, **CONE)
    open_above = faces[corners[faces][:, :, 2].min(axis=1) < 1.4]
    assert shapes.recognised(corners, open_above) is None
    half = mesh(bmesh.ops.create_uvsphere, u_segments=32, v_segments=16, radius=1.0)
    upper = half[1][half[0][half[1]][:, :, 2].min(axis=1) >= -1e-6]
    assert shapes.recognised(half[0], upper) is None
    egg = half[0] * (1.0, 1.0, 0.9)
    assert shapes.recognised(egg, half[1]) is None and shapes.recognised(egg, half[1], tolerance=0.2) is not None


def test_volumes_are_those_of_fine_meshes():
    for kind, size, (corners, faces) in CASES:
        exact = shapes.volume(shapes.Solid(kind, size))
        inside = shapes.volume(shapes.Solid("hull", corners=corners, faces=faces))
        # An inscribed ball of 32 by 16 faces lacks 2.3 % of its volume, one of 320 triangles 3.5 %.
        assert 0.96 * exact < inside <= exact * (1 + 1e-6), kind


def test_doubled_corners_and_thin_triangles_go():
    corners = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [1, 0, 0], [2, 0, 0]], dtype=float)
    places, faces = shapes.cleaned(corners, np.array([[0, 1, 2], [0, 3, 4]]))
    assert len(places) == 4 and len(faces) == 1
    assert shapes.is_flat(places)


def test_the_outermost_corners_make_almost_the_same_hull():
    ways = np.random.default_rng(1).normal(size=(20_000, 3))
    ball = ways / np.linalg.norm(ways, axis=1, keepdims=True)
    kept = shapes.outermost(np.concatenate([ball, 0.9 * ball]))
    assert len(kept) <= shapes.DIRECTIONS and np.allclose(np.linalg.norm(kept, axis=1), 1.0)
    assert (ball[:2000] @ kept.T).max(axis=1).min() > 1 - 0.004
    box = np.concatenate([np.array([[x, y, z] for x in (0, 1) for y in (0, 1) for z in (0, 1)]), 0.5 * ball / 2 + 0.5])
    assert (box[:8, None] == shapes.outermost(box)).all(axis=2).any(axis=1).all(), "all corners of a box"
