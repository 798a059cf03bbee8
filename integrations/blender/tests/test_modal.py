"""Sampling in the background, with a window's part played by a stand-in: Blender's module has no windows."""

import os
import subprocess
import sys
import time
from contextlib import nullcontext
from types import SimpleNamespace

import bpy
import pytest
from conftest import cube, ready

from plaus_blender import asked, running, session


class Window:
    """Notes what is shown, in place of window manager and workspace."""

    def __init__(self, scene):
        self.scene, self.window, self.shown, self.timers = scene, None, [], 0
        self.window_manager = self.workspace = self
        self.temp_override = lambda **_: nullcontext()
        self.progress_begin = self.modal_handler_add = lambda *_: None
        self.progress_update = self.progress_end = lambda *_: None
        self.status_text_set = self.shown.append
        # What reads the scene needs the rest of the context.
        self.view_layer = bpy.context.view_layer
        self.evaluated_depsgraph_get = bpy.context.evaluated_depsgraph_get

    def event_timer_add(self, *_, **__):
        """A timer that the test plays."""
        self.timers += 1

    def event_timer_remove(self, _):
        """It is gone."""
        self.timers -= 1


class Operator:
    """An operator outside of Blender."""

    report = staticmethod(lambda *_: None)


for _name in ("finish", "invoke", "modal", "_read", "cancel"):
    setattr(Operator, _name, getattr(running._Sampling, _name))
Operator.jobs, Operator.again, Operator.only_read = running.PLAUS_OT_sample.jobs, False, False


@pytest.mark.parametrize("stopped", [False, True], ids=["to its end", "by Esc"])
def test_it_samples_while_blender_goes_on(scene, stopped):
    ready(cube())
    scene.plaus.wanted = 500 if stopped else 2
    window, operator = Window(scene), Operator()
    tick, escape = SimpleNamespace(type="TIMER", value="NOTHING"), SimpleNamespace(type="ESC", value="PRESS")
    begun = time.perf_counter()
    assert operator.invoke(window, None) == {"RUNNING_MODAL"}
    assert Operator().invoke(window, None) == {"CANCELLED"} and "already" in scene.plaus.status
    move = SimpleNamespace(type="MOUSEMOVE", value="NOTHING")
    assert operator.modal(window, move) == {"RUNNING_MODAL"}, "nothing else is done while the scene is read"
    while operator._job is None:
        assert operator.modal(window, tick) == {"RUNNING_MODAL"}
    assert operator.modal(window, move) == {"PASS_THROUGH"}
    made = operator.modal(window, tick)
    while made == {"PASS_THROUGH"} and time.perf_counter() - begun < 200:
        time.sleep(0.02)
        if stopped and operator._job.found >= 2:
            operator.modal(window, escape)
        made = operator.modal(window, tick)
    assert made == {"FINISHED"}, scene.plaus.status
    assert len(scene.plaus.endings) >= 2 and session.of(scene) is not None
    shown = [text for text in window.shown if text]
    # A short run may be over before there is anything to show.
    assert window.shown[-1] is None and (shown or not stopped) and all("Esc stops" in text for text in shown)
    assert scene.frame_current == scene.frame_start
    assert window.timers == 0 and not running._Sampling.running


def test_endings_are_listed_as_they_come(scene):
    # More endings than are found in minutes, so that it does not end by itself.
    ready(cube(), within=0.1)
    scene.plaus.wanted, scene.plaus.longest = 500, 3600.0
    window, operator = Window(scene), Operator()
    tick, escape = SimpleNamespace(type="TIMER", value="NOTHING"), SimpleNamespace(type="ESC", value="PRESS")
    operator.invoke(window, None)
    begun = time.perf_counter()
    while len(scene.plaus.endings) < 3 and time.perf_counter() - begun < 200:
        operator.modal(window, tick)
        time.sleep(0.02)
    assert operator._job.is_alive and operator._job.run is None, "it still samples"
    scene.plaus.ending = 2
    listed = [each.sample for each in scene.plaus.endings]
    assert session.poses(scene, 2) and session.of(scene).endings[2].picture is not None
    from plaus_blender import ghosts

    assert ghosts.poses(scene), "what is listed can be looked at"
    operator.modal(window, escape)
    while operator.modal(window, tick) == {"PASS_THROUGH"}:
        time.sleep(0.02)
    after = [each.sample for each in scene.plaus.endings]
    best = operator._job.run.most_different(500)
    assert after == [str(each.sample) for each in best] and set(listed) <= set(after)
    assert after[scene.plaus.ending] == listed[2], "the chosen one stays chosen"


def test_esc_while_the_scene_is_read_stops_before_it_begins(scene):
    ready(cube())
    scene.frame_set(10)
    window, operator = Window(scene), Operator()
    operator.invoke(window, None)
    escape = SimpleNamespace(type="ESC", value="PRESS")
    assert operator.modal(window, escape) == {"CANCELLED"} and scene.plaus.status == "Stopped before it began"
    assert scene.frame_current == 10 and window.timers == 0 and not running._Sampling.running


