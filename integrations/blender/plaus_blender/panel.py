"""The panel: in the sidebar of the 3D viewport, on the tab Plaus."""

import bpy

from . import asked, instances, levels, reading, session, settings, wishes

# Columns of text in the panel, as wide as it is at first.
WIDE = 42


def _lines(layout, text, icon="NONE"):
    """A text over as many lines as it needs."""
    column = layout.column(align=True)
    for paragraph in text.split("\n"):
        line = ""
        for word in paragraph.split():
            if line and len(line) + len(word) >= WIDE:
                column.label(text=line, icon=icon)
                line, icon = "", "BLANK1" if icon != "NONE" else "NONE"
            line = f"{line} {word}".strip()
        column.label(text=line, icon=icon)
        icon = "BLANK1" if icon != "NONE" else "NONE"


class PLAUS_UL_wishes(bpy.types.UIList):
    """What must happen."""

    def draw_item(self, _context, layout, _data, item, _icon, _active, _name, _index=0):
        """One wish as a sentence."""
        layout.label(text=asked.words(item), icon="CHECKMARK" if item.thing else "ERROR")


class PLAUS_UL_endings(bpy.types.UIList):
    """Endings, the most different first."""

    def draw_item(self, context, layout, _data, item, _icon, _active, _name, index=0):
        """One ending, with its picture."""
        row = layout.row(align=True)
        picture = session.icon(context.scene, index)
        if picture:
            row.template_icon(icon_value=picture, scale=3.0)
        if item.sample == context.scene.plaus.compared:
            row.label(text="", icon="SEQUENCE_COLOR_04")
        row.label(text=item.name, icon="KEYFRAME_HLT" if item.baked else "NONE")


class PLAUS_UL_findings(bpy.types.UIList):
    """What is told about the scene."""

    def draw_item(self, _context, layout, _data, item, _icon, _active, _name, _index=0):
        """One object with what is told about it."""
        text = f"{item.thing} {item.words}" if item.thing else item.words
        layout.label(text=text, icon="ERROR" if item.stops else "INFO")


class _Panel:
    bl_space_type = "VIEW_3D"
    bl_region_type = "UI"
    bl_category = "Plaus"


class PLAUS_PT_vary(_Panel, bpy.types.Panel):
    """What may vary of the active object."""

    bl_label = "What May Vary"

    def draw(self, context):
        """The levels of the active object, with the numbers behind them."""
        layout = self.layout
        row = layout.row(align=True)
        row.operator("plaus.vary", icon="MOD_NOISE").level = levels.SOME
        row.operator_menu_enum("plaus.vary", "level", text="", icon="DOWNARROW_HLT")
        each = context.active_object
        if each is None or not instances.is_active(each):
            _lines(layout, "Choose a rigid body of the type Active")
            return
        size = max(each.dimensions) * reading.unit_mm(context.scene) / 1000.0
        gravity = abs(context.scene.gravity[2]) * reading.unit_mm(context.scene) / 1000.0
        column = layout.column(align=True)
        for what, (name, unit, _) in settings.VARIES.items():
            row = column.row(align=True)
            row.prop(each.plaus, what, text=name)
            level = getattr(each.plaus, what)
            if level == levels.OWN:
                row.prop(each.plaus, f"{what}_own", text="")
            elif level != levels.NONE:
                row.label(text=_shown(what, levels.amount(what, level, 0.0, size, gravity)))
        layout.prop(each.plaus, "thrown")
        layout.prop(each.plaus, "turning")


def _shown(what, number):
    """A number with its unit."""
    if what == "rotation" and number >= 180:
        return "any"
    unit = {"position": "m", "rotation": "°", "velocity": "m/s", "spin": "°/s", "release": "s"}.get(what)
    return f"± {number:.3g} {unit}" if unit else f"± {100 * number:.0f} %"


