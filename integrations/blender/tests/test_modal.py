"""Sampling in the background, with a window's part played by a stand-in: Blender's module has no windows."""

import time
from contextlib import nullcontext
from types import SimpleNamespace

import bpy
import pytest
from conftest import cube, ready

from plaus_blender import operators, session


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


for _name in ("begin", "finish", "invoke", "modal", "cancel"):
    setattr(Operator, _name, getattr(operators._Sampling, _name))
Operator.request, Operator.again = operators.PLAUS_OT_sample.request, False


@pytest.mark.parametrize("stopped", [False, True], ids=["to its end", "by Esc"])
def test_it_samples_while_blender_goes_on(scene, stopped):
    ready(cube())
    scene.plaus.wanted = 500 if stopped else 2
    window, operator = Window(scene), Operator()
    tick, escape = SimpleNamespace(type="TIMER", value="NOTHING"), SimpleNamespace(type="ESC", value="PRESS")
    begun = time.perf_counter()
    assert operator.invoke(window, None) == {"RUNNING_MODAL"}
    assert Operator().invoke(window, None) == {"CANCELLED"} and "already" in scene.plaus.status
    assert operator.modal(window, SimpleNamespace(type="MOUSEMOVE", value="NOTHING")) == {"PASS_THROUGH"}
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
    assert window.timers == 0 and not operators._Sampling.running


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
