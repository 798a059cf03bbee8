"""The simulator alone: worlds built in code, run from many starts at once on all cores.

    from plaus import sim

    world = sim.World()
    world.law(friction=0.35, restitution=0.5)
    world.plane((0, 0, 0), (0, 0, 1))
    world.cuboid((0.016, 0.016, 0.016))
    throws = world.run(position=[[[0, 0, 0.1]]] * 1000, spin=numpy.random.normal(0, 20, (1000, 1, 3)))

Exact and event-driven: no time step in flight, the same bits on every thread and machine. Units are SI. You choose the
axes; in the ready-made worlds, `World.bins` and `World.dice`, z points up.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any, Union

from plaus import _plaus
from plaus._numbers import _whole

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import ArrayLike, NDArray

    Floats = NDArray[np.float64]

Vector = Union[Sequence[float], "Floats"]

__all__ = ["Batch", "World"]

#: The meaning of the numbers in `Batch.ending`.
ENDINGS = ("at rest", "time over", "out of events", "not finite", "crushed")


class Batch:
    """The results of many starts: arrays whose first axis is the start."""

    def __init__(self, made: dict[str, Any], times: Sequence[float]) -> None:
        self.ending: NDArray[np.uint8] = made["ending"]
        """How each run ended: 0 at rest, 1 time over, 2 out of events, 3 not finite, 4 crushed (see `sim.ENDINGS`)."""
        self.time: Floats = made["time"]
        """When each run ended, in s."""
        self.impacts: NDArray[np.int64] = made["impacts"]
        """Number of impacts in each run."""
        self.position: Floats = made["position"]
        """Positions at the end, in m: (start, body, xyz)."""
        self.velocity: Floats = made["velocity"]
        """Velocities at the end, in m/s: (start, body, xyz)."""
        self.spin: Floats = made["spin"]
        """Angular velocities at the end, in rad/s, in world axes: (start, body, xyz)."""
        self.orientation: Floats = made["orientation"]
        """Unit quaternions from body axes to world axes: (start, body, xyzw). In worlds of balls always 0, 0, 0, 1."""
        self.times = list(times)
        """Times of the poses below, in s."""
        self.positions: Floats | None = made.get("positions")
        """Positions at `times`: (start, time, body, xyz); None if no times were given."""
        self.orientations: Floats | None = made.get("orientations")
        """Orientations at `times`: (start, time, body, xyzw); None if no times were given."""
        self.events: dict[str, Any] | None = made.get("events")
        """Impacts of all starts as columns: `start`, `t` (s), `body`, `other` (-1: scenery), `point` (m), `normal`,
        `speed` (m/s), `impulse` (N s); None if they were not asked for."""

    def __len__(self) -> int:
        return len(self.ending)

    def __repr__(self) -> str:
        rest = int((self.ending == 0).sum())
        return f"<Batch of {len(self)} runs: {rest} at rest>"


class World:
    """A world of bodies and scenery.

    Materials are names; `law` says what happens when two of them meet. If all bodies are balls, among planes, meshes
    and caps, the simulator for balls runs the world; it is faster and keeps no orientations. Any other world, among
    planes, blocks and tables, is run by the simulator for bodies that turn. `engine` (`"marbles"`, `"rigid"`) chooses
    one where both are possible.
    """

    def __init__(
        self,
        *,
        gravity: Vector = (0.0, 0.0, -9.81),
        duration: float = 20.0,
        accuracy: str = "standard",
        events: int | None = None,
        engine: str | None = None,
    ) -> None:
        """`gravity` in m/s²; `duration`: the longest that a run lasts, in s; `accuracy`: `draft`, `standard`, `fine` or
        `reference`; `events`: the most events of a run, for each body."""
        if engine not in (None, "marbles", "rigid"):
            raise ValueError(f"engine is {engine!r}, but must be 'marbles' or 'rigid'")
        self._how: dict[str, Any] = {
            "gravity": _vector("gravity", gravity),
            "duration": float(duration),
            "accuracy": accuracy,
            "events": events,
        }
        self._engine = engine
        self._materials: dict[str, int] = {}
        self._bodies: list[dict[str, Any]] = []
        self._surfaces: list[dict[str, Any]] = []
        self._laws: dict[tuple[int, int], dict[str, Any]] = {}
        self._default: dict[str, float] = {}
        self._made: _plaus.SimWorld | None = None

    @classmethod
    def bins(
        cls, marbles: int = 10, *, duration: float | None = None, accuracy: str = "standard", events: int | None = 1000
    ) -> World:
        """Marbles of 12 mm over 7 × 5 bins of 20 mm, as in figure 10 of the paper; z up, corner at the origin, 36 mm
        deep."""
        longest = 0.1 * marbles + 1.0 if duration is None else duration
        return cls._ready(_plaus.SimWorld.bins(marbles, float(longest), accuracy, events))

    @classmethod
    def dice(cls, dice: int = 1, *, accuracy: str = "standard", events: int | None = None) -> World:
        """Dice of 16 mm on a flat table at z = 0."""
        return cls._ready(_plaus.SimWorld.dice(dice, accuracy, events))

    @classmethod
    def from_scenario(cls, scenario: _plaus.Scenario) -> World:
        """The world of a scenario without its randomness: a level table with mean friction and restitution, bins with
        vertices in their regular places, pins on their spots. z is up.

        Raises `ValueError` for a scene that has no simulator, because its motion has a closed form.
        """
        return cls._ready(_plaus.SimWorld.of_scenario(scenario))

    @classmethod
    def _ready(cls, made: _plaus.SimWorld) -> World:
        world = cls()
        world._made = made
        return world

    def _change(self) -> None:
        if self._made is not None and not self._bodies and not self._surfaces:
            raise ValueError("this world is ready-made: to add things, build one with World()")
        self._made = None

    def _material(self, name: str) -> int:
        return self._materials.setdefault(name, len(self._materials))

    def law(
        self,
        a: str | None = None,
        b: str | None = None,
        *,
        friction: float,
        restitution: float,
        static_friction: float = 0.0,
        tangential: float = 0.0,
        rolling: float = 0.0,
        spinning: float = 0.0,
    ) -> None:
        """What happens when materials `a` and `b` meet; without names, for all pairs without a law of their own.

        `friction`: Coulomb's coefficient; `static_friction`: the one for surfaces that do not slide, if it is larger
        (not among marbles); `restitution` and `tangential` (of spheres) from 0 to 1; `rolling` and
        `spinning`: resistance, a torque over normal force times radius.
        """
        self._change()
        law = dict(
            friction=float(friction),
            static_friction=float(static_friction),
            restitution=float(restitution),
            tangential=float(tangential),
            rolling=float(rolling),
            spinning=float(spinning),
        )
        if a is None:
            self._default = law
            return
        first, second = self._material(a), self._material(a if b is None else b)
        self._laws[min(first, second), max(first, second)] = law

    def _body(self, kind: str, material: str, density: float | None, mass: float | None, **what: Any) -> int:
        self._change()
        if density is not None and mass is not None:
            raise ValueError("a body has a density or a mass, not both")
        if density is None and mass is None:
            density = 1000.0
        all_of_it = {"size": [], "points": [], "rounding": 0.0, **what}
        self._bodies.append(
            {"kind": kind, "material": self._material(material), "density": density, "mass": mass, **all_of_it}
        )
        return len(self._bodies) - 1

    def ball(
        self, radius: float, *, density: float | None = None, mass: float | None = None, material: str = "default"
    ) -> int:
        """Adds a ball; returns its number. Give a density (kg/m³, default 1000) or a mass (kg)."""
        return self._body("ball", material, density, mass, size=[float(radius)])

    def cuboid(
        self,
        edges: Vector,
        *,
        rounding: float = 0.0,
        density: float | None = None,
        mass: float | None = None,
        material: str = "default",
    ) -> int:
        """Adds a cuboid with these edges (m) and rounding radius (m); returns its number."""
        return self._body("cuboid", material, density, mass, size=_vector("edges", edges), rounding=float(rounding))

    def hull(
        self,
        points: ArrayLike,
        *,
        rounding: float = 0.0,
        density: float | None = None,
        mass: float | None = None,
        material: str = "default",
    ) -> int:
        """Adds the convex hull of points (m); returns its number. Its axes are principal axes, its origin the centre
        of gravity."""
        return self._body("hull", material, density, mass, points=_rows("points", points), rounding=float(rounding))

    def pin(self, *, density: float | None = None, mass: float | None = None, material: str = "default") -> int:
        """Adds a regulation bowling pin, upright along z; returns its number."""
        return self._body("pin", material, density, mass)

    def _surface(self, kind: str, material: str, **what: Any) -> None:
        self._change()
        nothing = {"vectors": [], "triangles": [], "radius": 0.0, "hollow": False, "heights": []}
        self._surfaces.append({"kind": kind, "material": self._material(material), **nothing, **what})

    def plane(self, point: Vector, normal: Vector, *, material: str = "default") -> None:
        """Adds a half space: everything behind the plane is solid."""
        self._surface("plane", material, vectors=[_vector("point", point), _vector("normal", normal)])

    def block(self, low: Vector, high: Vector, *, material: str = "default") -> None:
        """Adds a solid box along the axes, between two corners. For bodies that turn."""
        self._surface("block", material, vectors=[_vector("low", low), _vector("high", high)])

    def table(
        self, heights: ArrayLike, spacing: float, *, origin: Sequence[float] = (0.0, 0.0), material: str = "default"
    ) -> None:
        """Adds a table `z = height(x, y)`: a cubic b-spline over control heights (m) on a grid. The first index runs
        along x; beyond the grid, the heights at its edge continue. For bodies that turn."""
        corner = [float(origin[0]), float(origin[1]), 0.0]
        self._surface("table", material, heights=_rows("heights", heights), radius=float(spacing), vectors=[corner])

    def mesh(self, vertices: ArrayLike, triangles: ArrayLike, *, material: str = "default") -> None:
        """Adds triangles; seen from outside, their corners run counter-clockwise. For balls."""
        import numpy

        corners = numpy.asarray(triangles)
        if corners.ndim != 2 or corners.shape[1] != 3 or corners.dtype.kind not in "iu" or (corners < 0).any():
            raise ValueError("triangles: rows of three indices of vertices are expected")
        self._surface("mesh", material, vectors=_rows("vertices", vertices), triangles=corners.tolist())

    def cap(
        self, centre: Vector, radius: float, low: Vector, high: Vector, *, hollow: bool, material: str = "default"
    ) -> None:
        """Adds the part of a sphere inside a box with these corners: a bowl if `hollow`, else a dome. For balls."""
        vectors = [_vector("centre", centre), _vector("low", low), _vector("high", high)]
        self._surface("cap", material, vectors=vectors, radius=float(radius), hollow=bool(hollow))

    def _world(self) -> _plaus.SimWorld:
        if self._made is None:
            if not self._bodies:
                raise ValueError("this world has no bodies")
            balls = all(body["kind"] == "ball" for body in self._bodies)
            for_balls = all(surface["kind"] in ("plane", "mesh", "cap") for surface in self._surfaces)
            engine = self._engine or ("marbles" if balls and for_balls else "rigid")
            count = len(self._materials)
            pairs = [(a, b) for a in range(count) for b in range(a, count)]
            missing = [pair for pair in pairs if pair not in self._laws and not self._default]
            if missing:
                names = list(self._materials)
                what = ", ".join(f"{names[a]} and {names[b]}" for a, b in missing)
                raise ValueError(f"there is no law for {what}: add one with law(friction=…, restitution=…)")
            laws = [{"a": a, "b": b, **self._laws.get((a, b), self._default)} for a, b in pairs]
            made = _plaus.SimWorld(self._bodies, self._surfaces, laws, engine=engine, materials=count, **self._how)
            self._made = made
        return self._made

    @property
    def places(self) -> Floats:
        """Places in m where bodies can start, upright and at rest, without touching each other: (body, xyz). Empty for
        a world that you built."""
        import numpy

        return numpy.asarray(self._world().places, dtype=float).reshape(-1, 3)

    @property
    def bodies(self) -> int:
        """Number of bodies."""
        return self._world().bodies

    def run(
        self,
        position: ArrayLike,
        *,
        velocity: ArrayLike | None = None,
        spin: ArrayLike | None = None,
        orientation: ArrayLike | None = None,
        release: ArrayLike | None = None,
        until: float = float("inf"),
        times: Sequence[float] | Floats = (),
        events: bool = False,
        threads: int = 0,
    ) -> Batch:
        """Runs the world from many starts, each until everything is at rest, `until` (s), or the world's duration.

        Arrays are (start, body, xyz): `position` (m) of centres of gravity, `velocity` (m/s), `spin` (rad/s, world
        axes). `orientation` is (start, body, xyzw). `release` (start, body) is when a body appears, in s. By default,
        bodies are at rest and upright, and appear at once. `times`: when to keep poses; `events`: whether to keep
        impacts; `threads`: 0 means one per core.

        Raises `WorldError`, which names the start, if bodies overlap or a number is not finite; `MemoryError` if the
        arrays do not fit into memory.
        """
        moments = [float(time) for time in times]
        made = self._world().run(
            position,
            velocity=velocity,
            spin=spin,
            orientation=orientation,
            release=release,
            until=float(until),
            times=moments,
            events=bool(events),
            threads=_whole("threads", threads, 0),
        )
        return Batch(made, moments)


def _vector(name: str, value: Any) -> list[float]:
    try:
        numbers = [float(number) for number in value]
    except TypeError:
        raise TypeError(f"{name}: three numbers are expected, not {value!r}") from None
    if len(numbers) != 3:
        raise ValueError(f"{name}: three numbers are expected, not {len(numbers)}")
    return numbers


def _rows(name: str, value: Any) -> list[list[float]]:
    import numpy

    rows = numpy.asarray(value, dtype=float)
    if rows.ndim != 2:
        raise ValueError(f"{name}: an array of rows is expected, not one of shape {rows.shape}")
    made: list[list[float]] = rows.tolist()
    return made
