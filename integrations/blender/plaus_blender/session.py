"""The endings that are at hand for each scene, and what of them is kept in the .blend file."""

from __future__ import annotations

import importlib.util
import os
import shutil
import sys
import time
from dataclasses import dataclass, field

import bpy
import numpy as np
from numpy.typing import NDArray

from . import reading
from .sampling import NOTHING, Ending, Job, Refused, Request, endings, endings_called, object_poses, requested
from .world import Finding

Floats = NDArray[np.float64]

# Packages of extensions are called bl_ext.REPOSITORY.NAME.
EXTENSION = __package__.startswith("bl_ext.")
# Seconds after which a run is deleted.
OLD = 86_400.0
# Texts in the .blend file that say what was sampled.
SCENARIO_TEXT, SHAPES_TEXT = "Plaus scenario of {}", "Plaus shapes of {}"


@dataclass
class Session:
    """What is at hand for a scene."""

    request: Request
    endings: list[Ending] = field(default_factory=list)
    poses: dict[str, dict[str, tuple[Floats, Floats]]] = field(default_factory=dict)
    """Poses of each ending at all frames, once they were needed."""


_sessions: dict[int, Session] = {}


def of(scene: bpy.types.Scene) -> Session | None:
    """What is at hand for a scene."""
    return _sessions.get(scene.session_uid)


def forget() -> None:
    """Forgets everything, as when another file is opened."""
    _sessions.clear()


def missing() -> str:
    """Why nothing can be simulated here, in words; "" if it can."""
    if importlib.util.find_spec("plaus") is not None:
        return ""
    version = ".".join(map(str, sys.version_info[:2]))
    return (
        f"This download has no simulator for this computer ({sys.platform}, Python {version}): install the zip that "
        "was built for it"
    )


def runs() -> str:
    """The folder of all runs: in that of the extension, or a temporary one if this is no extension."""
    if EXTENSION:
        return bpy.utils.extension_path_user(".".join(__package__.split(".")[:3]), path="runs", create=False)
    return os.path.join(bpy.app.tempdir, "plaus")


def place(scene: bpy.types.Scene) -> str:
    """The folder for the scene's runs, of this Blender alone."""
    return os.path.join(runs(), f"{os.getpid()}-{scene.session_uid}")


def clear_old() -> None:
    """Deletes runs that nothing has written to for a day: endings are in memory, and a file keeps what it needs."""
    if not os.path.isdir(runs()):
        return
    for entry in os.scandir(runs()):
        if time.time() - entry.stat().st_mtime > OLD:
            shutil.rmtree(entry.path, ignore_errors=True)


def prepare(context: bpy.types.Context) -> Request:
    """Reads the scene and lists what is to be told about it. Raises `Refused` if it cannot be sampled."""
    scene, kept = context.scene, context.scene.plaus
    if lack := missing():
        raise Refused(lack)
    world, objects = reading.read(context)
    wishes = reading.wishes_of(context, world, objects)
    tell(scene, world.findings)
    stops = [f"{each.thing}: {each.words}" if each.thing else each.words for each in world.findings if each.stops]
    if stops:
        raise Refused("\n".join(stops))
    from .wishes import requirement

    require = [requirement(each, world) for each in wishes]
    try:
        request = requested(world, require, kept.seed, kept.wanted, kept.longest, place(scene))
    except OSError as error:
        raise Refused(f"Cannot write to {place(scene)}: {error.strerror or error}") from error
    kept.bodies.clear()
    for name in request.frames:
        body = kept.bodies.add()
        body.name, body.thing = name, objects[name]
    return request


def tell(scene: bpy.types.Scene, findings: list[Finding]) -> None:
    """Fills the panel's list: what stops first."""
    kept = scene.plaus
    kept.findings.clear()
    for each in sorted(findings, key=lambda one: not one.stops):
        row = kept.findings.add()
        row.thing, row.words, row.stops = each.thing, each.words, each.stops


def take(scene: bpy.types.Scene, job: Job, again: bool = False) -> int:
    """Takes over what a job has found, or `again` those endings that the file lists; returns their number."""
    kept = scene.plaus
    if job.failed:
        raise Refused(job.failed)
    if job.run is None:
        raise Refused("It was stopped before it began")
    names, chosen = [each.sample for each in kept.endings], kept.ending if again else 0
    kept.endings.clear()
    kept.ending = 0
    found = endings_called(job.run, names) if again else endings(job.run, job.request.wanted)
    if not found:
        raise Refused(NOTHING)
    _sessions[scene.session_uid] = Session(job.request, found)
    for number, each in enumerate(found, 1):
        row = kept.endings.add()
        hits = each.replay.events.count
        row.name = f"Ending {number}: {each.duration:.1f} s, {hits} impacts"
        row.sample, row.duration = each.sample, each.duration
    kept.ending = chosen
    if not again:
        job.request.iterations = None if job.ending == "enough_solutions" else job.run.iterations
        keep(scene, job.request)
    return len(found)


def keep(scene: bpy.types.Scene, request: Request) -> None:
    """Keeps what was sampled in the .blend file."""
    for title, text in ((SCENARIO_TEXT, request.scenario), (SHAPES_TEXT, request.shapes)):
        name = title.format(scene.name)[:63]
        block = bpy.data.texts.get(name) or bpy.data.texts.new(name)
        block.from_string(text)
        block.use_fake_user = True
    scene.plaus.kept = request.to_json()


def kept_request(scene: bpy.types.Scene) -> Request:
    """What the .blend file says was sampled. Raises `Refused` if it says nothing."""
    texts = [bpy.data.texts.get(title.format(scene.name)[:63]) for title in (SCENARIO_TEXT, SHAPES_TEXT)]
    if not scene.plaus.kept or texts[0] is None:
        raise Refused("This file keeps no endings")
    return Request.from_json(scene.plaus.kept, texts[0].as_string(), texts[1].as_string() if texts[1] else "")


def objects_of(scene: bpy.types.Scene) -> dict[str, bpy.types.Object]:
    """The objects that bodies are, under whatever name; those that were deleted are left out."""
    return {each.name: each.thing for each in scene.plaus.bodies if each.thing and each.thing.name in scene.objects}


def poses(scene: bpy.types.Scene, number: int) -> dict[str, tuple[Floats, Floats]]:
    """Poses of an ending at all frames of the scene: places in mm, and rotations."""
    session = of(scene)
    if session is None or not 0 <= number < len(session.endings):
        return {}
    ending = session.endings[number]
    if ending.sample not in session.poses:
        last = round(session.request.duration * session.request.fps)
        times = np.arange(last + 1) / session.request.fps
        session.poses[ending.sample] = object_poses(ending, session.request, times)
    return session.poses[ending.sample]
