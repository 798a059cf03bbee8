"""Buttons that sample: in the background, while Blender is used."""

import time

import bpy

from . import reading, session, settings
from .refusals import told, told_of
from .sampling import Job, Refused, like

# Seconds between two looks at a run, and longest time for which a scene is read at once, beyond one object.
TICK, READ = 0.1, 0.02


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

    @told
    def execute(self, context):
        """Samples to the end: for scripts."""
        self._job = session.drained(self.jobs(context))
        self._job.start(self._job.request.iterations if self.again else None)
        self._job.wait()
        self.finish(context)

    @told_of
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

    @told_of
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


def job_of(context, request, samples=None):
    """What is asked for in an earlier request, or these samples of it. The pictures are of the scene as it is now."""
    world, _ = yield from reading.reading(context)
    return Job(request, session.place(context.scene), samples, session.painter(context.scene, world).paint)


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
        return (yield from job_of(context, request, [each.sample for each in context.scene.plaus.endings]))

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
        at_hand, number = session.chosen(context.scene)
        request = like(at_hand.request, at_hand.endings[number])
        request.wanted, request.longest = context.scene.plaus.wanted, context.scene.plaus.longest
        return (yield from job_of(context, request))


CLASSES = (PLAUS_OT_check, PLAUS_OT_sample, PLAUS_OT_refresh, PLAUS_OT_rebuild, PLAUS_OT_like)

register, unregister = bpy.utils.register_classes_factory(CLASSES)
