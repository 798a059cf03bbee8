"""The panel's drawing, onto a layout that checks every name: Blender's module has no windows."""

import bpy
import pytest
from conftest import cube, ready
from layout import drawn

import make
from plaus_blender import levels, session, settings, wishes


def test_it_draws_at_every_stage(scene, monkeypatch):
    assert "None yet: press Sample" in drawn().texts
    each = cube()
    ready(each)
    for kind in wishes.KINDS:
        make.wish(kind, each, bpy.data.objects["Floor"])
    for scene.plaus.wish in range(len(scene.plaus.wishes)):
        drawn()
    for level in levels.LEVELS:
        for what in settings.VARIES:
            setattr(each.plaus, what, level)
        drawn()
    assert any("Cube ends at Spot" in text for text in drawn().texts)
    with pytest.raises(RuntimeError):
        bpy.ops.plaus.sample()
    assert any("choose" in text or "must be" in text for text in drawn().texts)
    scene.plaus.wishes.clear()
    ready(each)
    bpy.ops.plaus.sample()
    assert "plaus.bake" in drawn().operators and "plaus.rebuild" not in drawn().operators
    # Without a window, Blender has no icons.
    with monkeypatch.context() as windowed:
        windowed.setattr(session, "icon", lambda _, number: number + 1)
        assert drawn().pictures == len(scene.plaus.endings) > 1
    assert all(each.picture.shape == (128, 128, 4) for each in session.of(scene).endings)
    assert "plaus.refresh" not in drawn().operators
    each.rigid_body.mass += 1.0
    assert "plaus.refresh" in drawn().operators and any("has changed" in text for text in drawn().texts)
    session.forget()
    assert "plaus.rebuild" in drawn().operators
    monkeypatch.setattr(session.importlib.util, "find_spec", lambda _: None)
    without = drawn()
    assert "plaus.sample" not in without.operators and any("no simulator" in text for text in without.texts)


def test_an_empty_is_as_large_as_what_is_near_to_it(scene):
    each = cube()
    make.select(each)
    bpy.ops.plaus.wish_add(kind="ENDS_AT")
    [wish] = scene.plaus.wishes
    assert wish.within == wish.other.empty_display_size == 0.5
    wish.other.scale = (2.0, 2.0, 2.0)
    wish.within = 3.0
    assert wish.other.empty_display_size == 1.5
    wish.kind, wish.other = "ENDS_INSIDE", make.target("Box", (0, 0, 0), 1.0)
    wish.within = 2.0
    assert wish.other.empty_display_size == 1.0, "there it is its own size that counts"
