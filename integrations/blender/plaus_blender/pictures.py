"""Small pictures of endings: the shapes that are simulated, seen from one side. Knows nothing of Blender."""

from __future__ import annotations

from dataclasses import dataclass
from math import pi

import numpy as np
from numpy.typing import NDArray

from .shapes import Solid
from .world import World

Floats = NDArray[np.float64]

# Edge of a picture in pixels.
EDGE = 128
# Most triangles of a thing; of one with more, the box around it is drawn.
MOST = 3000
# Triangles that cover more pixels than this are filled pixel by pixel, others are covered with points.
LARGE = 300.0
# Points on a pixel of a small triangle.
DENSE = 4.0
# Around where things end, as a share of it, and how many times farther off than most something may end to be in it.
MARGIN, STRAY = 0.12, 2.0
GROUND, SKY, PATH = (0.30, 0.32, 0.35), (0.18, 0.19, 0.21), (0.95, 0.75, 0.35)
LIGHT = np.array([0.35, -0.45, 0.82])
# The direction in which a picture is seen if the scene has no camera.
DOWN = np.array([0.35, 0.8, -0.48])


def _turned(outline: list[tuple[float, float]], around: int = 16) -> tuple[Floats, NDArray[np.int64]]:
    """The surface that an outline (radius, height) makes about the z axis."""
    angles = np.arange(around) * 2 * pi / around
    corners = np.array([(r * np.cos(a), r * np.sin(a), z) for r, z in outline for a in angles])
    faces = []
    for ring in range(len(outline) - 1):
        for a in range(around):
            one, two, up = ring * around + a, ring * around + (a + 1) % around, around
            faces += [(one, two, two + up), (one, two + up, one + up)]
    return corners, np.array(faces)


def surface(solid: Solid) -> tuple[Floats, NDArray[np.int64]]:
    """The corners and triangles of a shape in the axes of its object."""
    size = solid.size
    if solid.corners is not None and solid.faces is not None and len(solid.faces) <= MOST:
        return solid.corners, solid.faces
    if solid.kind in ("ball", "capsule"):
        half = size[1] / 2 if solid.kind == "capsule" else 0.0
        steps = np.linspace(-pi / 2, pi / 2, 9)
        outline = [(size[0] * np.cos(a), size[0] * np.sin(a) + (half if a > 0 else -half)) for a in steps]
        corners, faces = _turned(outline)
    elif solid.kind in ("cylinder", "cone"):
        top, half = size[0] * (solid.kind == "cylinder"), size[1] / 2
        corners, faces = _turned([(0.0, -half), (size[0], -half), (top, half), (0.0, half)])
    else:
        if solid.corners is not None:
            low, high = solid.corners.min(axis=0), solid.corners.max(axis=0)
        else:
            low, high = -np.array(size) / 2, np.array(size) / 2
        corners = np.array([[(low, high)[n >> a & 1][a] for a in range(3)] for n in range(8)])
        quads = [(0, 2, 3, 1), (4, 5, 7, 6), (0, 1, 5, 4), (2, 6, 7, 3), (0, 4, 6, 2), (1, 3, 7, 5)]
        faces = np.array([[q[0], q[k], q[k + 1]] for q in quads for k in (1, 2)])
        if solid.corners is not None:
            return corners, faces
    return corners @ solid.turn.T + solid.middle, faces


@dataclass
class Frame:
    """What a picture shows: its axes right, up and towards the eye, its middle, and half its edge, in mm."""

    axes: Floats
    middle: Floats
    half: float


