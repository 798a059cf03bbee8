"""Recognises meshes that are balls, boxes, cylinders, cones or capsules. Knows nothing of Blender.

A shape that the simulator has a closed form for is faster and more exact than a mesh with many faces, and a ball that
is a ball rolls. A mesh is taken for a shape if no corner and no middle of a face is farther from its surface than the
tolerance, and if their areas agree.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from itertools import permutations, product

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]

# Largest distance between a mesh and the shape that it is taken for, as a share of the mesh's size, unless the user
# chooses another one. A ball of 16 by 8 faces lies within it, a prism of eight sides does not.
TOLERANCE = 0.02
# Largest difference between the areas of the two. That of a ball of 16 by 8 faces is 4 %; a box without a lid lacks a
# sixth.
AREA = 0.1
# A mesh is flat if its least extent is below this share of its largest.
FLAT = 1e-5


@dataclass
class Solid:
    """A shape about its own middle, and where it lies in the object: a point p of it is at `turn @ p + middle`.

    `size`: ball: radius; box: edges; cylinder and cone: radius, height; capsule: radius, distance between the centres
    of its ends; hull and mesh: nothing, as `corners` and `faces` say everything. Lengths are in the unit of the mesh.
    """

    kind: str
    size: tuple[float, ...] = ()
    middle: Floats = field(default_factory=lambda: np.zeros(3))
    turn: Floats = field(default_factory=lambda: np.eye(3))
    off: float = 0.0
    """Largest distance between the mesh and the shape."""
    corners: Floats | None = None
    faces: NDArray[np.int64] | None = None


def extents(corners: Floats) -> tuple[Floats, Floats]:
    """Middle and edges of the box around points."""
    low, high = corners.min(axis=0), corners.max(axis=0)
    return (low + high) / 2, high - low


def is_flat(corners: Floats) -> bool:
    """Whether all points lie in one plane."""
    spread = np.linalg.svd(corners - corners.mean(axis=0), compute_uv=False)
    return bool(spread[0] == 0.0 or spread[-1] < FLAT * spread[0])


def cleaned(corners: Floats, faces: NDArray[np.int64]) -> tuple[Floats, NDArray[np.int64]]:
    """The same surface with corners in one place joined, and without triangles that have no area."""
    _, size = extents(corners)
    cell = max(float(size.max()) * 1e-7, 1e-12)
    _, first, number = np.unique(np.round(corners / cell), axis=0, return_index=True, return_inverse=True)
    joined = number.reshape(-1)[faces]
    places = corners[first]
    sharp = np.linalg.norm(normals(places, joined), axis=1) > 1e-12 * float(size.max()) ** 2
    return places, joined[sharp]


def normals(corners: Floats, faces: NDArray[np.int64]) -> Floats:
    """A normal of each triangle, twice as long as the triangle has area."""
    a, b, c = (corners[faces[:, side]] for side in range(3))
    return np.asarray(np.cross(b - a, c - a))


def volume(solid: Solid) -> float:
    """The volume of a shape; that of a hull is the volume inside its mesh, which must be closed and convex."""
    size = solid.size
    if solid.kind == "ball":
        return 4 / 3 * np.pi * size[0] ** 3
    if solid.kind == "box":
        return size[0] * size[1] * size[2]
    if solid.kind == "cylinder":
        return np.pi * size[0] ** 2 * size[1]
    if solid.kind == "cone":
        return np.pi * size[0] ** 2 * size[1] / 3
    if solid.kind == "capsule":
        return np.pi * size[0] ** 2 * (size[1] + 4 / 3 * size[0])
    assert solid.corners is not None and solid.faces is not None
    a, b, c = (solid.corners[solid.faces[:, side]] for side in range(3))
    return abs(float(np.einsum("ij,ij->", a, np.cross(b, c)))) / 6


def recognised(corners: Floats, faces: NDArray[np.int64], tolerance: float = TOLERANCE) -> Solid | None:
    """The simplest shape that a mesh is, if it is one."""
    whole = float(extents(corners)[1].max())
    if len(corners) < 4 or len(faces) < 4 or whole <= 0.0 or is_flat(corners):
        return None
    points = np.concatenate([corners, corners[faces].mean(axis=1)])
    area = float(np.linalg.norm(normals(corners, faces), axis=1).sum()) / 2
    for turn in _axes(corners):
        best: Solid | None = None
        for solid in _candidates(corners, turn):
            there = (points - solid.middle) @ solid.turn
            solid.off = float(np.abs(_distance(solid, there)).max())
            if solid.off <= tolerance * whole and abs(area / _area(solid) - 1.0) <= AREA:
                # Of shapes that fit about equally well, the first one is the simplest.
                if best is None or solid.off < 0.5 * best.off:
                    best = solid
        if best is not None:
            return best
    return None


def of_bounds(kind: str, corners: Floats) -> Solid:
    """The shape of a kind that fills the box around a mesh, with its axis along z, as Blender's rigid bodies use it."""
    middle, (x, y, z) = extents(corners)
    wide = max(x, y) / 2
    size = {
        "box": (x, y, z),
        "ball": (max(x, y, z) / 2,),
        "cylinder": (wide, z),
        "cone": (wide, z),
        "capsule": (wide, max(z - 2 * wide, 1e-3 * wide)),
    }[kind]
    return Solid(kind, tuple(float(each) for each in size), middle)


