"""What the user chooses, kept with the scene and its objects. Blender reads the annotations as properties."""

import bpy
from bpy.props import (
    BoolProperty,
    CollectionProperty,
    EnumProperty,
    FloatProperty,
    FloatVectorProperty,
    IntProperty,
    PointerProperty,
    StringProperty,
)

from . import levels, shapes, wishes

LEVELS = [
    (levels.NONE, "–", "It does not vary"),
    (levels.LITTLE, "A little", "See the number beside it"),
    (levels.SOME, "Some", "See the number beside it"),
    (levels.LOT, "A lot", "See the number beside it"),
    (levels.OWN, "Own", "A number of your own"),
]
# What may vary: how it is called, its unit for Blender, and what the number means.
VARIES = {
    "position": ("Position", "LENGTH", "Standard deviation; in height only where there is room below"),
    "rotation": ("Rotation", "NONE", "Standard deviation in degrees; 180 or more: any orientation. What stands on "
                 "something turns about the vertical only"),
    "velocity": ("Velocity", "VELOCITY", "Standard deviation of the velocity at the start"),
    "spin": ("Spin", "NONE", "Standard deviation of the rotation at the start in degrees per second"),
    "release": ("Time of release", "TIME_ABSOLUTE", "It appears at any time from 0 to this"),
    "mass": ("Mass", "NONE", "Relative spread: 0.1 is about 10 %"),
    "friction": ("Friction", "NONE", "Relative spread: 0.1 is about 10 %"),
    "bounce": ("Bounciness", "NONE", "How far up or down it may be"),
}
AXES = [(name, name.replace("minus_", "-").upper(), "") for name in ("x", "minus_x", "y", "minus_y", "z", "minus_z")]


def _redraw(_self, _context):
    for window in bpy.context.window_manager.windows:
        for area in window.screen.areas:
            if area.type == "VIEW_3D":
                area.tag_redraw()


def _resize(wish, _context):
    """An empty is as large as what is near to it."""
    if wish.kind in ("ENDS_AT", "PASSES") and wish.other and wish.other.type == "EMPTY":
        wish.other.empty_display_size = wish.within / max(1e-6, max(map(abs, wish.other.scale)))


class PlausObject(bpy.types.PropertyGroup):
    """What may vary of an object, and how it is thrown."""

    thrown: FloatVectorProperty(
        name="Thrown", description="Its velocity at the start, along the world's axes", subtype="VELOCITY", size=3
    )
    turning: FloatVectorProperty(
        name="Turning", description="How fast it turns at the start, about the world's axes, in degrees per second",
        size=3,
    )
    # What it was like before an ending was baked.
    started: BoolProperty(options={"HIDDEN"})
    mode: StringProperty(options={"HIDDEN"})
    animated: BoolProperty(options={"HIDDEN"})
    action: PointerProperty(type=bpy.types.Action, options={"HIDDEN"})
    slot: StringProperty(options={"HIDDEN"})
    start: FloatVectorProperty(size=16, options={"HIDDEN"})
    basis: FloatVectorProperty(size=16, options={"HIDDEN"})


for _what, (_name, _unit, _meaning) in VARIES.items():
    PlausObject.__annotations__[_what] = EnumProperty(name=_name, description=_meaning, items=LEVELS)
    PlausObject.__annotations__[f"{_what}_own"] = FloatProperty(
        name=_name, description=_meaning, min=0.0, unit=_unit, precision=3
    )


class PlausWish(bpy.types.PropertyGroup):
    """One thing that must happen."""

    kind: EnumProperty(name="What", items=[(key, name, about) for key, (name, about, _) in wishes.KINDS.items()])
    thing: PointerProperty(name="Object", type=bpy.types.Object)
    other: PointerProperty(name="Other", description="The other object, or an empty", type=bpy.types.Object)
    within: FloatProperty(
        name="Within", description="How near; the size of an empty shows it", min=0.0, default=0.1, unit="LENGTH",
        precision=4, update=_resize,
    )
    axis: EnumProperty(name="Side", description="Which of its own axes points up", items=AXES, default="z")
    frame: IntProperty(name="Frame", min=0, default=24)
    marker: StringProperty(
        name="Marker", description="A marker of the timeline whose frame counts, wherever it is moved, instead of the "
        "number"
    )
    frames: FloatProperty(
        name="Give or take", description="How many frames earlier or later will do", min=0.5, default=1.0
    )


class PlausFinding(bpy.types.PropertyGroup):
    """Something told about an object."""

    thing: StringProperty()
    words: StringProperty()
    stops: BoolProperty()


class PlausBody(bpy.types.PropertyGroup):
    """Which object a body of the scenario is, even if it is renamed."""

    thing: PointerProperty(type=bpy.types.Object)


class PlausEnding(bpy.types.PropertyGroup):
    """An ending in the list; `name` is what is shown."""

    sample: StringProperty()
    duration: FloatProperty()
    baked: BoolProperty()


class PlausScene(bpy.types.PropertyGroup):
    """What must happen, and what was found."""

    wishes: CollectionProperty(type=PlausWish)
    wish: IntProperty()
    wanted: IntProperty(name="Endings", description="How many endings to look for", min=1, max=500, default=8)
    longest: FloatProperty(
        name="At most", description="Stop after this time with what is found", min=1.0, default=60.0,
        unit="TIME_ABSOLUTE",
    )
    seed: IntProperty(name="Seed", description="Another seed finds other endings", min=0, default=1)
    tolerance: FloatProperty(
        name="Shapes within", description="How far the corners of a mesh may be from a ball, box, cylinder, cone or "
        "capsule to be taken for one, in % of its least extent", min=0.0, max=20.0, default=100 * shapes.TOLERANCE,
        subtype="PERCENTAGE",
    )
    ground: BoolProperty(
        name="Ground without edges", description="Take the level floor below everything, if it is three times as wide "
        "as all that moves, for endless: much faster", default=True,
    )
    ghosts: BoolProperty(name="Ghosts", description="Show endings in the viewport", default=True, update=_redraw)
    all_ends: BoolProperty(
        name="All ends", description="Show faintly where things end in all endings", default=True, update=_redraw
    )
    falls: BoolProperty(options={"HIDDEN"})
    findings: CollectionProperty(type=PlausFinding)
    finding: IntProperty()
    bodies: CollectionProperty(type=PlausBody)
    endings: CollectionProperty(type=PlausEnding)
    ending: IntProperty(name="Ending", description="The ending that is shown and baked", update=_redraw)
    compared: StringProperty(options={"HIDDEN"})
    fingerprint: StringProperty(options={"HIDDEN"})
    status: StringProperty()
    kept: StringProperty(options={"HIDDEN"})


CLASSES = (PlausObject, PlausWish, PlausFinding, PlausBody, PlausEnding, PlausScene)


_register, _unregister = bpy.utils.register_classes_factory(CLASSES)


def register():
    """Makes the properties known to Blender."""
    _register()
    bpy.types.Object.plaus = PointerProperty(type=PlausObject)
    bpy.types.Scene.plaus = PointerProperty(type=PlausScene)


def unregister():
    """Takes them back."""
    del bpy.types.Scene.plaus, bpy.types.Object.plaus
    _unregister()
