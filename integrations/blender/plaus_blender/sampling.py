"""Sampling in a thread of its own, and the endings that a run has. Knows nothing of Blender."""

from __future__ import annotations

import json
import os
import re
import shutil
import tempfile
import threading
from dataclasses import dataclass, field
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
        version=plaus.__version__,
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


class Job:
    """A run in a thread. `stop` ends it with what it has found; nothing here waits but `wait`."""

    def __init__(self, request: Request, place: str) -> None:
        self.request, self.place = request, place
        self.run: plaus.Run | None = None
        """The run, once it has ended."""
        self.failed = ""
        """Why it failed, in words; "" if it has not."""
        self.found, self.seconds, self.ending = 0, 0.0, ""
        self._stop = threading.Event()
        self._until: int | None = None
        self._thread = threading.Thread(target=self._work, name="plaus", daemon=True)

    def start(self, until: int | None = None) -> None:
        """Writes the scenario and begins. With `until`, it stops once all chains have done so many iterations: what it
        has then begins as any longer run does."""
        write(self.request, self.place)
        try:
            shutil.rmtree(os.path.join(self.place, RUN), ignore_errors=False)
        except FileNotFoundError:
            pass
        except OSError as error:
            raise Refused(f"Cannot write to {self.place}: {error.strerror or error}") from error
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
        try:
            import plaus

            self.run = plaus.sample(
                os.path.join(self.place, SCENARIO),
                out=os.path.join(self.place, RUN),
                solutions=self.request.wanted,
                max_time=self.request.longest,
                callback=self._heard,
                progress=False,
            )
            self.ending = self.run.ending or ""
            self.found = len(self.run.solutions)
        except Exception as error:  # whatever it is, the panel says it
            # Plaus tries out how to sample before it writes anything.
            early = "nothing was written" in str(error)
            self.failed = NOTHING if early else str(error) or type(error).__name__

    def _heard(self, progress: plaus.Progress) -> bool:
        self.found, self.seconds = progress.distinct, progress.seconds
        if self._until is not None and min(progress.iterations) >= self._until:
            return False
        return not self._stop.is_set()


@dataclass
class Ending:
    """One way in which things can end: a sample of a run, and its motion once it is needed."""

    sample: str
    log_p: float
    replay: Any

    @property
    def duration(self) -> float:
        """Seconds until everything is at rest."""
        return float(self.replay.duration)


def endings(run: plaus.Run, wanted: int) -> list[Ending]:
    """The run's endings: the likeliest, then always the one that looks least like those before."""
    return endings_called(run, [str(each.sample) for each in run.most_different(wanted)])


def endings_called(run: plaus.Run, samples: list[str]) -> list[Ending]:
    """The endings that samples are. Raises `Refused` if the run has not all of them."""
    import plaus

    try:
        replays = run.replays(samples)
    except plaus.RunError as error:
        raise Refused(f"These endings cannot be made again: {error}") from error
    return [Ending(sample, replay.log_p, replay) for sample, replay in zip(samples, replays)]


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
