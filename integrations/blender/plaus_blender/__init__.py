"""Plaus in Blender: mark what may vary and what must happen, get endings to choose from, and bake one."""

import bpy

from . import ghosts, operators, panel, running, session, settings


@bpy.app.handlers.persistent
def _opened(*_arguments):
    """Endings at hand belong to the file that was open before."""
    session.forget()


def register():
    """Makes all of it known to Blender."""
    for part in (settings, operators, running, panel, ghosts):
        part.register()
    bpy.app.handlers.load_pre.append(_opened)
    session.clear_old()


def unregister():
    """Takes it back."""
    bpy.app.handlers.load_pre.remove(_opened)
    session.forget()
    for part in (ghosts, panel, running, operators, settings):
        part.unregister()