class Painter:
    """Paints endings of a world, all from the same side."""

    def __init__(self, world: World, look: Floats | None, targets: list[Floats]) -> None:
        """`look`: direction in which it is seen; `targets`: places that should be in the picture."""
        self._things = {each.name: each for each in world.things if each.name != world.ground}
        self._surfaces = {
            each.name: [surface(solid) for solid in each.solids] for each in self._things.values()
        }
        self._look = DOWN if look is None else look
        self._targets = targets
        self._frame: Frame | None = None
        self._still: tuple[Floats, Floats] | None = None

    def _colour(self, name: str) -> Floats:
        """As a screen shows it: Blender's colours are linear."""
        return np.asarray(np.array(self._things[name].colour) ** (1 / 2.2))

    def paint(self, poses: dict[str, tuple[Floats, Floats]]) -> Floats:
        """The picture of an ending (row from below, column, RGBA), where things end and the ways they came."""
        if self._frame is None:
            self._frame = self._framed(poses)
        if self._still is None:
            colours = np.empty((EDGE, EDGE, 3))
            # Level ground reaches to the horizon, above which there is nothing to see.
            colours[:] = GROUND if self._look[2] < 0 else SKY
            self._still = colours, np.full((EDGE, EDGE), -np.inf)
            for name, each in self._things.items():
                if each.role == "fixed":
                    self._draw(*self._still, name, each.place, each.turn, 0.7 * self._colour(name))
        colours, depths = (each.copy() for each in self._still)
        for name, (places, turns) in poses.items():
            if name in self._things:
                self._draw(colours, depths, name, places[-1], turns[-1], self._colour(name))
                self._dots(colours, depths, places)
        for name, each in self._things.items():
            if each.role == "driven" and each.keys:
                last = each.keys[-1]
                self._draw(colours, depths, name, last.place, last.turn, self._colour(name))
        return np.concatenate([np.clip(colours, 0.0, 1.0), np.ones((EDGE, EDGE, 1))], axis=2)

    def _framed(self, poses: dict[str, tuple[Floats, Floats]]) -> Frame:
        towards = -self._look / np.linalg.norm(self._look)
        right = np.cross((0.0, 0.0, 1.0), towards)
        right = np.array([1.0, 0.0, 0.0]) if np.linalg.norm(right) < 1e-6 else right / np.linalg.norm(right)
        axes = np.stack([right, np.cross(towards, right), towards])
        size = max((each.size for each in self._things.values() if each.name in poses), default=1.0)
        ends = np.array([*self._targets, *(places[-1] for places, _ in poses.values())])
        middle = np.median(ends, axis=0)
        # What ends far away would make everything small.
        far = np.linalg.norm(ends - middle, axis=1)
        flat = ends[far <= max(STRAY * np.median(far), 3 * size)] @ axes.T
        low, high = flat.min(axis=0), flat.max(axis=0)
        half = (max(high[:2] - low[:2]) / 2 + size) * (1 + MARGIN)
        return Frame(axes, (low + high) / 2 @ axes, float(half))

    def _seen(self, corners: Floats) -> Floats:
        """Columns, rows and depths of points."""
        assert self._frame is not None
        flat = (corners - self._frame.middle) @ self._frame.axes.T
        flat[:, :2] = (flat[:, :2] / self._frame.half + 1) * (EDGE / 2)
        return np.asarray(flat)

    def _draw(self, colours: Floats, depths: Floats, name: str, place: Floats, turn: Floats, colour: Floats) -> None:
        for corners, faces in self._surfaces[name]:
            there = corners @ turn.T + place
            a, b, c = (there[faces[:, side]] for side in range(3))
            normal = np.cross(b - a, c - a)
            length = np.linalg.norm(normal, axis=1, keepdims=True)
            shade = 0.45 + 0.55 * np.abs(normal / np.maximum(length, 1e-12) @ LIGHT)
            seen = self._seen(there)[faces]
            sides = seen[:, 1:, :2] - seen[:, :1, :2]
            areas = np.abs(sides[:, 0, 0] * sides[:, 1, 1] - sides[:, 0, 1] * sides[:, 1, 0]) / 2
            for number in np.flatnonzero(areas > LARGE):
                _fill(colours, depths, seen[number], colour * shade[number])
            small = np.flatnonzero(areas <= LARGE)
            counts = np.ceil(areas[small] * DENSE).astype(int) + 2
            which = np.repeat(small, counts)
            shares = np.random.default_rng(1).random((len(which), 2))
            over = shares.sum(axis=1) > 1
            shares[over] = 1 - shares[over]
            u, v = shares[:, :1], shares[:, 1:]
            points = seen[which, 0] * (1 - u - v) + seen[which, 1] * u + seen[which, 2] * v
            _points(colours, depths, points, shade[which, None] * colour)

    def _dots(self, colours: Floats, depths: Floats, places: Floats) -> None:
        """The way of something, one point a frame."""
        points = self._seen(places)
        _points(colours, depths, points, np.tile(np.array(PATH), (len(points), 1)))


def _points(colours: Floats, depths: Floats, points: Floats, colour: Floats) -> None:
    inside = (points[:, :2] >= 0).all(axis=1) & (points[:, :2] < EDGE).all(axis=1)
    points, colour = points[inside], colour[inside]
    order = np.argsort(points[:, 2])
    column, row = points[order, :2].astype(int).T
    # Of points on one pixel, the last one stays: the nearest.
    nearest = np.full((EDGE, EDGE), -1)
    nearest[row, column] = order
    row, column = np.nonzero(nearest >= 0)
    chosen = nearest[row, column]
    before = points[chosen, 2] > depths[row, column]
    row, column, chosen = row[before], column[before], chosen[before]
    depths[row, column], colours[row, column] = points[chosen, 2], colour[chosen]


def _fill(colours: Floats, depths: Floats, corners: Floats, colour: Floats) -> None:
    rows, columns = np.mgrid[0:EDGE, 0:EDGE] + 0.5
    (ax, ay, az), (bx, by, bz), (cx, cy, cz) = corners
    whole = (bx - ax) * (cy - ay) - (by - ay) * (cx - ax)
    u = ((columns - ax) * (cy - ay) - (rows - ay) * (cx - ax)) / whole
    v = ((bx - ax) * (rows - ay) - (by - ay) * (columns - ax)) / whole
    depth = az + u * (bz - az) + v * (cz - az)
    inside = (u >= 0) & (v >= 0) & (u + v <= 1) & (depth > depths)
    depths[inside], colours[inside] = depth[inside], colour
