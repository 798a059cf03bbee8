"""The panel's drawing, onto a layout that checks every name: Blender's module has no windows."""

from types import SimpleNamespace

import bpy
import pytest
from conftest import cube, ready

import make
from plaus_blender import levels, panel, session, settings, wishes


class Layout:
    """Notes texts and buttons; unknown properties and operators are errors."""

    def __init__(self):
        self.texts, self.buttons = [], []
        self.column = self.row = lambda **_: self

    def label(self, text="", icon="NONE"):
        """A text."""
        assert icon in bpy.types.UILayout.bl_rna.functions["label"].parameters["icon"].enum_items
        self.texts.append(text)

    def prop(self, data, name, **_):
        """A property."""
        assert name in data.bl_rna.properties, name

    def operator(self, name, **_):
        """A button."""
        group, _, own = name.partition(".")
        assert getattr(getattr(bpy.ops, group), own).get_rna_type()
        self.buttons.append(name)
        return SimpleNamespace()

    def operator_menu_enum(self, name, prop, **_):
        """A menu."""
        self.operator(name)
        group, _, own = name.partition(".")
        assert prop in getattr(getattr(bpy.ops, group), own).get_rna_type().properties

    def template_list(self, kind, _name, data, items, active, index, **_):
        """A list, with each of its rows."""
        assert hasattr(bpy.types, kind) and isinstance(getattr(active, index), int)
        for item in getattr(data, items):
            getattr(panel, kind).draw_item(None, None, self, data, item, 0, active, index)


def drawn():
    """The whole panel."""
    layout = Layout()
    for part in panel.CLASSES:
        if issubclass(part, bpy.types.Panel):
            part.draw(SimpleNamespace(layout=layout), bpy.context)
    return layout


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
    assert "plaus.bake" in drawn().buttons and "plaus.rebuild" not in drawn().buttons
    session.forget()
    assert "plaus.rebuild" in drawn().buttons
    monkeypatch.setattr(session.importlib.util, "find_spec", lambda _: None)
    without = drawn()
    assert "plaus.sample" not in without.buttons and any("no simulator" in text for text in without.texts)
