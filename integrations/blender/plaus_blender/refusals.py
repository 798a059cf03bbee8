"""How operators say in the panel, and where Blender shows reports, why something was not done."""

import functools

from .sampling import Refused


def refuse(operator, context, error):
    """Says in the panel, and where Blender shows reports, why something was not done."""
    context.scene.plaus.status = str(error)
    operator.report({"ERROR"}, str(error))
    return {"CANCELLED"}


def tried(operator, context, action, *given):
    """What an action comes to, or why it was refused, said."""
    try:
        return action(operator, context, *given) or {"FINISHED"}
    except Refused as error:
        return refuse(operator, context, error)


def told(action):
    """An `execute` that says why it refuses what it refuses."""

    @functools.wraps(action)
    def execute(self, context):
        return tried(self, context, action)

    return execute


def told_of(action):
    """The same for what is given an event. Blender looks at the number of arguments."""

    @functools.wraps(action)
    def heard(self, context, event):
        return tried(self, context, action, event)

    return heard
