"""A stand-in for Blender's layouts, which its module has no window for: notes what is drawn, and presses buttons."""

from types import SimpleNamespace

import bpy


class Button(SimpleNamespace):
    """A button or a menu: its operator, its words, the menu's property, and what the panel sets of the operator."""

    def __init__(self, name, text, choice):
        super().__init__()
        self.__dict__["_of"] = (name, text, choice)


def rna(name):
    """Blender's description of an operator; an error if there is none."""
    group, _, own = name.partition(".")
    return getattr(getattr(bpy.ops, group), own).get_rna_type()


class Layout:
    """Notes texts and buttons; unknown properties and operators are errors."""

    def __init__(self):
        self.texts, self.buttons, self.pictures, self.pressed = [], {}, 0, []
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

    def operator(self, name, text=None, **_):
        """A button."""
        words = rna(name).name if text is None else text
        return self.buttons.setdefault(words or name, Button(name, words, ""))

    def operator_menu_enum(self, name, prop, text=None, **_):
        """A menu."""
        assert prop in rna(name).properties
        self.buttons[text or f"{name} {prop}"] = Button(name, text, prop)

    def template_list(self, kind, _name, data, items, active, index, **_):
        """A list, with each of its rows."""
        assert isinstance(getattr(active, index), int)
        for number, item in enumerate(getattr(data, items)):
            getattr(bpy.types, kind).draw_item(None, bpy.context, self, data, item, 0, active, index, number)

    @property
    def operators(self):
        """The names of the operators that have buttons."""
        return [each._of[0] for each in self.buttons.values()]


def drawn():
    """The whole tab, as it is now."""
    layout = Layout()
    for part in bpy.types.Panel.__subclasses__():
        if getattr(part, "bl_category", "") == "Plaus" and part.is_registered:
            part.draw(SimpleNamespace(layout=layout), bpy.context)
    return layout


def press(clicks, text, choice=""):
    """Presses a button on the tab, or chooses from a menu on it, and notes each click."""
    button = drawn().buttons[text]
    name, _, menu = button._of
    given = {key: value for key, value in vars(button).items() if key != "_of"}
    clicks.append(text)
    if menu:
        clicks.append(choice)
        given[menu] = next(each.identifier for each in rna(name).properties[menu].enum_items if each.name == choice)
    group, _, own = name.partition(".")
    made = getattr(getattr(bpy.ops, group), own)(**given)
    assert made == {"FINISHED"}, (text, bpy.context.scene.plaus.status)
