"""Each example from its file to a baked animation, against the package's own replay."""

import json
import os
import time
import tomllib

import bpy
import numpy as np
import plaus
import pytest
from bpy_extras.object_utils import world_to_camera_view
from mathutils import Matrix, Vector

import make
import pictures
from plaus_blender import asked, baking, reading, sampling, session

# What a baked object may be off at a frame, in m: what is promised. Blender's own numbers have 7 digits.
FAR, TURNED = 1e-4, 1e-4


def state():
    """Where everything is, and whether it is animated."""
    bpy.context.view_layer.update()
    return {
        each.name: ([list(row) for row in each.matrix_world], bool(each.animation_data and each.animation_data.action))
        for each in bpy.context.scene.objects
    }


def baked_poses(scene, name):
    """Places in m and rotations of an object at all frames."""
    made = []
    for frame in range(scene.frame_start, scene.frame_end + 1):
        scene.frame_set(frame)
        each = bpy.data.objects[name].evaluated_get(bpy.context.evaluated_depsgraph_get())
        made.append(np.array(each.matrix_world, dtype=float))
    return np.array(made)


def at_impacts(scene, at_hand, replay, body, each):
    """How far the centre of gravity is from where the package says, at most, at the first hundred impacts of a body."""
    name = replay.bodies[body]
    axes, origin = (np.array(part) for part in at_hand.request.frames[name])
    centre = axes @ np.array(at_hand.request.centres.get(name, (0, 0, 0))) / 1000 + origin / 1000
    times = [t for t, *pair in zip(*(replay.events[key] for key in ("t", "body", "other"))) if name in pair][:100]
    last = (scene.frame_end - scene.frame_start) / reading.fps(scene)
    times = [time for time in times if time < last]
    worst = 0.0
    for time_s, (x, y, z) in zip(times, replay.poses(times=times).position[:, body] if times else ()):
        frame = scene.frame_start + time_s * reading.fps(scene)
        scene.frame_set(int(frame), subframe=frame % 1.0)
        there = np.array(each.evaluated_get(bpy.context.evaluated_depsgraph_get()).matrix_world)
        place = there[:3, :3] / np.array(each.matrix_world.to_scale()) @ centre + there[:3, 3]
        worst = max(worst, np.abs(place - (x, -z, y)).max())
    return worst


def agrees(scene, at_hand, number):
    """Compares what is baked with the package's replay: places of centres of gravity, and rotations."""
    run = plaus.Run(os.path.join(session.place(scene), "run"))
    replay = run.replay(scene.plaus.endings[number].sample)
    count = scene.frame_end - scene.frame_start + 1
    poses = replay.poses(times=np.minimum(np.arange(count) / reading.fps(scene), replay.duration))
    worst = 0.0
    for body, name in enumerate(poses.bodies):
        if name not in at_hand.request.frames:
            continue  # it follows its own keyframes
        each = session.objects_of(scene)[name]
        worst = max(worst, at_impacts(scene, at_hand, replay, body, each))
        there = baked_poses(scene, each.name)
        axes, origin = (np.array(part) for part in at_hand.request.frames[name])
        centre = axes @ np.array(at_hand.request.centres.get(name, (0, 0, 0))) / 1000 + origin / 1000
        x, y, z = poses.position[:, body].T
        scale = np.array(each.matrix_world.to_scale())
        turns = there[:, :3, :3] / scale
        places = there[:, :3, 3] + turns @ centre
        worst = max(worst, np.abs(places - np.stack([x, -z, y], axis=1)).max())
        # A quarter turn about x makes y up of z up.
        up = Matrix(((1, 0, 0), (0, 0, -1), (0, 1, 0)))
        for at in range(0, count, 5):
            qx, qy, qz, qw = poses.orientation[at, body]
            from mathutils import Quaternion

            turn = np.array(up @ Quaternion((qw, qx, qy, qz)).to_matrix()) @ axes.T
            assert np.abs(turn - turns[at]).max() < TURNED, (name, at)
    assert worst < FAR, worst
    return worst


def is_seen(scene, folder):
    """The last frame, rendered with and without what moves, shows it: it has not fallen through the floor."""
    moving = list(session.objects_of(scene).values())
    shown = []
    for hidden in (False, True):
        for each in moving:
            each.hide_render = hidden
        path = folder / f"{hidden}.webp"
        pictures.rendered(path, scene.frame_end, share=25, samples=4)
        image = bpy.data.images.load(str(path))
        width, height = image.size
        shown.append(np.array(image.pixels[:]).reshape(height, width, 4)[:, :, :3])
    for each in moving:
        each.hide_render = False
    # Light differs by a few hundredths where nothing is.
    other = np.abs(shown[0] - shown[1]).max(axis=2) > 0.15
    assert other.sum() > 0.003 * other.size, "what moves is in the picture"
    seen = 0
    for each in moving:
        middle = sum((each.matrix_world @ Vector(corner) for corner in each.bound_box), Vector()) / 8
        x, y, depth = world_to_camera_view(scene, scene.camera, middle)
        row, column = int(y * other.shape[0]), int(x * other.shape[1])
        if depth > 0 and 0 <= row < other.shape[0] and 0 <= column < other.shape[1]:
            seen += other[max(row - 1, 0) : row + 2, max(column - 1, 0) : column + 2].any()
    assert seen >= len(moving) / 2, f"{seen} of {len(moving)} are seen where they are"


