"""What the buttons do."""

import time

import bpy
from bpy.props import BoolProperty, EnumProperty, IntProperty

from . import baking, instances, levels, reading, session, settings, wishes
from .sampling import Job, Refused, like

# Seconds between two looks at a run, and longest time for which a scene is read at once, beyond one object.
TICK, READ = 0.1, 0.02


def _refuse(operator, context, error):
    """Says in the panel, and where Blender shows reports, why something was not done."""
    context.scene.plaus.status = str(error)
    operator.report({"ERROR"}, str(error))
    return {"CANCELLED"}


class PLAUS_OT_vary(bpy.types.Operator):
    """Let the selected rigid bodies vary: where they start, how they are turned and thrown"""

    bl_idname = "plaus.vary"
    bl_label = "Vary Selected"
    bl_options = {"REGISTER", "UNDO"}

    level: EnumProperty(name="How much", items=settings.LEVELS[:-1], default=levels.SOME)
    position: BoolProperty(name="Position", default=True)
    rotation: BoolProperty(name="Rotation", default=True)
    velocity: BoolProperty(name="Velocity", default=True)
    spin: BoolProperty(name="Spin", default=True)

    def execute(self, context):
        """Sets the levels of each."""
        found = [each for each in context.selected_objects if instances.is_active(each)]
        if not found:
            return _refuse(self, context, "Select rigid bodies of the type Active")
        for each in found:
            for what in ("position", "rotation", "velocity", "spin"):
                if getattr(self, what):
                    setattr(each.plaus, what, self.level)
        context.scene.plaus.status = f"{len(found)} objects may vary"
        return {"FINISHED"}


class PLAUS_OT_wish_add(bpy.types.Operator):
    """Ask for something of each selected rigid body"""

    bl_idname = "plaus.wish_add"
    bl_label = "Must Happen"
    bl_options = {"REGISTER", "UNDO"}

    kind: EnumProperty(name="What", items=[(key, name, about) for key, (name, about, _) in wishes.KINDS.items()])

    def execute(self, context):
        """Adds a wish for each; an active object that is no moving body is the other object of all."""
        active = context.active_object if context.active_object in context.selected_objects else None
        moving = [each for each in context.selected_objects if instances.is_active(each)]
        needs = wishes.KINDS[self.kind][2]
        other = active if active not in moving else None
        if any(need.startswith("other") for need in needs) and other is None and len(moving) > 1 and active:
            other = active
            moving.remove(active)
        if not moving:
            return _refuse(self, context, "Select rigid bodies of the type Active")
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
        return {"FINISHED"}


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


class PLAUS_OT_check(bpy.types.Operator):
    """List what cannot be taken over from the scene, object by object"""

    bl_idname = "plaus.check"
    bl_label = "Check Scene"
    bl_options = {"REGISTER"}

    def execute(self, context):
        """Reads the scene without sampling."""
        try:
            session.prepare(context)
        except Refused as error:
            return _refuse(self, context, error)
        context.scene.plaus.status = "Ready to sample"
        return {"FINISHED"}


