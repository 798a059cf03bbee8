"""The endings that are at hand for each scene, and what of them is kept in the .blend file."""

from __future__ import annotations

import importlib.util
import os
import shutil
import sys
import time
from collections.abc import Callable, Generator
from dataclasses import dataclass, replace
from typing import Any

import bpy
import bpy.utils.previews
import numpy as np
from numpy.typing import NDArray

from . import asked, reading
from .pictures import Painter
from .sampling import NOTHING, Ending, Job, Refused, Request, requested
from .wishes import requirement
from .world import Finding, World

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
    endings: list[Ending]
    job: Job | None = None
    """What made them."""
    before: Session | None = None
    """What was at hand before."""


_sessions: dict[int, Session] = {}
_pictures: Any = None


def of(scene: bpy.types.Scene) -> Session | None:
    """What is at hand for a scene: the endings of its list, which undo may have changed."""
    at_hand = _sessions.get(scene.session_uid)
    listed = [each.sample for each in scene.plaus.endings]
    return at_hand if at_hand and listed == [each.sample for each in at_hand.endings] else None


def forget() -> None:
    """Forgets everything, as when another file is opened."""
    global _pictures
    _sessions.clear()
    if _pictures is not None:
        bpy.utils.previews.remove(_pictures)
        _pictures = None


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


@dataclass
class Asked:
    """A scene that was read: what is sampled, once `make` is called in whatever thread, and who paints endings."""

    make: Callable[[], Request]
    painter: Painter


def asking(context: bpy.types.Context) -> Generator[None, None, Asked]:
    """Reads the scene, a little at a time, and lists what is to be told about it. Raises `Refused` if it cannot be
    sampled."""
    scene, kept = context.scene, context.scene.plaus
    if lack := missing():
        raise Refused(lack)
    world, objects = yield from reading.reading(context)
    wished = asked.wishes_of(context, world, objects)
    tell(scene, world.findings)
    kept.falls = world.falls
    stops = [f"{each.thing}: {each.words}" if each.thing else each.words for each in world.findings if each.stops]
    if stops:
        raise Refused("\n".join(stops))
    require = [requirement(each, world) for each in wished]
    kept.bodies.clear()
    for each in world.bodies():
        body = kept.bodies.add()
        body.name, body.thing = each.name, objects[each.name]
    seed, wanted, longest, where = kept.seed, kept.wanted, kept.longest, place(scene)

    def make() -> Request:
        try:
            return requested(world, require, seed, wanted, longest, where)
        except OSError as error:
            raise Refused(f"Cannot write to {where}: {error.strerror or error}") from error

    return Asked(make, painter(scene, world))


def painter(scene: bpy.types.Scene, world: World) -> Painter:
    """Who paints endings: from where the scene's camera looks, with the places aimed at in the picture."""
    look = None
    if scene.camera is not None:
        look = np.array(scene.camera.matrix_world, dtype=np.float64)[:3, :3] @ (0.0, 0.0, -1.0)
    unit = reading.unit_mm(scene)
    aims = [each.other for each in scene.plaus.wishes if each.other and each.other.type == "EMPTY"]
    return Painter(world, look, [np.array(each.matrix_world.translation, dtype=np.float64) * unit for each in aims])


def drained(steps: Generator[None, None, Asked]) -> Asked:
    """The end of something that is done a little at a time, without a break."""
    while True:
        try:
            next(steps)
        except StopIteration as end:
            return end.value


def prepare(context: bpy.types.Context) -> Request:
    """Reads the scene at once. Raises `Refused` if it cannot be sampled."""
    return drained(asking(context)).make()


def tell(scene: bpy.types.Scene, findings: list[Finding]) -> None:
    """Fills the panel's list: what stops first."""
    kept = scene.plaus
    kept.findings.clear()
    for each in sorted(findings, key=lambda one: not one.stops):
        row = kept.findings.add()
        row.thing, row.words, row.stops = each.thing, each.words, each.stops


def show(scene: bpy.types.Scene, job: Job) -> int:
    """Lists the endings that a job has found so far; returns their number."""
    if job.request is None or not job.endings:
        return 0
    at_hand = _sessions.get(scene.session_uid)
    if at_hand is None or at_hand.job is not job:
        before = None if at_hand is None else replace(at_hand, before=None)
        at_hand = _sessions[scene.session_uid] = Session(job.request, [], job, before)
        scene.plaus.ending = 0
    count = len(job.endings)
    if count > len(at_hand.endings) or of(scene) is None:
        at_hand.endings = job.endings[:count]
        _fill(scene, at_hand)
    return count