@pytest.mark.parametrize("name", make.EXAMPLES)
def test_from_file_to_baked_animation(name, tmp_path):
    make.EXAMPLES[name]()
    path = str(tmp_path / f"{name}.blend")
    bpy.ops.wm.save_as_mainfile(filepath=path)
    bpy.ops.wm.open_mainfile(filepath=path)
    scene = bpy.context.scene
    scene.plaus.wanted = 2
    before = state()
    assert bpy.ops.plaus.sample() == {"FINISHED"}, scene.plaus.status
    assert state() == before, "sampling leaves the scene as it is"
    assert len(scene.plaus.endings) >= 1
    at_hand = session.of(scene)
    for ending in at_hand.endings:
        assert ending.replay.satisfied
    begun = time.process_time()
    assert bpy.ops.plaus.bake() == {"FINISHED"}
    spent = time.process_time() - begun
    print(f"{name}: {len(at_hand.request.frames)} objects baked in {spent:.2f} s of processor time")
    worst = agrees(scene, at_hand, 0)
    print(f"{name}: off by {worst:.1e} m at most")
    for each in session.objects_of(scene).values():
        assert "ending 1" in each.animation_data.action.name
    is_seen(scene, tmp_path)
    assert bpy.ops.plaus.restore() == {"FINISHED"}
    scene.frame_set(scene.frame_start)
    after = state()
    for thing, (matrix, animated) in before.items():
        assert np.allclose(after[thing][0], matrix, atol=1e-6) and after[thing][1] == animated, thing
    assert scene.rigidbody_world.enabled


def test_a_saved_file_brings_its_endings_back(tmp_path):
    make.cans()
    scene = bpy.context.scene
    scene.plaus.wanted = 3
    bpy.ops.plaus.sample()
    samples = [each.sample for each in scene.plaus.endings]
    facts = session.of(scene).endings[-1].replay.facts
    kept = json.loads(scene.plaus.kept)
    assert kept["version"] == plaus.__version__ and "seed = 1" in bpy.data.texts["Plaus scenario of Scene"].as_string()
    path = str(tmp_path / "kept.blend")
    bpy.ops.wm.save_as_mainfile(filepath=path)
    bpy.ops.wm.open_mainfile(filepath=path)
    scene = bpy.context.scene
    assert session.of(scene) is None, "another file was opened"
    with pytest.raises(RuntimeError, match="Bring Back"):
        bpy.ops.plaus.bake()
    assert bpy.ops.plaus.rebuild() == {"FINISHED"}
    assert [each.sample for each in scene.plaus.endings] == samples
    again = session.of(scene).endings[-1].replay.facts
    assert again["log_p"] == facts["log_p"] and again["scalars"] == facts["scalars"]
    assert "may not be the same" not in scene.plaus.status
    scene.plaus.kept = json.dumps({**kept, "version": "0.0.1"})
    bpy.ops.plaus.rebuild()
    assert "made with Plaus 0.0.1, and may not be the same" in scene.plaus.status


def test_a_stopped_run_comes_back_too():
    make.cans()
    scene = bpy.context.scene
    scene.plaus.wanted = 500
    job = sampling.Job(session.prepare(bpy.context), session.place(scene))
    job.start()
    while job.is_alive and job.found < 3:
        time.sleep(0.05)
    job.stop()
    job.wait()
    session.take(scene, job)
    samples = [each.sample for each in scene.plaus.endings]
    assert samples and session.kept_request(scene).iterations == job.run.iterations
    session.forget()
    assert bpy.ops.plaus.rebuild() == {"FINISHED"}
    assert [each.sample for each in scene.plaus.endings] == samples


def test_several_endings_as_tracks_and_sampling_again():
    make.cans()
    scene = bpy.context.scene
    scene.plaus.wanted = 3
    bpy.ops.plaus.sample()
    text = session.of(scene).request.scenario
    for number in range(2):
        scene.plaus.ending = number
        bpy.ops.plaus.bake(tracks=True)
    ball = bpy.data.objects["Ball"]
    tracks = ball.animation_data.nla_tracks
    assert len(tracks) == 2 and tracks[0].mute and not tracks[1].mute
    agrees(scene, session.of(scene), 1)
    # What is baked does not become the start of the next world.
    bpy.ops.plaus.sample()
    assert session.of(scene).request.scenario == text


