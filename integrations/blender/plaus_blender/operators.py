"""What the buttons do."""

import functools
import time

import bpy
from bpy.props import BoolProperty, EnumProperty, IntProperty

from . import baking, instances, levels, meshes, reading, session, settings, wishes
from .sampling import Job, Refused, like

# Seconds between two looks at a run, and longest time for which a scene is read at once, beyond one object.
TICK, READ = 0.1, 0.02


def _refuse(operator, context, error):
    """Says in the panel, and where Blender shows reports, why something was not done."""
    context.scene.plaus.status = str(error)
    operator.report({"ERROR"}, str(error))
    return {"CANCELLED"}


def _tried(operator, context, action, *given):
    """What an action comes to, or why it was refused, said."""
    try:
        return action(operator, context, *given) or {"FINISHED"}
    except Refused as error:
        return _refuse(operator, context, error)


def _told(action):
    """An `execute` that says why it refuses what it refuses."""

    @functools.wraps(action)
    def execute(self, context):
        return _tried(self, context, action)

    return execute


def _told_of(action):
    """The same for what is given an event. Blender looks at the number of arguments."""

    @functools.wraps(action)
    def heard(self, context, event):
        return _tried(self, context, action, event)

    return heard


def _moving_selected(context):
    """The selected rigid bodies that move. Raises `Refused` if there are none."""
    found = [each for each in context.selected_objects if instances.is_active(each)]
    if not found:
        raise Refused("Select rigid bodies of the type Active")
    return found


def _chosen(scene):
    """The endings at hand, and the number of the chosen one. Raises `Refused` if there is none."""
    at_hand, number = session.of(scene), scene.plaus.ending
    if at_hand is None or not 0 <= number < len(at_hand.endings):
        raise Refused("Choose an ending first; Bring Back Endings makes those of a saved file again")
    return at_hand, number


class PLAUS_OT_vary(bpy.types.Operator):
    """Let the selected rigid bodies vary: at first where they start, and how they are turned and thrown"""

    bl_idname = "plaus.vary"
    bl_label = "Vary Selected"
    bl_options = {"REGISTER", "UNDO"}

    level: EnumProperty(name="How much", items=settings.LEVELS[:-1], default=levels.SOME)

    @_told
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

    @_told
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

    @_told
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

    @_told
    def execute(self, context):
        """Samples to the end: for scripts."""
        self._job = session.drained(self.jobs(context))
        self._job.start(self._job.request.iterations if self.again else None)
        self._job.wait()
        self.finish(context)

    @_told_of
    def invoke(self, context, _event):
        """Samples in the background, while Blender can be used."""
        if _Sampling.running:
            raise Refused("It is sampling already: Esc stops it")
        _Sampling.running = True
        self._job, self._steps = None, self.jobs(context)
        # What is sampled belongs to this scene, whichever is shown when it ends.
        self._scene = context.scene.name
        self._timer = context.window_manager.event_timer_add(TICK, window=context.window)
        context.window_manager.progress_begin(0, 100)
        context.window_manager.modal_handler_add(self)
        context.workspace.status_text_set("Plaus: reading the scene. Esc stops")
        return {"RUNNING_MODAL"}

    @_told_of
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
        finally:
            settings._redraw(None, context)
        bpy.ops.ed.undo_push(message="Plaus endings")

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
            if isinstance(error, Refused):
                raise
            raise Refused("The scene changed while it was read: sample again") from error
        if escape:
            self.cancel(context)
            raise Refused("Stopped before it began")
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
    only_read = False

    def jobs(self, context):
        """Of the scene as it is."""
        asked = yield from session.asking(context)
        place = session.place(context.scene)
        return Job(asked.make, place, paint=asked.painter.paint, only_read=self.only_read)


class PLAUS_OT_check(_Fresh):
    """List what cannot be taken over from the scene, object by object"""

    bl_idname = "plaus.check"
    bl_label = "Check Scene"
    bl_options = {"REGISTER"}
    only_read = True

    def finish(self, context):
        """Says that nothing is wrong."""
        if self._job.failed:
            raise Refused(self._job.failed)
        context.scene.plaus.status = "Ready to sample"


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

    def finish(self, context):
        """Says if they may differ."""
        super().finish(context)
        if other := session.made_by_another(self._job.request):
            context.scene.plaus.status += f". They were made with Plaus {other}, and may not be the same"


class PLAUS_OT_like(_Sampling):
    """Look for more endings in which everything ends near where it does in the chosen one"""

    bl_idname = "plaus.like"
    bl_label = "More Like This"
    bl_options = {"REGISTER"}

    def jobs(self, context):
        """As sampled, but near the chosen one."""
        at_hand, number = _chosen(context.scene)
        request = like(at_hand.request, at_hand.endings[number])
        request.wanted, request.longest = context.scene.plaus.wanted, context.scene.plaus.longest
        world, _ = yield from reading.reading(context)
        return Job(request, session.place(context.scene), paint=session.painter(context.scene, world).paint)


class PLAUS_OT_back(bpy.types.Operator):
    """List the endings again that were listed before the last sampling"""

    bl_idname = "plaus.back"
    bl_label = "Endings Before"
    bl_options = {"REGISTER"}

    @_told
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

    @_told
    def execute(self, context):
        """Bakes it."""
        scene, kept = context.scene, context.scene.plaus
        at_hand, chosen = _chosen(scene)
        objects = session.objects_of(scene)
        gone = len(at_hand.request.frames) - len(objects)
        ending, label = at_hand.endings[chosen], f"ending {chosen + 1} ({kept.endings[chosen].sample})"
        count = baking.bake(scene, at_hand.request, objects, ending, label, self.tracks)
        for number, each in enumerate(kept.endings):
            each.baked = number == chosen or (self.tracks and each.baked)
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
    PLAUS_OT_vary, PLAUS_OT_wish_add, PLAUS_OT_wish_remove, PLAUS_OT_floor, PLAUS_OT_check, PLAUS_OT_sample,
    PLAUS_OT_refresh, PLAUS_OT_rebuild, PLAUS_OT_like, PLAUS_OT_back, PLAUS_OT_compare, PLAUS_OT_step, PLAUS_OT_bake,
    PLAUS_OT_bake_all, PLAUS_OT_restore,
)

register, unregister = bpy.utils.register_classes_factory(CLASSES)
