"""What the buttons do that act at once."""

import bpy
from bpy.props import BoolProperty, EnumProperty, IntProperty

from . import baking, instances, levels, meshes, reading, session, settings, wishes
from .refusals import told
from .sampling import Refused


def _moving_selected(context):
    """The selected rigid bodies that move. Raises `Refused` if there are none."""
    found = [each for each in context.selected_objects if instances.is_active(each)]
    if not found:
        raise Refused("Select rigid bodies of the type Active")
    return found


class PLAUS_OT_vary(bpy.types.Operator):
    """Let the selected rigid bodies vary: at first where they start, and how they are turned and thrown"""

    bl_idname = "plaus.vary"
    bl_label = "Vary Selected"
    bl_options = {"REGISTER", "UNDO"}

    level: EnumProperty(name="How much", items=settings.LEVELS[:-1], default=levels.SOME)

    @told
    def execute(self, context):
        """Sets the levels of each."""
        found = _moving_selected(context)
        for each in found:
            for what in settings.VARIES:
                if getattr(self, what):
                    setattr(each.plaus, what, self.level)
        context.scene.plaus.status = f"{len(found)} objects may vary"


for _what, (_name, _, _) in settings.VARIES.items():
    # Those that animators change first.
    _first = _what in ("position", "rotation", "velocity", "spin")
    PLAUS_OT_vary.__annotations__[_what] = BoolProperty(name=_name, default=_first)


class PLAUS_OT_wish_add(bpy.types.Operator):
    """Ask for something of each selected rigid body"""

    bl_idname = "plaus.wish_add"
    bl_label = "Must Happen"
    bl_options = {"REGISTER", "UNDO"}

    kind: EnumProperty(name="What", items=[(key, name, about) for key, (name, about, _) in wishes.KINDS.items()])

    @told
    def execute(self, context):
        """Adds a wish for each; an active object that is no moving body is the other object of all."""
        active = context.active_object if context.active_object in context.selected_objects else None
        moving = _moving_selected(context)
        needs = wishes.KINDS[self.kind][2]
        other = active if active not in moving else None
        if any(need.startswith("other") for need in needs) and other is None and len(moving) > 1 and active:
            other = active
            moving.remove(active)
        scene = context.scene
        for each in moving:
            wish = scene.plaus.wishes.add()
            wish.kind, wish.thing = self.kind, each
            wish.name = each.name
            wish.within = 0.5 * max(each.dimensions)
            wish.frame = scene.frame_current
            if "other" in needs or "other?" in needs:
                wish.other = other
            if self.kind in ("ENDS_AT", "PASSES") and other is None:
                wish.other = _target(scene, each, wish.within)
        scene.plaus.wish = len(scene.plaus.wishes) - 1


def _target(scene, each, within):
    """A new empty at an object, to be dragged to where it should go."""
    empty = bpy.data.objects.new(f"{each.name} target", None)
    empty.empty_display_type, empty.empty_display_size = "SPHERE", within
    empty.location = each.matrix_world.translation
    scene.collection.objects.link(empty)
    return empty


class PLAUS_OT_wish_remove(bpy.types.Operator):
    """Do not ask for this any more"""

    bl_idname = "plaus.wish_remove"
    bl_label = "Remove"
    bl_options = {"REGISTER", "UNDO"}

    def execute(self, context):
        """Removes the chosen one."""
        kept = context.scene.plaus
        kept.wishes.remove(kept.wish)
        kept.wish = min(kept.wish, len(kept.wishes) - 1)
        return {"FINISHED"}


class PLAUS_OT_floor(bpy.types.Operator):
    """Add a level floor under everything that moves, as a passive rigid body"""

    bl_idname = "plaus.floor"
    bl_label = "Add Floor"
    bl_options = {"REGISTER", "UNDO"}

    @told
    def execute(self, context):
        """Adds it."""
        with reading.first_frame(context.scene):
            moving = [each for each in reading.bodies(context.scene) if instances.is_active(each)]
            if not moving:
                raise Refused(reading.NOTHING_MOVES)
            low, high = meshes.bounds(moving)
        side = 10 * float(max(high - low))
        mesh = bpy.data.meshes.new("Floor")
        corners = [(x * side, y * side, 0.0) for x, y in ((-1, -1), (1, -1), (1, 1), (-1, 1))]
        mesh.from_pydata(corners, [], [(0, 1, 2, 3)])
        floor = bpy.data.objects.new("Floor", mesh)
        floor.location = (*(low + high)[:2] / 2, low[2])
        context.scene.collection.objects.link(floor)
        with context.temp_override(object=floor, active_object=floor, selected_objects=[floor]):
            bpy.ops.rigidbody.object_add(type="PASSIVE")
        floor.rigid_body.collision_shape = "MESH"
        context.scene.plaus.falls = False
        context.scene.plaus.status = "A floor lies under everything that moves"


