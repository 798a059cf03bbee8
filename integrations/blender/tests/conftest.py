"""Blender's Python module with the extension registered as Blender would do it."""

import atexit
import os
import sys
from pathlib import Path

import bpy
import pytest

FOLDER = Path(__file__).resolve().parent.parent
sys.path[:0] = [str(FOLDER), str(FOLDER / "examples")]

import plaus_blender  # noqa: E402

plaus_blender.register()
# As Blender does when it is closed: version 4.2 does not survive its end otherwise.
atexit.register(plaus_blender.unregister)


def pytest_sessionfinish(session, exitstatus):
    """Keeps the outcome for the end."""
    session.config.outcome = int(exitstatus)


def pytest_unconfigure(config):
    """Ends at once: where a property has an update function, Blender's modules before 4.4 crash at Python's end."""
    if bpy.app.version < (4, 4):
        sys.stdout.flush()
        os._exit(config.outcome)


@pytest.fixture
def scene():
    """An empty scene of two seconds with a floor."""
    import make

    made = make.start(48)
    make.floor(20.0)
    return made


def cube(name="Cube", size=1.0, place=(0.0, 0.0, 2.0), **keys):
    """A cube that is a rigid body."""
    import make

    bpy.ops.mesh.primitive_cube_add(size=size, location=place)
    return make.body(name, **keys)


def ready(each, within=5.0):
    """Lets an object vary and asks for an end, by default one that is easily met."""
    import make

    make.select(each)
    bpy.ops.plaus.vary(level="SOME")
    make.wish("ENDS_AT", each, make.target("Spot", (0.0, 0.0, 0.0), within), within=within)


def findings():
    """What the panel says, by object."""
    return {(each.thing, each.words): each.stops for each in bpy.context.scene.plaus.findings}


def told(part):
    """Whether the panel says something with these words."""
    return any(part in words for _, words in findings())
