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
        self.texts, self.buttons, self.pictures = [], [], 0
        self.column = self.row = lambda **_: self

    def label(self, text="", icon="NONE"):
        """A text."""
        assert icon in bpy.types.UILayout.bl_rna.functions["label"].parameters["icon"].enum_items
        self.texts.append(text)

    def prop(self, data, name, **_):
        """A property."""
        assert name in data.bl_rna.properties, name

    def prop_search(self, data, name, where, items, **_):
        """A property that names one of some items."""
        self.prop(data, name)
        self.prop(where, items)

    def template_icon(self, icon_value, **_):
        """A picture."""
        assert icon_value > 0
        self.pictures += 1

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
        for number, item in enumerate(getattr(data, items)):
            getattr(panel, kind).draw_item(None, bpy.context, self, data, item, 0, active, index, number)


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
    # Without a window, Blender has no icons.
    with monkeypatch.context() as windowed:
        windowed.setattr(session, "icon", lambda _, number: number + 1)
        assert drawn().pictures == len(scene.plaus.endings) > 1
    assert all(each.picture.shape == (128, 128, 4) for each in session.of(scene).endings)
    assert "plaus.refresh" not in drawn().buttons
    each.rigid_body.mass += 1.0
    assert "plaus.refresh" in drawn().buttons and any("has changed" in text for text in drawn().texts)
    session.forget()
    assert "plaus.rebuild" in drawn().buttons
    monkeypatch.setattr(session.importlib.util, "find_spec", lambda _: None)
    without = drawn()
    assert "plaus.sample" not in without.buttons and any("no simulator" in text for text in without.texts)
