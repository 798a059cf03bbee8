"""Shapes that objects collide with. Knows nothing of Blender."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]

# Largest distance between a corner of a mesh and the shape that it is taken for, as a share of its least extent,
# unless the user chooses another one: that of `plaus.recognize`.
TOLERANCE = 0.005
# A mesh is flat if its least extent is below this share of its largest.
FLAT = 1e-5
# In so many directions the outermost corners of a mesh are looked for.
DIRECTIONS = 1000


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
    """Largest distance between the mesh and the shape, faces included."""
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


def is_closed(faces: NDArray[np.int64]) -> bool:
    """Whether triangles enclose something: at each edge as many go one way as the other."""
    ways = np.concatenate([faces[:, [0, 1]], faces[:, [1, 2]], faces[:, [2, 0]]])
    _, number = np.unique(np.sort(ways, axis=1), axis=0, return_inverse=True)
    return not np.bincount(number.reshape(-1), np.sign(ways[:, 1] - ways[:, 0])).any()


def outermost(corners: Floats) -> Floats:
    """The corners that lie farthest in one of many directions, if there are more corners than directions: a hull of
    them is within 0.4 % of a ball's radius, and finer than what the simulator keeps of a hull."""
    if len(corners) <= DIRECTIONS:
        return corners
    # A spiral over the ball, evenly spaced.
    height = 1 - (2 * np.arange(DIRECTIONS) + 1) / DIRECTIONS
    angle = np.arange(DIRECTIONS) * np.pi * (3 - np.sqrt(5))
    across = np.sqrt(1 - height**2)
    ways = np.stack([across * np.cos(angle), across * np.sin(angle), height], axis=1)
    # A few at a time, as all at once would fill the memory.
    found = [np.argmax(some @ corners.T, axis=1) for some in np.array_split(ways, DIRECTIONS // 20)]
    return np.asarray(corners[np.unique(np.concatenate(found))])


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
    """The shape that a mesh is, if it is one."""
    import plaus

    found = plaus.recognize(corners, faces, tolerance=tolerance)
    if found is None:
        return None
    middle, turn = np.array(found.center), np.array(found.rotation)
    return Solid(found.kind, found.size, middle, turn, max(found.deviation, found.gap))


def cut(corners: Floats, faces: NDArray[np.int64]) -> Any:
    """The convex pieces of a closed mesh that is hollow: a `plaus.ConvexPieces`; None of another mesh."""
    import plaus

    return plaus.convex_pieces(corners, faces)


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
