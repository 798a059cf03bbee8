"""Sampling in a thread of its own, and the endings that a run has. Knows nothing of Blender."""

from __future__ import annotations

import json
import os
import re
import shutil
import sys
import tempfile
import threading
import time
import tomllib
import uuid
from collections.abc import Callable
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from . import world as worlds
from .world import Table, World

if TYPE_CHECKING:
    import plaus

Floats = NDArray[np.float64]

# Blender's z axis is up, that of Plaus's motions y.
UPRIGHT = np.array([[1.0, 0.0, 0.0], [0.0, 0.0, -1.0], [0.0, 1.0, 0.0]])
# Names of files in a run's place.
SCENARIO, RUN = "scenario.toml", "run"
# While a run is made, its thread gives Python's lock back after this many seconds if Blender's own asks for it. Blender
# takes it for each panel that it draws, each time after such a wait.
LOCK = 5e-4
# Looking at a run that is being made takes this share of the time at most: while nothing is listed, and afterwards.
EAGER, PATIENT = 1 / 4, 1 / 10

NOTHING = (
    "No ending was found in time. Let more vary, ask for less (a wider place, fewer things at once), or give it longer"
)


class Refused(Exception):
    """Something that cannot be sampled, in words for the panel."""


@dataclass
class Request:
    """What to sample, and how bodies and objects belong together: all that is needed to make the endings again."""

    scenario: str
    shapes: str
    wanted: int
    longest: float
    """Seconds after which to stop."""
    fps: float
    duration: float
    frames: dict[str, tuple[list[list[float]], list[float]]]
    """Axes and origin of each body in its object, in mm."""
    centres: dict[str, list[float]] = field(default_factory=dict)
    """Centres of gravity in mm in the bodies' own axes, of those where they are not the origin."""
    sizes: dict[str, float] = field(default_factory=dict)
    """Largest extents of the bodies in mm."""
    version: str = ""
    """That of Plaus."""
    iterations: int | None = None
    """How many iterations a run did that was stopped; None if it came to its own end."""

    def to_json(self) -> str:
        """As text, without scenario and shapes."""
        kept = {key: value for key, value in vars(self).items() if key not in ("scenario", "shapes")}
        return json.dumps(kept)

    @staticmethod
    def from_json(text: str, scenario: str, shapes: str) -> Request:
        """From text. Raises `Refused` if it is none of ours."""
        try:
            return Request(scenario=scenario, shapes=shapes, **json.loads(text))
        except (TypeError, ValueError) as error:
            raise Refused("This file keeps no endings") from error


def requested(world: World, require: list[Table], seed: int, wanted: int, longest: float, place: str) -> Request:
    """What to sample for a world. Raises `Refused` with all that Plaus finds wrong with it."""
    import plaus

    frames = {each.name: each.frame() for each in world.bodies()}
    tables = worlds.scenario(world, require, seed)
    request = Request(
        worlds.to_toml(tables), worlds.shapes_obj(world), wanted, longest, world.fps, world.duration,
        {name: (axes.tolist(), origin.tolist()) for name, (axes, origin) in frames.items()},
        sizes={each.name: each.size for each in world.bodies()}, version=plaus.__version__,
    )
    write(request, place)
    _checked(os.path.join(place, SCENARIO), tables)
    probe = worlds.probe(world)
    if probe is not None:
        request.centres = _centres(probe, place)
    return request


def write(request: Request, place: str) -> None:
    """Writes the scenario and its shapes into a folder."""
    try:
        os.makedirs(place, exist_ok=True)
        for name, text in ((SCENARIO, request.scenario), (worlds.SHAPES, request.shapes)):
            if text:
                with open(os.path.join(place, name), "w", encoding="utf-8") as out:
                    out.write(text)
    except OSError as error:
        raise Refused(f"Cannot write to {place}: {error.strerror or error}") from error


def _checked(path: str, tables: Table) -> None:
    import plaus

    try:
        plaus.Scenario.from_file(path)
    except plaus.ScenarioError as error:
        # Every problem once, in the order found.
        said = dict.fromkeys(_in_words(each.key, each.message, tables) for each in error.problems)
        raise Refused("\n".join(said) or str(error)) from error


def _in_words(key: str, message: str, tables: Table) -> str:
    """A message with the name of the thing that its key means by number, and what of it is wrong."""
    place = re.match(r"world\.custom\.(bodies|fixed|driven|joints|materials)\[(\d+)\]\.?(\w*)", key)
    if place is None:
        return message
    name = tables["world"]["custom"][place[1]][int(place[2])]["name"].removeprefix("of_")
    return f"{name}: {place[3].replace('_', ' ')}: {message}" if place[3] else f"{name}: {message}"