def test_impacts_have_keys_of_their_own():
    make.cans()
    scene = bpy.context.scene
    scene.plaus.wanted = 1
    bpy.ops.plaus.sample()
    bpy.ops.plaus.bake()
    action = bpy.data.objects["Ball"].animation_data.action
    curves = action.fcurves if hasattr(action, "fcurves") else action.layers[0].strips[0].channelbags[0].fcurves
    [x, *_] = curves
    frames = np.array([point.co[0] for point in x.keyframe_points]) - scene.frame_start
    ending = session.of(scene).endings[0]
    hits = [t for t, a, b in zip(*(ending.replay.events[key] for key in ("t", "body", "other"))) if "Ball" in (a, b)]
    first = min(hits) * 24
    assert np.abs(frames - first).min() < 0.05, "a key at the first impact"
    assert (frames != np.round(frames)).any()
    assert {point.interpolation for point in x.keyframe_points} == {"LINEAR"}


def test_ghosts_are_where_the_ending_is():
    from plaus_blender import ghosts

    make.cans()
    scene = bpy.context.scene
    scene.plaus.wanted = 2
    bpy.ops.plaus.sample()
    count = len(scene.plaus.endings)
    scene.frame_set(20)
    drawn = ghosts.poses(scene)
    assert len(drawn) == 4 * count and [each[2] for each in drawn[-4:]] == [ghosts.CHOSEN] * 4
    shown = {each.name: matrix for each, matrix, _ in drawn[-4:]}
    bpy.ops.plaus.bake()
    scene.frame_set(20)
    for each in session.objects_of(scene).values():
        matrix = each.evaluated_get(bpy.context.evaluated_depsgraph_get()).matrix_world
        assert np.abs(np.array(matrix) - np.array(shown[each.name])).max() < 1e-5, each.name
    assert ghosts.poses(scene) == [], "what is baked needs no ghost"
    bpy.ops.plaus.step(by=-1)
    assert scene.plaus.ending == count - 1


def test_two_endings_can_be_compared_and_more_like_one_found():
    from plaus_blender import ghosts

    make.cans()
    scene = bpy.context.scene
    scene.plaus.wanted = 3
    bpy.ops.plaus.sample()
    first = [each.sample for each in scene.plaus.endings]
    scene.plaus.ending = 1
    bpy.ops.plaus.compare()
    scene.plaus.ending = 2
    colours = [each[2] for each in ghosts.poses(scene)]
    assert colours == [ghosts.OTHERS] * 4 + [ghosts.COMPARED] * 4 + [ghosts.CHOSEN] * 4
    bpy.ops.plaus.compare()
    assert ghosts.COMPARED not in [each[2] for each in ghosts.poses(scene)]
    chosen = session.of(scene).endings[2]
    assert bpy.ops.plaus.like() == {"FINISHED"}, scene.plaus.status
    at_hand = session.of(scene)
    ends = sampling.near(at_hand.request, chosen)
    for ending in at_hand.endings:
        assert ending.replay.satisfied
        for name, (there, _) in sampling.near(at_hand.request, ending).items():
            assert np.linalg.norm(there - ends[name][0]) <= ends[name][1]
    bpy.ops.plaus.back()
    assert [each.sample for each in scene.plaus.endings] == first and "inside" not in session.of(scene).request.scenario


def test_all_endings_become_tracks_and_a_changed_scene_is_sampled_again():
    make.cans()
    scene = bpy.context.scene
    scene.plaus.wanted = 3
    bpy.ops.plaus.sample()
    scene.plaus.ending = 1
    bpy.ops.plaus.bake_all()
    ball = bpy.data.objects["Ball"]
    assert [track.mute for track in ball.animation_data.nla_tracks] == [True, True, False]
    assert all(each.baked for each in scene.plaus.endings) and scene.plaus.ending == 1
    agrees(scene, session.of(scene), 1)
    bpy.ops.plaus.restore()
    assert scene.plaus.fingerprint == asked.fingerprint(scene), "baking and clearing change nothing"
    chosen = session.of(scene).endings[1]
    ball.location.y += 0.01
    assert scene.plaus.fingerprint != asked.fingerprint(scene)
    bpy.ops.plaus.refresh()
    assert scene.plaus.fingerprint == asked.fingerprint(scene)
    far = [
        sum(np.linalg.norm(each.poses[name][0][-1] - chosen.poses[name][0][-1]) for name in each.poses)
        for each in session.of(scene).endings
    ]
    assert int(np.argmin(far)) == scene.plaus.ending


def test_a_marker_says_when():
    make.dominoes()
    scene = bpy.context.scene
    wish = scene.plaus.wishes[0]
    scene.timeline_markers.new("Now", frame=wish.frame + 2)
    wish.marker = "Now"
    require = tomllib.loads(session.prepare(bpy.context).scenario)["require"]
    wish.marker, wish.frame = "", wish.frame + 2
    [now, *_] = tomllib.loads(session.prepare(bpy.context).scenario)["require"]
    assert now["named"].pop("name") != require[0]["named"].pop("name") and now == require[0]
    wish.marker = "Never"
    with pytest.raises(sampling.Refused, match="no marker Never"):
        session.prepare(bpy.context)