def take(scene: bpy.types.Scene, job: Job, again: bool = False) -> int:
    """Takes over what a job has found, in its final order; returns the number. With `again` these are the endings that
    the file lists."""
    kept = scene.plaus
    if job.failed:
        raise Refused(job.failed)
    if job.run is None or job.best is None or job.request is None:
        raise Refused("It was stopped before it began")
    if not job.best:
        raise Refused(NOTHING)
    show(scene, job)
    at_hand = _sessions[scene.session_uid]
    chosen = at_hand.endings[kept.ending].sample if kept.ending and kept.ending < len(at_hand.endings) else ""
    at_hand.endings = job.best
    _fill(scene, at_hand)
    kept.ending = next((number for number, each in enumerate(job.best) if each.sample == chosen), 0)
    if not again:
        job.request.iterations = None if job.ending == "enough_solutions" else job.run.iterations
        keep(scene, job.request)
        kept.fingerprint = asked.fingerprint(scene)
    return len(job.best)


def back(scene: bpy.types.Scene) -> None:
    """Lists the endings again that were listed before the last sampling."""
    at_hand = _sessions.get(scene.session_uid)
    if at_hand is None or at_hand.before is None:
        raise Refused("There were no other endings")
    before = at_hand.before
    _sessions[scene.session_uid] = before
    _fill(scene, before)
    scene.plaus.ending = 0
    keep(scene, before.request)


def chosen(scene: bpy.types.Scene) -> tuple[Session, int]:
    """The endings at hand, and the number of the chosen one. Raises `Refused` if there is none."""
    at_hand, number = of(scene), scene.plaus.ending
    if at_hand is None or not 0 <= number < len(at_hand.endings):
        raise Refused("Choose an ending first; Bring Back Endings makes those of a saved file again")
    return at_hand, number


def nearest(scene: bpy.types.Scene, to: Ending) -> int:
    """The number of the ending in which things end nearest to where they do in another one."""
    at_hand = of(scene)
    assert at_hand is not None

    def far(each: Ending) -> float:
        both = [name for name in each.poses if name in to.poses]
        return sum(float(np.linalg.norm(each.poses[name][0][-1] - to.poses[name][0][-1])) for name in both)

    return min(range(len(at_hand.endings)), key=lambda number: far(at_hand.endings[number]))


def _fill(scene: bpy.types.Scene, at_hand: Session) -> None:
    """Makes the panel's list that of the endings at hand."""
    rows = scene.plaus.endings
    baked = {each.sample for each in rows if each.baked}
    rows.clear()
    for number, each in enumerate(at_hand.endings, 1):
        row = rows.add()
        row.name = f"Ending {number}: {each.duration:.1f} s, {each.hits} impacts"
        row.sample, row.duration, row.baked = each.sample, each.duration, each.sample in baked


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


def made_by_another(request: Request) -> str:
    """The version of Plaus that a request was made with, if it is another one than this; "" otherwise."""
    import plaus

    return "" if request.version == plaus.__version__ else request.version


def objects_of(scene: bpy.types.Scene) -> dict[str, bpy.types.Object]:
    """The objects that bodies are, under whatever name; those that were deleted are left out."""
    return {each.name: each.thing for each in scene.plaus.bodies if each.thing and each.thing.name in scene.objects}


def poses(scene: bpy.types.Scene, number: int) -> dict[str, tuple[Floats, Floats]]:
    """Poses of an ending at all frames of the scene: places in mm, and rotations."""
    at_hand = of(scene)
    return at_hand.endings[number].poses if at_hand and 0 <= number < len(at_hand.endings) else {}


def icon(scene: bpy.types.Scene, number: int) -> int:
    """Blender's number of the picture of an ending; 0 if there is none."""
    at_hand = of(scene)
    picture = at_hand.endings[number].picture if at_hand and 0 <= number < len(at_hand.endings) else None
    if picture is None:
        return 0
    global _pictures
    if _pictures is None:
        _pictures = bpy.utils.previews.new()
    key = at_hand.endings[number].key
    if key not in _pictures:
        made = _pictures.new(key)
        made.image_size = picture.shape[:2]
        made.image_pixels_float.foreach_set(picture.ravel().astype(np.float32))
    return _pictures[key].icon_id