class PLAUS_PT_wishes(_Panel, bpy.types.Panel):
    """What must happen."""

    bl_label = "What Must Happen"

    def draw(self, context):
        """The list, and what belongs to the chosen wish."""
        layout, kept = self.layout, context.scene.plaus
        layout.operator_menu_enum("plaus.wish_add", "kind", text="Add for Selected", icon="ADD")
        row = layout.row()
        row.template_list("PLAUS_UL_wishes", "", kept, "wishes", kept, "wish", rows=4)
        row.operator("plaus.wish_remove", text="", icon="REMOVE")
        if not 0 <= kept.wish < len(kept.wishes):
            return
        wish = kept.wishes[kept.wish]
        needs = wishes.KINDS[wish.kind][2]
        column = layout.column(align=True)
        column.prop(wish, "kind")
        column.prop(wish, "thing")
        if "other" in needs or "other?" in needs:
            column.prop(wish, "other")
        if "within" in needs:
            column.prop(wish, "within")
        if "axis" in needs:
            column.prop(wish, "axis")
        if "frame" in needs:
            column.prop_search(wish, "marker", context.scene, "timeline_markers", icon="MARKER_HLT")
            if not wish.marker:
                column.prop(wish, "frame")
            if wish.kind == "HITS":
                column.prop(wish, "frames")


class PLAUS_PT_sample(_Panel, bpy.types.Panel):
    """How many endings, and what is told about the scene."""

    bl_label = "Sample"

    def draw(self, context):
        """The button, and what came of it."""
        layout, kept = self.layout, context.scene.plaus
        lack = session.missing()
        if lack:
            _lines(layout, lack, "ERROR")
            return
        row = layout.row(align=True)
        row.prop(kept, "wanted")
        row.prop(kept, "longest")
        layout.prop(kept, "seed")
        layout.operator("plaus.sample", icon="PLAY")
        if kept.status:
            _lines(layout, kept.status, "INFO")
        row = layout.row()
        row.operator("plaus.check")
        row.prop(kept, "ground")
        layout.prop(kept, "tolerance")
        if kept.falls:
            layout.operator("plaus.floor", icon="MESH_PLANE")
        if len(kept.findings):
            layout.template_list("PLAUS_UL_findings", "", kept, "findings", kept, "finding", rows=3)
            if 0 <= kept.finding < len(kept.findings):
                chosen = kept.findings[kept.finding]
                _lines(layout, f"{chosen.thing} {chosen.words}".strip())


class PLAUS_PT_endings(_Panel, bpy.types.Panel):
    """Endings to choose from."""

    bl_label = "Endings"

    def draw(self, context):
        """The list, ghosts, and Bake."""
        layout, kept = self.layout, context.scene.plaus
        if not len(kept.endings):
            _lines(layout, "None yet: press Sample")
            return
        layout.template_list("PLAUS_UL_endings", "", kept, "endings", kept, "ending", rows=4)
        at_hand = session.of(context.scene)
        if at_hand is None:
            layout.operator("plaus.rebuild", icon="FILE_REFRESH")
        else:
            row = layout.row(align=True)
            row.operator("plaus.step", text="Previous", icon="TRIA_LEFT").by = -1
            row.operator("plaus.step", text="Next", icon="TRIA_RIGHT").by = 1
            row.operator("plaus.compare", text="Stop Comparing" if kept.compared else "Compare")
            row = layout.row(align=True)
            row.operator("plaus.like", icon="ADD")
            if at_hand.before is not None:
                row.operator("plaus.back", icon="LOOP_BACK")
            row = layout.row()
            row.prop(kept, "ghosts")
            row.prop(kept, "all_ends")
            if kept.fingerprint and kept.fingerprint != asked.fingerprint(context.scene):
                _lines(layout, "The scene has changed since these were made", "ERROR")
                layout.operator("plaus.refresh", icon="FILE_REFRESH")
            row = layout.row(align=True)
            row.operator("plaus.bake", icon="KEYFRAME").tracks = False
            row.operator("plaus.bake", text="As NLA Track", icon="NLA").tracks = True
            layout.operator("plaus.bake_all", icon="NLA_PUSHDOWN")
        layout.operator("plaus.restore", icon="LOOP_BACK")


CLASSES = (
    PLAUS_UL_wishes, PLAUS_UL_endings, PLAUS_UL_findings, PLAUS_PT_vary, PLAUS_PT_wishes, PLAUS_PT_sample,
    PLAUS_PT_endings,
)

register, unregister = bpy.utils.register_classes_factory(CLASSES)