def _centres(tables: Table, place: str) -> dict[str, list[float]]:
    """Where the centres of gravity are: where bodies are that begin at known places, without any turn."""
    import plaus

    path = os.path.join(place, "centres.toml")
    with open(path, "w", encoding="utf-8") as out:
        out.write(worlds.to_toml(tables))
    with tempfile.TemporaryDirectory(dir=place) as folder:
        try:
            run = plaus.sample(path, out=os.path.join(folder, RUN), progress=False)
            poses = run.replay("0:0").poses(times=[0.0])
        except (plaus.ScenarioError, plaus.RunError) as error:
            raise Refused(str(error)) from error
    started = {each["name"]: each["at_mm"] for each in tables["world"]["custom"]["bodies"]}
    return {
        name: (UPRIGHT @ poses.position[0, number] * 1000.0 - np.array(started[name])).tolist()
        for number, name in enumerate(poses.bodies)
    }


@dataclass
class Ending:
    """One way in which things can end: a sample of a run, and its motion."""

    sample: str
    log_p: float
    replay: Any
    poses: dict[str, tuple[Floats, Floats]] = field(default_factory=dict)
    """Those of `object_poses` at all frames."""
    picture: Floats | None = None
    """Small picture: rows from below, columns, RGBA."""

    hits: int = 0
    """How many impacts there are."""
    key: str = field(default_factory=lambda: uuid.uuid4().hex)
    """No other ending's, not even that of the same sample of another run."""

    @property
    def duration(self) -> float:
        """Seconds until everything is at rest."""
        return float(self.replay.duration)


class Job:
    """A run in a thread, which also makes the endings. `stop` ends it with what it has found; nothing here waits but
    `wait`."""

    def __init__(
        self,
        request: Request | Callable[[], Request],
        place: str,
        samples: list[str] | None = None,
        paint: Callable[[dict[str, tuple[Floats, Floats]]], Floats] | None = None,
        only_read: bool = False,
    ) -> None:
        """`request` may be a function that makes it, and may raise `Refused`: it is called in the thread. `samples`:
        the endings wanted, instead of those that differ most. `paint` makes a small picture of an ending's poses. With
        `only_read`, nothing is sampled."""
        self._make, self.place, self._samples, self._paint = request, place, samples, paint
        self._only_read = only_read
        self.request: Request | None = None if callable(request) else request
        """What is sampled, once it is known."""
        self.run: plaus.Run | None = None
        """The run, once it has ended."""
        self.endings: list[Ending] = []
        """What has been found so far, in that order."""
        self.best: list[Ending] | None = None
        """In the end: the likeliest, then always the one that looks least like those before."""
        self.failed = ""
        """Why it failed, in words; "" if it has not."""
        self.found, self.seconds, self.ending = 0, 0.0, ""
        self._stop = threading.Event()
        self._until: int | None = None
        self._next_look = 0.0
        self._thread = threading.Thread(target=self._work, name="plaus", daemon=True)

    def start(self, until: int | None = None) -> None:
        """Begins. With `until`, it stops once all chains have done so many iterations: what it has then begins as any
        longer run does."""
        self._until = until
        self._thread.start()

    @property
    def is_alive(self) -> bool:
        """Whether it still samples."""
        return self._thread.is_alive()

    def stop(self) -> None:
        """Has it stop soon."""
        self._stop.set()

    def wait(self, seconds: float | None = None) -> None:
        """Waits until it has ended."""
        self._thread.join(seconds)

    def _work(self) -> None:
        usual = sys.getswitchinterval()
        sys.setswitchinterval(min(usual, LOCK))
        try:
            self._sample()
        except Refused as error:
            self.failed = str(error)
        except Exception as error:  # whatever it is, the panel says it
            # Plaus tries out how to sample before it writes anything.
            early = "nothing was written" in str(error)
            self.failed = NOTHING if early else str(error) or type(error).__name__
        finally:
            sys.setswitchinterval(usual)

    def _sample(self) -> None:
        import plaus

        if callable(self._make):
            self.request = self._make()
        assert self.request is not None
        if self._only_read:
            return
        self._clear()
        self.run = plaus.sample(
            os.path.join(self.place, SCENARIO),
            out=os.path.join(self.place, RUN),
            solutions=self.request.wanted,
            max_time=self.request.longest,
            threads=threads(),
            callback=self._heard,
            progress=False,
        )
        self.ending = self.run.ending or ""
        self.found = len(self.run.solutions)
        most = self.run.most_different(self.request.wanted)
        samples = [str(each.sample) for each in most] if self._samples is None else self._samples
        self._add(self.run, samples)
        known = {each.sample: each for each in self.endings}
        self.best = [known[sample] for sample in samples]

    def _clear(self) -> None:
        assert self.request is not None
        write(self.request, self.place)
        try:
            shutil.rmtree(os.path.join(self.place, RUN))
        except FileNotFoundError:
            pass
        except OSError as error:
            raise Refused(f"Cannot write to {self.place}: {error.strerror or error}") from error

    def _heard(self, progress: plaus.Progress) -> bool:
        self.found, self.seconds = progress.distinct, progress.seconds
        if self._until is not None and min(progress.iterations) >= self._until:
            return False
        if self._samples is None and self.found > len(self.endings) and self.seconds >= self._next_look:
            self._look()
        return not self._stop.is_set()

    def _look(self) -> None:
        """Takes endings from the run while it is being made, so far as it has been written."""
        import plaus

        assert self.request is not None
        begun = time.perf_counter()
        try:
            run = plaus.Run(os.path.join(self.place, RUN))
            self._add(run, [str(each.sample) for each in run.solutions[: self.request.wanted]])
        except (plaus.RunError, Refused):
            pass  # the next look, or the end, will do
        share = PATIENT if self.endings else EAGER
        self._next_look = self.seconds + (time.perf_counter() - begun) / share

    def _add(self, run: plaus.Run, samples: list[str]) -> None:
        known = {each.sample for each in self.endings}
        assert self.request is not None
        for ending in endings_called(run, [sample for sample in samples if sample not in known]):
            last = round(self.request.duration * self.request.fps)
            ending.poses = object_poses(ending, self.request, np.arange(last + 1) / self.request.fps)
            ending.hits = ending.replay.events.count
            if self._paint is not None:
                ending.picture = self._paint(ending.poses)
            self.endings.append(ending)


