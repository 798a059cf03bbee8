"""What is shown by an empty, and what hangs on something that moves."""

import bpy
import numpy as np
import pytest
from conftest import cube, ready, told
from mathutils import Matrix, Vector
from test_examples import agrees

import make
from plaus_blender import asked, ghosts, reading, sampling, session


def shown(name, group, place, turn=0.0):
    """An empty that shows a collection."""
    empty = bpy.data.objects.new(name, None)
    empty.instance_type, empty.instance_collection = "COLLECTION", group
    empty.location, empty.rotation_euler = place, (0.0, 0.0, turn)
    bpy.context.scene.collection.objects.link(empty)
    return empty


def hammers(scene):
    """A collection, shown nowhere else, of a head and a handle, which is shown twice."""
    group = bpy.data.collections.new("Hammer")
    group.instance_offset = (0.0, 0.0, 9.0)
    scene.collection.children.link(group)
    for each in (cube("Head", 0.4, (0, 0, 9.3), mass=3.0), cube("Handle", 0.2, (0, 0, 9))):
        scene.collection.objects.unlink(each)
        group.objects.link(each)
    bpy.context.view_layer.layer_collection.children["Hammer"].exclude = True
    return [shown("One", group, (0, 0, 2), 0.5), shown("Two", group, (3, 0, 2))]


def test_what_an_empty_shows_moves_as_one_body(scene):
    one, two = hammers(scene)
    ready(one)
    make.wish("FALLS", two)
    world, objects = reading.read(bpy.context)
    thing = world.thing("One")
    assert thing.role == "body" and thing.mass == 4.0 and len(thing.solids) == 2 and objects["One"] == one
    middles = sorted(tuple(np.round(solid.middle, 3)) for solid in thing.solids)
    assert np.allclose(middles, [(0, 0, 0), (0, 0, 300)], atol=1e-2)
    scene.plaus.wishes.remove(1)
    scene.plaus.wanted = 1
    assert bpy.ops.plaus.sample() == {"FINISHED"}, scene.plaus.status
    assert told("is one body of what it shows: Handle, Head")
    assert {each[0].name for each in ghosts.poses(scene)} == {"Head", "Handle"}
    assert bpy.ops.plaus.bake() == {"FINISHED"}
    agrees(scene, session.of(scene), 0)
    assert one.animation_data.action and two.animation_data.action
    assert bpy.data.objects["Head"].animation_data is None


def test_an_empty_that_shows_empties_is_one_body_of_all_they_show(scene):
    for each in hammers(scene):
        bpy.data.objects.remove(each)
    pair = bpy.data.collections.new("Pair")
    for name, x in (("Left", -0.5), ("Right", 0.5)):
        each = shown(name, bpy.data.collections["Hammer"], (x, 0, 0))
        scene.collection.objects.unlink(each)
        pair.objects.link(each)
    both = shown("Both", pair, (0, 0, 2), 0.5)
    bpy.context.view_layer.update()
    ready(both)
    world, _ = reading.read(bpy.context)
    [thing] = world.bodies()
    assert thing.name == "Both" and thing.mass == 8.0
    middles = sorted(tuple(np.round(solid.middle)) for solid in thing.solids)
    assert np.allclose(middles, [(-500, 0, 0), (-500, 0, 300), (500, 0, 0), (500, 0, 300)], atol=1)
    scene.plaus.wanted = 1
    assert bpy.ops.plaus.sample() == {"FINISHED"}, scene.plaus.status
    scene.frame_set(12)
    ghost = [matrix for each, matrix, colour in ghosts.poses(scene) if colour == ghosts.CHOSEN]
    bpy.ops.plaus.bake()
    scene.frame_set(12)
    instances = bpy.context.evaluated_depsgraph_get().object_instances
    there = [np.array(each.matrix_world) for each in instances if each.is_instance and each.object.type == "MESH"]
    assert len(there) == 4
    for matrix in ghost:
        assert min(np.abs(each - np.array(matrix)).max() for each in there) < 1e-5
    agrees(scene, session.of(scene), 0)


def test_ghosts_of_what_an_empty_shows_are_where_blender_shows_it(scene):
    one, _ = hammers(scene)
    ready(one)
    scene.plaus.wanted = 1
    bpy.ops.plaus.sample()
    scene.frame_set(12)
    ghost = {each.name: matrix for each, matrix, colour in ghosts.poses(scene) if colour == ghosts.CHOSEN}
    bpy.ops.plaus.bake()
    scene.frame_set(12)
    instances = bpy.context.evaluated_depsgraph_get().object_instances
    there = [each.matrix_world.copy() for each in instances if each.is_instance and each.object.name == "Head"]
    assert min(np.abs(np.array(each) - np.array(ghost["Head"])).max() for each in there) < 1e-5


def test_scenery_that_an_empty_shows_is_hit(scene):
    bump = cube("Bump", 1.0, (0, 0, 0), kind="PASSIVE")
    group = bpy.data.collections.new("Bumps")
    scene.collection.objects.unlink(bump)
    group.objects.link(bump)
    shown("Step", group, (0, 0, 0.5))
    ball = cube("Ball", 0.2, (0, 0, 2))
    ready(ball)
    scene.plaus.wanted = 1
    make.wish("TOUCHES", ball, bpy.data.objects["Step"])
    assert bpy.ops.plaus.sample() == {"FINISHED"}, scene.plaus.status
    assert bpy.ops.plaus.bake() == {"FINISHED"}
    agrees(scene, session.of(scene), 0)