class PLAUS_OT_back(bpy.types.Operator):
    """List the endings again that were listed before the last sampling"""

    bl_idname = "plaus.back"
    bl_label = "Endings Before"
    bl_options = {"REGISTER"}

    @told
    def execute(self, context):
        """Lists them."""
        session.back(context.scene)


class PLAUS_OT_compare(bpy.types.Operator):
    """Keep showing this ending, in green, beside the one that is chosen next; again: no more"""

    bl_idname = "plaus.compare"
    bl_label = "Compare"
    bl_options = {"INTERNAL"}

    def execute(self, context):
        """Marks the chosen one, or takes the mark away."""
        kept = context.scene.plaus
        if 0 <= kept.ending < len(kept.endings):
            sample = kept.endings[kept.ending].sample
            kept.compared = "" if kept.compared else sample
        settings._redraw(None, context)
        return {"FINISHED"}


class PLAUS_OT_step(bpy.types.Operator):
    """Show another ending"""

    bl_idname = "plaus.step"
    bl_label = "Next Ending"
    bl_options = {"INTERNAL"}

    by: IntProperty(default=1)

    def execute(self, context):
        """Shows the next one, or the one before."""
        kept = context.scene.plaus
        if len(kept.endings):
            kept.ending = (kept.ending + self.by) % len(kept.endings)
        return {"FINISHED"}


class PLAUS_OT_bake(bpy.types.Operator):
    """Write the chosen ending as keyframes"""

    bl_idname = "plaus.bake"
    bl_label = "Bake"
    bl_options = {"REGISTER", "UNDO"}

    tracks: BoolProperty(name="As NLA tracks", description="In a track of its own, so that several can be kept")

    @told
    def execute(self, context):
        """Bakes it."""
        scene, kept = context.scene, context.scene.plaus
        at_hand, number = session.chosen(scene)
        objects = session.objects_of(scene)
        gone = len(at_hand.request.frames) - len(objects)
        ending, label = at_hand.endings[number], f"ending {number + 1} ({kept.endings[number].sample})"
        count = baking.bake(scene, at_hand.request, objects, ending, label, self.tracks)
        for place, each in enumerate(kept.endings):
            each.baked = place == number or (self.tracks and each.baked)
        kept.ghosts = False
        scene.frame_set(scene.frame_current)
        kept.status = f"Baked {label}: {count} objects" + (f"; {gone} were deleted since" if gone else "")
        if gone:
            self.report({"WARNING"}, kept.status)


class PLAUS_OT_bake_all(bpy.types.Operator):
    """Write all endings as NLA tracks; the chosen one plays"""

    bl_idname = "plaus.bake_all"
    bl_label = "All as NLA Tracks"
    bl_options = {"REGISTER", "UNDO"}

    def execute(self, context):
        """Bakes each, the chosen one last."""
        kept = context.scene.plaus
        chosen = kept.ending
        for kept.ending in [*(number for number in range(len(kept.endings)) if number != chosen), chosen]:
            if bpy.ops.plaus.bake(tracks=True) != {"FINISHED"}:
                return {"CANCELLED"}
        kept.status = f"Baked {len(kept.endings)} endings as NLA tracks"
        return {"FINISHED"}


class PLAUS_OT_restore(bpy.types.Operator):
    """Take baked keyframes away and put everything back where it was"""

    bl_idname = "plaus.restore"
    bl_label = "Clear Bake"
    bl_options = {"REGISTER", "UNDO"}

    def execute(self, context):
        """Restores the scene."""
        count = baking.restore(context.scene)
        for each in context.scene.plaus.endings:
            each.baked = False
        context.scene.plaus.status = f"{count} objects are back where they were"
        context.scene.frame_set(context.scene.frame_current)
        return {"FINISHED"}


CLASSES = (
    PLAUS_OT_vary, PLAUS_OT_wish_add, PLAUS_OT_wish_remove, PLAUS_OT_floor, PLAUS_OT_back, PLAUS_OT_compare,
    PLAUS_OT_step, PLAUS_OT_bake, PLAUS_OT_bake_all, PLAUS_OT_restore,
)

register, unregister = bpy.utils.register_classes_factory(CLASSES)