def threads() -> int:
    """How many threads sample: one for each core, but for one that is left to Blender where there are more than two.
    Endings do not depend on it."""
    cores = os.cpu_count() or 1
    return cores - 1 if cores > 2 else cores


def endings_called(run: plaus.Run, samples: list[str]) -> list[Ending]:
    """The endings that samples are. Raises `Refused` if the run has not all of them."""
    import plaus

    try:
        replays = run.replays(samples)
    except plaus.RunError as error:
        raise Refused(f"These endings cannot be made again: {error}") from error
    return [Ending(sample, replay.log_p, replay) for sample, replay in zip(samples, replays)]


def near(request: Request, ending: Ending) -> dict[str, tuple[Floats, float]]:
    """Where bodies end, and how far from there is still like it, in mm: the body's size, or a quarter of its way."""
    poses = ending.replay.poses(times=[0.0, ending.duration])
    made = {}
    for number, name in enumerate(poses.bodies):
        if name in request.frames:
            first, last = poses.position[:, number] @ UPRIGHT.T * 1000.0
            made[name] = last, max(request.sizes[name], float(np.linalg.norm(last - first)) / 4)
    return made


def like(request: Request, ending: Ending) -> Request:
    """What to sample for endings in which every body ends near where it does in `ending`."""
    tables = tomllib.loads(request.scenario)
    custom = tables["world"]["custom"]
    wanted = tables.setdefault("require", [])
    for name, (there, far) in near(request, ending).items():
        centre, far = worlds.numbers(there), worlds.number(far)
        inside = {"body": name, "centre_mm": centre, "radius_mm": far, "how": "at_end", "scale_mm": far / 2}
        wanted.append({"inside": inside})
    # Endings this alike differ by less.
    custom["distinct_mm"] = worlds.number(max(0.001, custom["distinct_mm"] / 5))
    return replace(request, scenario=worlds.to_toml(tables), iterations=None)


def object_poses(ending: Ending, request: Request, times: Floats) -> dict[str, tuple[Floats, Floats]]:
    """Places in mm (time, xyz) and rotations (time, 3, 3) of the objects of all bodies, z up, at `times` in seconds.

    A motion ends when everything is at rest: from then on, poses are those of its end.
    """
    poses = ending.replay.poses(times=np.minimum(times, ending.duration))
    made = {}
    for number, name in enumerate(poses.bodies):
        if name not in request.frames:
            continue
        turns = UPRIGHT @ matrices(poses.orientation[:, number])
        places = poses.position[:, number] @ UPRIGHT.T * 1000.0
        places = places - turns @ np.array(request.centres.get(name, (0.0, 0.0, 0.0)))
        axes, origin = (np.array(each) for each in request.frames[name])
        turns = turns @ axes.T
        made[name] = (places - turns @ origin, turns)
    return made


def impacts(ending: Ending, name: str) -> Floats:
    """Times in seconds at which a body hits something or is hit."""
    events = ending.replay.events
    concerned = [name in pair for pair in zip(events["body"], events["other"])]
    return np.asarray(events["t"], dtype=np.float64)[np.array(concerned, dtype=bool)]


def matrices(quaternions: Floats) -> Floats:
    """Rotation matrices of unit quaternions x, y, z, w."""
    x, y, z, w = np.moveaxis(quaternions, -1, 0)
    rows = [
        [1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
        [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
        [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)],
    ]
    return np.moveaxis(np.array(rows), (0, 1), (-2, -1))