def test_a_change_of_what_is_shown_is_noticed(scene):
    one, _ = hammers(scene)
    ready(one)
    before = asked.fingerprint(scene)
    bpy.data.objects["Head"].location.z += 0.1
    bpy.data.objects["Head"].matrix_world = Matrix.Translation(Vector((0, 0, 9.4)))
    assert asked.fingerprint(scene) != before


@pytest.mark.parametrize("above", ["an object", "a driven body", "the parent's parent"])
def test_what_hangs_on_something_that_moves_is_baked_where_it_goes(scene, above):
    parent = animated = cube("Parent", 0.3, (3, 0, 0.5))
    if above == "a driven body":
        parent.rigid_body.type, parent.rigid_body.kinematic = "PASSIVE", True
    else:
        bpy.ops.rigidbody.object_remove()
    if above == "the parent's parent":
        animated = make.target("Above", (1, 0, 0), 1.0)
        parent.parent = animated
    animated.keyframe_insert("location", frame=1)
    animated.keyframe_insert("rotation_euler", frame=1)
    animated.location.x, animated.rotation_euler.z = animated.location.x + 2.0, 1.0
    animated.keyframe_insert("location", frame=40)
    animated.keyframe_insert("rotation_euler", frame=40)
    scene.frame_set(1)
    child = cube("Child", 0.3, (0, 0, 2))
    child.parent, child.matrix_parent_inverse = parent, parent.matrix_world.inverted()
    ready(child)
    scene.plaus.wanted = 1
    scene.frame_set(20)
    start = child.matrix_basis.copy()
    assert bpy.ops.plaus.sample() == {"FINISHED"}, scene.plaus.status
    assert told("its parent Parent moves") and scene.frame_current == 20
    assert bpy.ops.plaus.bake() == {"FINISHED"} and scene.frame_current == 20
    agrees(scene, session.of(scene), 0)
    scene.frame_set(20)
    bpy.ops.plaus.restore()
    assert np.abs(np.array(child.matrix_basis) - np.array(start)).max() < 1e-6


@pytest.mark.parametrize("scale", [(-1, 1, 2), (1, -1.5, 0.5), (-1, -1, -2)])
@pytest.mark.parametrize("above", [(2, 2, 2), (-2, 2, 2)])
def test_mirrored_objects_are_baked_as_they_look(scene, scale, above):
    parent = make.target("Parent", (0, 0, 1), 1.0)
    parent.scale, parent.rotation_euler = above, (0.2, 0.3, 0.1)
    each = cube("Cube", 0.2, (0, 0, 0))
    # A corner moved inwards, so that it differs from its mirror image.
    each.data.vertices[0].co *= 0.5
    each.parent, each.location, each.rotation_euler, each.scale = parent, (0, 0, 0.5), (0.3, 0.4, 0.5), scale
    bpy.context.view_layer.update()
    start = np.array(each.matrix_world)
    ready(each)
    scene.plaus.wanted = 1
    assert bpy.ops.plaus.sample() == {"FINISHED"}, scene.plaus.status
    shown = {}
    for frame in (1, 9, 20):
        scene.frame_set(frame)
        [[_, shown[frame], _]] = [one for one in ghosts.poses(scene) if one[2] == ghosts.CHOSEN]
    bpy.ops.plaus.bake()
    for frame, ghost in shown.items():
        scene.frame_set(frame)
        there = np.array(each.evaluated_get(bpy.context.evaluated_depsgraph_get()).matrix_world)
        assert np.abs(there - np.array(ghost)).max() < 1e-5, frame
        # From the start on it has only been moved and turned.
        moved = there[:3, :3] @ np.linalg.inv(start[:3, :3])
        assert np.abs(moved.T @ moved - np.eye(3)).max() < 1e-5 and np.linalg.det(moved) > 0


def test_parents_scaled_unevenly_are_told(scene):
    parent = make.target("Parent", (0, 0, 1), 1.0)
    parent.scale = (1, 2, 1)
    each = cube("Cube", 0.5, (0, 0, 1))
    each.parent = parent
    bpy.context.view_layer.update()
    ready(each)
    with pytest.raises(sampling.Refused, match="Cube: its parents are scaled unevenly"):
        session.prepare(bpy.context)


def test_what_hangs_on_a_simulated_body_is_left_out_and_told(scene):
    parent, child = cube("Parent", 0.3, (3, 0, 0.5)), cube("Child", 0.3, (0, 0, 2))
    child.parent, child.matrix_parent_inverse = parent, parent.matrix_world.inverted()
    ready(parent)
    assert list(session.prepare(bpy.context).frames) == ["Parent"]
    assert told("Blender cannot play: left out")


def test_scenery_with_a_moving_parent_is_told(scene):
    ready(cube())
    wall = cube("Wall", 0.5, (4, 0, 0.5), kind="PASSIVE")
    wall.keyframe_insert("location", frame=1)
    session.prepare(bpy.context)
    assert told("only if its box Animated is ticked")


def test_impacts_beside_a_frame_or_another_impact_have_keys(scene):
    from types import SimpleNamespace

    from plaus_blender import baking

    frames = np.array([3.004, 5.5, 5.503, 5.5031, 40.001])
    events = {"t": frames / 24.0, "body": ["Cube"] * 5, "other": ["Floor"] * 5}
    ending = SimpleNamespace(replay=SimpleNamespace(events=events))
    ready(cube())
    request = session.prepare(bpy.context)
    assert isinstance(request, sampling.Request)
    keys = baking.frames_of(ending, request, "Cube", scene.frame_start)
    assert np.allclose(keys[keys != np.round(keys)], [3.004, 5.5, 5.503, 40.001])
    # Far along the timeline, frames are kept less finely.
    keys = baking.frames_of(ending, request, "Cube", 1_000_000)
    assert (np.diff(np.float32(keys + 1_000_000)) > 0).all()
