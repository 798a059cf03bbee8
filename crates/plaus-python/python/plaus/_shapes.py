"""Solids that meshes are, and convex pieces."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from plaus import _plaus


@dataclass(frozen=True, eq=False)
class Recognized:
    """A solid that a mesh was taken for. Lengths are in the unit of the mesh."""

    kind: str
    """`ball`, `box`, `cylinder`, `cone` or `capsule`."""
    size: tuple[float, ...]
    """Ball: radius. Box: its edges along its axes. Cylinder and cone: radius and height. Capsule: radius, and distance
    between the centres of its ends."""
    center: NDArray[np.float64]
    """Where its middle is; that of a cone is half-way up."""
    rotation: NDArray[np.float64]
    """Its axes as columns. Round solids have their axis, and cones their tip, along the third one."""
    deviation: float
    """Largest distance of a vertex from its surface."""
    gap: float
    """Largest distance of its surface from the mesh, where that was looked at: the more faces, the less."""


def recognize(vertices: ArrayLike, triangles: ArrayLike, *, tolerance: float = 0.005) -> Recognized | None:
    """The ball, box, cylinder, cone or capsule that a mesh is, in any place and orientation; None if it is none.

    Each vertex must be within `tolerance` times the solid's least extent of its surface. A round mesh may have as few
    as 8 sides, a ball 8 by 4; everywhere on the surface there must be a face.

    Args:
        vertices: an array of shape (n, 3).
        triangles: indices of vertices, of shape (m, 3), in either direction. Others than these do not count.
        tolerance: as a share of the least extent, from 0.

    Raises:
        ValueError: for arrays of other shapes, numbers that are not finite, and indices of no vertex.
    """
    found = _plaus.recognize(vertices, triangles, tolerance)
    if found is None:
        return None
    kind, size, center, rotation, deviation, gap = found
    return Recognized(kind, tuple(size), center, rotation, deviation, gap)


@dataclass(frozen=True, eq=False)
class ConvexPieces:
    """A hollow mesh as convex pieces, which overlap a little. Lengths are in the unit of the mesh."""

    corners: list[NDArray[np.float64]]
    """The corners of each piece, which is their convex hull: an array of shape (n, 3), n up to 64."""
    deviation: float
    """How far the pieces stand out of the mesh at most, at their corners and in between."""
    lack: float
    """How far the mesh stands out of the pieces at most."""


def convex_pieces(vertices: ArrayLike, triangles: ArrayLike) -> ConvexPieces | None:
    """Cuts a mesh that encloses less than 90 % of its convex hull into convex pieces (V-HACD); None of another mesh, and
    of one that encloses less than 0.1 % of it.

    Args:
        vertices: an array of shape (n, 3).
        triangles: indices of vertices, of shape (m, 3): all in one direction as seen from outside, without holes.

    Raises:
        ValueError: for arrays of other shapes, numbers that are not finite, and indices of no vertex.
    """
    found = _plaus.convex_pieces(vertices, triangles)
    return None if found is None else ConvexPieces(*found)