@pytest.mark.parametrize("how", ["deleted", "renamed"])
def test_what_happens_to_an_object_while_the_scene_is_read(scene, how):
    ready(cube("First", place=(-2, 0, 2)))
    cube("Second", place=(2, 0, 2))
    scene.plaus.wanted = 1
    window, operator = Window(scene), Operator()
    tick = SimpleNamespace(type="TIMER", value="NOTHING")
    operator.invoke(window, None)
    next(operator._steps)
    if how == "deleted":
        bpy.data.objects.remove(bpy.data.objects["Second"])
        assert operator.modal(window, tick) == {"CANCELLED"}
        assert "The scene changed while it was read" in scene.plaus.status
    else:
        bpy.data.objects["Second"].name = "Another"
        while operator.modal(window, tick) <= {"PASS_THROUGH", "RUNNING_MODAL"}:
            time.sleep(0.02)
        assert len(scene.plaus.endings) == 1, scene.plaus.status
        assert bpy.data.objects["Another"] in session.objects_of(scene).values()
    assert window.timers == 0 and not running._Sampling.running


def test_the_scene_is_checked_while_blender_goes_on(scene):
    each = cube()
    window, operator = Window(scene), Operator()
    operator.jobs = running.PLAUS_OT_check.jobs.__get__(operator)
    operator.finish = running.PLAUS_OT_check.finish.__get__(operator)
    operator.only_read = True
    tick = SimpleNamespace(type="TIMER", value="NOTHING")
    for words in ("Nothing must happen yet", "Ready to sample"):
        assert operator.invoke(window, None) == {"RUNNING_MODAL"}
        while operator.modal(window, tick) <= {"PASS_THROUGH", "RUNNING_MODAL"}:
            time.sleep(0.02)
        assert words in scene.plaus.status
        ready(each)
    assert not len(scene.plaus.endings) and window.timers == 0


def test_a_job_stops_with_blender(tmp_path):
    script = """
import os, sys, time
sys.path[:0] = sys.argv[1:3]
import atexit, bpy, make, plaus_blender
plaus_blender.register()
# As Blender does when it is closed.
atexit.register(plaus_blender.unregister)
from plaus_blender import sampling, session
make.cans()
bpy.context.scene.plaus.wanted, bpy.context.scene.plaus.longest = 500, 3600.0
path = os.path.abspath("before.blend")
bpy.ops.wm.save_as_mainfile(filepath=path)
saved = open(path, "rb").read()
job = sampling.Job(session.prepare(bpy.context), os.path.join(os.getcwd(), "runs"))
job.start()
while not job.found:
    time.sleep(0.02)
assert job.is_alive and open(path, "rb").read() == saved
print("closing", flush=True)
"""
    folders = [os.path.dirname(os.path.dirname(os.path.abspath(running.__file__)))]
    folders.append(os.path.join(folders[0], "examples"))
    # In a session of its own: whatever it leaves behind can be seen.
    words = [sys.executable, "-c", script, *folders]
    made = subprocess.Popen(words, cwd=tmp_path, stdout=subprocess.PIPE, text=True, start_new_session=True)
    shown, _ = made.communicate(timeout=200)
    assert "closing" in shown
    with pytest.raises(ProcessLookupError):
        os.killpg(made.pid, 0)


def test_undo_takes_a_bake_back(scene):
    ready(cube())
    scene.plaus.wanted = 1
    bpy.ops.plaus.sample()
    bpy.ops.ed.undo_push(message="before")
    bpy.ops.plaus.bake()
    bpy.ops.ed.undo_push(message="Bake")
    assert bpy.data.objects["Cube"].animation_data.action
    assert bpy.ops.ed.undo() == {"FINISHED"}
    each, scene = bpy.data.objects["Cube"], bpy.context.scene
    assert each.animation_data is None and not each.plaus.started and scene.rigidbody_world.enabled
    assert len(scene.plaus.endings) == 1 and session.of(scene) is not None, "endings are still at hand"
    assert bpy.ops.plaus.bake() == {"FINISHED"}


def test_what_a_body_had_before_it_was_baked_comes_back(scene):
    each = cube()
    for frame, x in ((1, 0.0), (20, 3.0)):
        each.location.x = x
        each.keyframe_insert("location", frame=frame)
    own, slot = each.animation_data.action, getattr(each.animation_data, "action_slot", None)
    track = each.animation_data.nla_tracks.new()
    track.name = "Mine"
    scene.frame_set(1)
    ready(each)
    scene.plaus.wanted = 1
    bpy.ops.plaus.sample()
    sampled = asked.fingerprint(scene)
    for tracks in (True, False):
        bpy.ops.plaus.bake(tracks=tracks)
        assert each.animation_data.action != own and asked.fingerprint(scene) == sampled
    first, second = each.animation_data.nla_tracks
    assert first.name == "Mine" and second.name.startswith("Plaus ending 1")
    bpy.ops.ed.undo_push(message="Bake")
    bpy.ops.plaus.restore()
    bpy.ops.ed.undo_push(message="Clear Bake")

    def as_before(each):
        data = each.animation_data
        assert data.action.name == own_name and [one.name for one in data.nla_tracks] == ["Mine"]
        assert slot is None or data.action_slot.identifier == slot_name
        assert each.rotation_mode == "XYZ" and not each.plaus.started and each.plaus.action is None

    own_name, slot_name = own.name, slot and slot.identifier
    as_before(each)
    scene.frame_set(20)
    assert each.location.x == pytest.approx(3.0) and asked.fingerprint(scene) == sampled
    bpy.ops.ed.undo()
    each = bpy.data.objects["Cube"]
    assert "ending 1" in each.animation_data.action.name and each.plaus.action.name == own_name
    bpy.ops.ed.redo()
    as_before(bpy.data.objects["Cube"])