class _Sampling(bpy.types.Operator):
    """Runs a job: in the background with a window, and to its end without one."""

    _job = None
    _timer = None
    _steps = None
    again = False

    def jobs(self, context):
        """Makes the job, a little at a time."""
        raise NotImplementedError
        yield

    def finish(self, context):
        """Takes over what was found."""
        kept = context.scene.plaus
        found = session.take(context.scene, self._job, self.again)
        early = "" if found >= kept.wanted else f" of {kept.wanted}"
        kept.status = f"{found}{early} endings in {self._job.run.seconds:.1f} s"

    def execute(self, context):
        """Samples to the end: for scripts."""
        try:
            self._job = session.drained(self.jobs(context))
            self._job.start(self._job.request.iterations if self.again else None)
            self._job.wait()
            self.finish(context)
        except Refused as error:
            return _refuse(self, context, error)
        return {"FINISHED"}

    def invoke(self, context, _event):
        """Samples in the background, while Blender can be used."""
        if _Sampling.running:
            return _refuse(self, context, "It is sampling already: Esc stops it")
        _Sampling.running = True
        self._job, self._steps = None, self.jobs(context)
        # What is sampled belongs to this scene, whichever is shown when it ends.
        self._scene = context.scene.name
        self._timer = context.window_manager.event_timer_add(TICK, window=context.window)
        context.window_manager.progress_begin(0, 100)
        context.window_manager.modal_handler_add(self)
        context.workspace.status_text_set("Plaus: reading the scene. Esc stops")
        return {"RUNNING_MODAL"}

    def modal(self, context, event):
        """Reads the scene, then shows endings as they come; Esc stops, and keeps what there is."""
        escape = event.type == "ESC" and event.value == "PRESS"
        if self._steps is not None:
            return self._read(context, escape, event.type == "TIMER")
        if escape:
            self._job.stop()
            return {"RUNNING_MODAL"}
        if event.type != "TIMER":
            return {"PASS_THROUGH"}
        scene = bpy.data.scenes.get(self._scene)
        if self._job.is_alive and scene is not None:
            wanted = scene.plaus.wanted
            context.window_manager.progress_update(100 * self._job.found // wanted)
            text = f"Plaus: {self._job.found} of {wanted} endings, {self._job.seconds:.0f} s. Esc stops and keeps them"
            context.workspace.status_text_set(text)
            listed = len(scene.plaus.endings)
            if session.show(scene, self._job) != listed:
                settings._redraw(None, context)
            return {"PASS_THROUGH"}
        self._job.stop()
        self.cancel(context)
        if scene is None:
            return {"CANCELLED"}
        self._job.wait()
        try:
            with context.temp_override(scene=scene):
                self.finish(context)
        except Refused as error:
            return _refuse(self, context, error)
        finally:
            settings._redraw(None, context)
        bpy.ops.ed.undo_push(message="Plaus endings")
        return {"FINISHED"}

    def _read(self, context, escape, ticked):
        """Reads a little more of the scene. Nothing else may be done meanwhile, which takes a moment."""
        until = time.perf_counter() + READ
        try:
            while not escape and ticked and time.perf_counter() < until:
                next(self._steps)
        except StopIteration as end:
            self._job, self._steps = end.value, None
            self._job.start(self._job.request.iterations if self.again else None)
        except (Refused, ReferenceError) as error:
            self.cancel(context)
            words = error if isinstance(error, Refused) else "The scene changed while it was read: sample again"
            return _refuse(self, context, words)
        if escape:
            self.cancel(context)
            return _refuse(self, context, "Stopped before it began")
        return {"RUNNING_MODAL"}

    def cancel(self, context):
        """Ends what was shown. Blender calls this too, when it closes."""
        if self._steps is not None:
            self._steps.close()
            self._steps = None
        if self._job is not None:
            self._job.stop()
        _Sampling.running = False
        context.window_manager.event_timer_remove(self._timer)
        context.window_manager.progress_end()
        context.workspace.status_text_set(None)


_Sampling.running = False


class _Fresh(_Sampling):
    def jobs(self, context):
        """Of the scene as it is."""
        asked = yield from session.asking(context)
        return Job(asked.make, session.place(context.scene), paint=asked.painter.paint)


class PLAUS_OT_sample(_Fresh):
    """Look for different ways in which everything under What Must Happen comes true"""

    bl_idname = "plaus.sample"
    bl_label = "Sample"
    bl_options = {"REGISTER"}


class PLAUS_OT_refresh(_Fresh):
    """Sample again, as the scene has changed, and choose the ending most like the one that was chosen"""

    bl_idname = "plaus.refresh"
    bl_label = "Refresh"
    bl_options = {"REGISTER"}

    def jobs(self, context):
        """Of the scene as it is now."""
        at_hand, number = session.of(context.scene), context.scene.plaus.ending
        self._chosen = at_hand.endings[number] if at_hand and 0 <= number < len(at_hand.endings) else None
        return (yield from super().jobs(context))

    def finish(self, context):
        """Chooses."""
        super().finish(context)
        if self._chosen is not None:
            context.scene.plaus.ending = session.nearest(context.scene, self._chosen)


class PLAUS_OT_rebuild(_Sampling):
    """Make the endings again that this file was saved with, from its scenario and seed"""

    bl_idname = "plaus.rebuild"
    bl_label = "Bring Back Endings"
    bl_options = {"REGISTER"}
    again = True

    def jobs(self, context):
        """As kept in the file."""
        if lack := session.missing():
            raise Refused(lack)
        request = session.kept_request(context.scene)
        request.longest = 10 * request.longest  # this machine may be slower
        # The pictures are of the scene as it is now.
        world, _ = yield from reading.reading(context)
        samples = [each.sample for each in context.scene.plaus.endings]
        paint = session.painter(context.scene, world).paint
        return Job(request, session.place(context.scene), samples, paint)


class PLAUS_OT_like(_Sampling):
    """Look for more endings in which everything ends near where it does in the chosen one"""

    bl_idname = "plaus.like"
    bl_label = "More Like This"
    bl_options = {"REGISTER"}

    def jobs(self, context):
        """As sampled, but near the chosen one."""
        at_hand, number = session.of(context.scene), context.scene.plaus.ending
        if at_hand is None or not 0 <= number < len(at_hand.endings):
            raise Refused("Choose an ending first")
        request = like(at_hand.request, at_hand.endings[number])
        request.wanted, request.longest = context.scene.plaus.wanted, context.scene.plaus.longest
        world, _ = yield from reading.reading(context)
        return Job(request, session.place(context.scene), paint=session.painter(context.scene, world).paint)


class PLAUS_OT_back(bpy.types.Operator):
    """List the endings again that were listed before the last sampling"""

    bl_idname = "plaus.back"
    bl_label = "Endings Before"
    bl_options = {"REGISTER"}

    def execute(self, context):
        """Lists them."""
        try:
            session.back(context.scene)
        except Refused as error:
            return _refuse(self, context, error)
        return {"FINISHED"}


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

    def execute(self, context):
        """Bakes it."""
        scene, kept = context.scene, context.scene.plaus
        at_hand = session.of(scene)
        if at_hand is None or not 0 <= kept.ending < len(at_hand.endings):
            words = "Choose an ending first; Bring Back Endings makes those of a saved file again"
            return _refuse(self, context, words)
        objects = session.objects_of(scene)
        gone = len(at_hand.request.frames) - len(objects)
        ending, label = at_hand.endings[kept.ending], f"ending {kept.ending + 1} ({kept.endings[kept.ending].sample})"
        count = baking.bake(scene, at_hand.request, objects, ending, label, self.tracks)
        for number, each in enumerate(kept.endings):
            each.baked = number == kept.ending or (self.tracks and each.baked)
        kept.ghosts = False
        scene.frame_set(scene.frame_current)
        kept.status = f"Baked {label}: {count} objects" + (f"; {gone} were deleted since" if gone else "")
        if gone:
            self.report({"WARNING"}, kept.status)
        return {"FINISHED"}


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
    PLAUS_OT_vary, PLAUS_OT_wish_add, PLAUS_OT_wish_remove, PLAUS_OT_check, PLAUS_OT_sample, PLAUS_OT_refresh,
    PLAUS_OT_rebuild, PLAUS_OT_like, PLAUS_OT_back, PLAUS_OT_compare, PLAUS_OT_step, PLAUS_OT_bake,
    PLAUS_OT_bake_all, PLAUS_OT_restore,
)

register, unregister = bpy.utils.register_classes_factory(CLASSES)
