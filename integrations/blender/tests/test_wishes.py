"""What must happen is true of what is baked, as Blender plays it."""

import bpy
import numpy as np
from conftest import cube

import make
from plaus_blender import session

# Blender's own numbers have 7 digits; places of a metre are compared in m.
NEAR = 1e-4


def played(scene, each, step):
    """Frames, and where an object is at them: matrices."""
    frames = np.arange(scene.frame_start, scene.frame_end + step / 2, step)
    made = []
    for frame in frames:
        scene.frame_set(int(frame), subframe=frame % 1.0)
        made.append(np.array(each.evaluated_get(bpy.context.evaluated_depsgraph_get()).matrix_world))
    return frames, np.array(made)


def test_each_kind_is_true_of_what_is_baked(scene):
    scene.frame_start, scene.frame_end = 101, 172
    floor, post = bpy.data.objects["Floor"], cube("Post", 0.2, (0.6, 0, 0.1), kind="PASSIVE")
    each = cube("Cube", 0.2, (0, 0, 1.0), bounce=0.3)
    make.select(each)
    bpy.ops.plaus.vary(level="SOME")
    way, end, room = (make.target(name, place, 0.2) for name, place in (
        ("Way", (0.05, 0, 0.5)), ("End", (0.15, 0, 0)), ("Room", (0.1, 0, 0.15))))
    room.empty_display_type, room.empty_display_size = "CUBE", 0.4
    scene.timeline_markers.new("Bang", frame=111)
    make.wish("HITS", each, floor, marker="Bang", frames=1.0)
    make.wish("PASSES", each, way, within=0.2)
    make.wish("ENDS_AT", each, end, within=0.25)
    make.wish("ENDS_INSIDE", each, room)
    make.wish("SIDE_UP", each, axis="x")
    make.wish("NEVER", each, post)
    make.wish("TOUCHES", each, floor)
    make.wish("STAYS", each, within=1.2)
    make.wish("RESTS", each, frame=165)
    scene.plaus.wanted = 3
    assert bpy.ops.plaus.sample() == {"FINISHED"}, scene.plaus.status
    corners = np.array([[*corner, 1.0] for corner in each.bound_box])
    for number in range(len(scene.plaus.endings)):
        scene.plaus.ending = number
        bpy.ops.plaus.bake()
        frames, there = played(scene, each, 0.25)
        places = there[:, :3, 3]
        lowest = (there @ corners.T)[:, 2].min(axis=1)
        # It falls by less than 50 mm in a quarter of a frame.
        first = frames[np.flatnonzero(lowest < 0.05)[0]]
        assert abs(first - 111) <= 1.0 + 0.25, first
        assert np.linalg.norm(places - way.location, axis=1).min() <= 0.2 + 0.05
        assert np.linalg.norm(places[-1, :2] - np.array(end.location)[:2]) <= 0.25 + NEAR
        assert (np.abs(places[-1] - np.array(room.location)) <= 0.4 + NEAR).all()
        assert there[-1, 2, 0] > 0.99, "its x axis points up"
        beyond = np.abs((there @ corners.T)[:, :3].transpose(0, 2, 1) - (0.6, 0, 0.1)).max(axis=2)
        assert beyond.min() > 0.1 - NEAR, "no corner enters the post"
        assert np.linalg.norm(places - (0, 0, 1.0), axis=1).max() <= 1.2 + NEAR
        still = places[frames >= 165]
        assert np.abs(still - still[-1]).max() < NEAR and lowest[-1] < 0.001
    assert session.of(scene).endings[0].replay.satisfied


def test_one_is_hit_before_another(scene):
    scene.frame_end = 60
    made = [make.can(name, (x, y, 0.0), mass=0.1) for name, x, y in (("Near", 0.5, 0.0), ("Far", 1.2, 0.05))]
    thrown = make.ball("Ball", (-0.3, 0.0, 0.1), 0.05, mass=0.5)
    thrown.plaus.thrown = (3.0, 0.0, 0.0)
    make.select(thrown)
    bpy.ops.plaus.vary(level="SOME")
    make.wish("BEFORE", *made)
    make.wish("FALLS", made[0])
    make.wish("FALLS", made[1])
    scene.plaus.wanted = 2
    assert bpy.ops.plaus.sample() == {"FINISHED"}, scene.plaus.status
    bpy.ops.plaus.bake()
    moved = []
    for each in made:
        frames, there = played(scene, each, 0.25)
        far = np.linalg.norm(there[:, :3, 3] - there[0, :3, 3], axis=1)
        moved.append(frames[np.flatnonzero(far > 0.002)[0]])
        assert there[-1, 2, 2] < np.cos(np.radians(45)) + NEAR, "it has fallen over"
    assert moved[0] < moved[1]