def signed_axis(turn: Floats) -> NDArray[np.int64] | None:
    """A rotation by quarter turns as whole numbers; None for any other rotation."""
    near = np.round(turn)
    return near.astype(np.int64) if np.abs(turn - near).max() < 1e-6 else None


def _axes(corners: Floats) -> list[Floats]:
    """Rotations whose axes a shape may have: those of the object, and the principal ones of its corners."""
    middle = corners - corners.mean(axis=0)
    _, principal = np.linalg.eigh(middle.T @ middle)
    if np.linalg.det(principal) < 0:
        principal[:, 0] *= -1
    return [np.eye(3), principal]


def _candidates(corners: Floats, turn: Floats) -> list[Solid]:
    """The shapes around points whose axes are those of `turn`."""
    there = corners @ turn
    middle, size = extents(there)
    solids = [Solid("box", tuple(map(float, size)), turn @ middle, turn)]
    solids.append(Solid("ball", (float(np.linalg.norm(there - middle, axis=1).max()),), turn @ middle, turn))
    for kind, axis in product(("cylinder", "capsule", "cone"), (2, 0, 1)):
        for sign in (1, -1) if kind == "cone" else (1,):
            about = turn @ _upright(axis, sign)
            own = (corners - turn @ middle) @ about
            radius = float(np.hypot(own[:, 0], own[:, 1]).max())
            length = float(size[axis])
            if kind == "capsule":
                length -= 2 * radius
                if length <= 0.05 * radius:
                    continue
            solids.append(Solid(kind, (radius, length), turn @ middle, about))
    return solids


def _upright(axis: int, sign: int) -> Floats:
    """A rotation by quarter turns that takes z to an axis, or to its opposite."""
    for order, signs in product(permutations(range(3)), product((1, -1), repeat=3)):
        turn = np.zeros((3, 3))
        for column, (row, way) in enumerate(zip(order, signs)):
            turn[row, column] = way
        if order[2] == axis and signs[2] == sign and np.linalg.det(turn) > 0:
            return turn
    raise AssertionError("one of them is it")


def _distance(solid: Solid, points: Floats) -> Floats:
    """Signed distances of points from the surface of a shape; inside a cone they are bounds."""
    size = solid.size
    wide = np.hypot(points[:, 0], points[:, 1])
    z = points[:, 2]
    if solid.kind == "ball":
        return np.asarray(np.linalg.norm(points, axis=1) - size[0])
    if solid.kind == "box":
        return _outside(np.abs(points) - np.array(size) / 2)
    if solid.kind == "cylinder":
        return _outside(np.stack([wide - size[0], np.abs(z) - size[1] / 2], axis=1))
    if solid.kind == "capsule":
        along = np.clip(z, -size[1] / 2, size[1] / 2)
        return np.asarray(np.hypot(wide, z - along) - size[0])
    radius, height = size
    side = (wide * height + (z - height / 2) * radius) / np.hypot(radius, height)
    return np.asarray(np.maximum(side, -height / 2 - z))


def _outside(over: Floats) -> Floats:
    far = np.linalg.norm(np.maximum(over, 0.0), axis=1)
    return np.asarray(far + np.minimum(over.max(axis=1), 0.0))


def _area(solid: Solid) -> float:
    size = solid.size
    if solid.kind == "ball":
        return 4 * np.pi * size[0] ** 2
    if solid.kind == "box":
        x, y, z = size
        return 2 * (x * y + y * z + z * x)
    radius, length = size
    if solid.kind == "cylinder":
        return 2 * np.pi * radius * (radius + length)
    if solid.kind == "capsule":
        return 2 * np.pi * radius * (length + 2 * radius)
    return float(np.pi * radius * (radius + np.hypot(radius, length)))
