"""What is read from scenes."""

import math

import bmesh
import bpy
import numpy as np
import pytest
from conftest import cube, ready

import make
from plaus_blender import reading, settings, shapes, world


def read():
    """The world of the scene, by names."""
    made, objects = reading.read(bpy.context)
    return made, {each.name: each for each in made.things}, objects


def said(made, thing):
    """All that is told about an object."""
    return " | ".join(each.words for each in made.findings if each.thing == thing)


def test_settings_of_rigid_bodies_are_taken_over(scene):
    each = cube("Box.001", mass=2.5, friction=0.3, bounce=0.4)
    each.rotation_euler, each.scale = (0.2, 0.3, 0.4), (1.0, 2.0, 0.5)
    each.rigid_body.linear_damping = 0.5
    each.plaus.thrown, each.plaus.turning = (1.0, 2.0, 3.0), (90.0, 0.0, 0.0)
    ready(each)
    made, things, _ = read()
    box = things["Box_001"]
    assert box.role == "body" and box.solids[0].kind == "box"
    assert np.allclose(box.solids[0].size, (1000, 2000, 500), atol=1e-2), "the scale is applied"
    assert np.allclose(box.place, (0, 0, 2000)) and (box.mass, box.friction) == (2.5, pytest.approx(0.3))
    assert box.damping == pytest.approx(math.log(2)) and box.angular_damping == 0.0
    assert box.velocity == (1.0, 2.0, 3.0) and box.spin == (90.0, 0.0, 0.0)
    assert made.gravity == pytest.approx(9.81) and made.duration == pytest.approx(47 / 24)
    assert made.ground == "Floor" and things["Floor"].role == "fixed"


def test_modifiers_parents_and_mirrored_scales_are_applied(scene):
    above = bpy.data.objects.new("Above", None)
    scene.collection.objects.link(above)
    above.location, above.scale = (1.0, 0.0, 0.0), (2.0, 2.0, 2.0)
    each = cube(size=1.0)
    each.parent = above
    each.scale = (-1.0, 1.0, 1.0)
    each.modifiers.new("Wider", "ARRAY").count = 2
    bpy.context.view_layer.update()
    _, things, _ = read()
    box = things["Cube"]
    # Two cubes side by side, twice as large. The faces between them are no part of a box.
    assert box.solids[0].kind == "hull" and shapes.volume(box.solids[0]) == pytest.approx(16e9, rel=1e-5)
    assert np.allclose(box.high - box.low, (4000, 2000, 2000), atol=1e-1)


def test_the_unit_scale_makes_the_same_motion_as_in_blender(scene):
    scene.unit_settings.system, scene.unit_settings.scale_length = "METRIC", 0.01
    ready(cube())
    made, things, _ = read()
    assert things["Cube"].solids[0].size[0] == pytest.approx(10.0)
    assert made.gravity == pytest.approx(0.0981)
    assert any("-981" in each.words for each in made.findings)


def test_animated_objects_follow_their_keyframes(scene):
    each = cube("Paddle", place=(0, 0, 5))
    each.rigid_body.kinematic = True
    each.keyframe_insert("location", frame=1)
    each.location.x = 4.0
    each.keyframe_insert("location", frame=25)
    ready(cube())
    _, things, _ = read()
    paddle = things["Paddle"]
    assert paddle.role == "driven" and paddle.keys[0].time == 0.0
    assert np.allclose(paddle.keys[-1].place, (4000, 0, 5000), atol=1e-2)
    at = next(key for key in paddle.keys if key.time >= 0.49)
    whole = [key for key in paddle.keys if key.time <= 1.001]
    assert len(whole) < 25 + 1 and at.place[0] > 1000
    still = cube("Still")
    still.rigid_body.kinematic = True
    assert read()[1]["Still"].role == "fixed"


def test_joints_become_joints_or_are_told(scene):
    door, post = cube("Door", place=(0, 0, 2)), cube("Post", kind="PASSIVE", place=(2, 0, 2))
    ready(door)
    kinds = ("HINGE", "POINT", "FIXED", "SLIDER")
    for number, kind in enumerate(kinds):
        bpy.ops.object.empty_add(location=(1, 0, 1 + number))
        empty = bpy.context.object
        empty.name = kind
        bpy.ops.rigidbody.constraint_add(type=kind)
        joint = empty.rigid_body_constraint
        joint.object1, joint.object2 = post, door
        joint.use_breaking, joint.breaking_threshold = kind == "FIXED", 3.0
        joint.use_limit_ang_z, joint.limit_ang_z_lower, joint.limit_ang_z_upper = True, -0.5, 1.0
    made, _, _ = read()
    hinge, point, fixed = sorted(made.joints, key=lambda each: kinds.index(each.name))
    assert hinge.body == "Door" and hinge.to == "" and hinge.kind["hinge"]["axis"] == [0.0, 0.0, 1.0]
    assert np.allclose(hinge.kind["hinge"]["limits_deg"], (-28.6479, 57.29578), atol=1e-3)
    assert point.kind == {"ball": {}} and fixed.kind == {"weld": {"breaks_at_n_s": 3.0}}
    assert "left out" in said(made, "SLIDER")


def test_compounds_are_read_piece_by_piece(scene):
    whole = cube("Handle", size=0.2, place=(0, 0, 2))
    piece = cube("Head", size=0.4, place=(0, 0, 2.5))
    piece.rotation_euler = (0, 0, 0.5)
    piece.parent, piece.matrix_parent_inverse = whole, whole.matrix_world.inverted()
    bpy.context.view_layer.update()
    whole.rigid_body.collision_shape = "COMPOUND"
    piece.rigid_body.collision_shape = "BOX"
    ready(whole)
    _, things, _ = read()
    assert "Head" not in things
    [solid] = things["Handle"].solids
    assert solid.kind == "box" and np.allclose(solid.middle, (0, 0, 500), atol=1e-2)
    assert np.allclose(solid.turn[:2, 0], (math.cos(0.5), math.sin(0.5)), atol=1e-5)
    assert "compound" in world._shape(things["Handle"])


def test_what_cannot_be_mapped_is_told_object_by_object(scene):
    each = cube()
    ready(each)
    each.rigid_body.use_margin = True
    each.constraints.new("LIMIT_LOCATION")
    each.rigid_body.collision_collections[0] = False
    group = bpy.data.collections.new("Group")
    group.objects.link(each)
    copies = bpy.data.objects.new("Copies", None)
    copies.instance_type, copies.instance_collection = "COLLECTION", group
    scene.collection.objects.link(copies)
    bpy.ops.object.effector_add(type="WIND")
    bpy.context.object.name = "Storm"
    scene.gravity = (1.0, 0.0, -9.81)
    hidden = cube("Hidden")
    hide = bpy.data.collections.new("Hide")
    scene.collection.children.link(hide)
    hide.objects.link(hidden)
    scene.collection.objects.unlink(hidden)
    bpy.context.view_layer.layer_collection.children["Hide"].exclude = True
    made, _, _ = read()
    assert made.thing("Copies").role == "body"
    for words in ("margin", "object constraints", "collision collections"):
        assert words in said(made, "Cube"), words
    assert "one body of what it shows: Cube" in said(made, "Copies") and "force field" in said(made, "Storm")
    assert "view layer" in said(made, "Hidden") and "straight down" in said(made, "")


def test_hollow_bodies_of_the_shape_mesh_are_cut_into_convex_pieces(scene):
    bpy.ops.mesh.primitive_torus_add(location=(0, 0, 1), major_segments=24, minor_segments=8)
    ring = make.body("Ring", shape="MESH", mass=3.0)
    ready(ring)
    made, things, _ = read()
    solids = things["Ring"].solids
    assert {each.kind for each in solids} == {"hull"} and len(solids) > 4
    assert f"is hollow, and collides as {len(solids)} convex pieces" in said(made, "Ring")
    # Nothing is in the hole: all is at least 0.6 m from the axis, as the ring is 0.75 m wide within.
    assert min(np.hypot(*each.corners[:, :2].T).min() for each in solids) > 600
    custom = world.scenario(made, [], 1)["world"]["custom"]
    [stuff] = [each for each in custom["materials"] if each["name"] == custom["bodies"][0]["material"]]
    mass = stuff["density"] * sum(shapes.volume(each) for each in solids) * 1e-9
    assert mass == pytest.approx(3.0)
    ring.rigid_body.collision_shape = "CONVEX_HULL"
    assert [each.kind for each in read()[1]["Ring"].solids] == ["hull"]
    ring.rigid_body.collision_shape = "MESH"
    open_mesh = bmesh.new()
    open_mesh.from_mesh(ring.data)
    open_mesh.faces.ensure_lookup_table()
    open_mesh.faces.remove(open_mesh.faces[0])
    open_mesh.to_mesh(ring.data)
    open_mesh.free()
    made, things, _ = read()
    assert len(things["Ring"].solids) == 1 and "has holes" in said(made, "Ring")


def test_a_floor_is_offered_where_things_fall_for_ever():
    scene = make.start(48)
    each = cube("Cube", 0.4, (1, 2, 3))
    cube("Above", 0.4, (1, 2, 4))
    ready(each)
    scene.frame_set(7)
    assert bpy.ops.plaus.check() == {"FINISHED"} and scene.plaus.falls
    made, _, _ = read()
    assert "falls for ever" in said(made, "Cube") and said(made, "Above") == ""
    assert bpy.ops.plaus.floor() == {"FINISHED"} and scene.frame_current == 7 and bpy.context.active_object == each
    made, _, _ = read()
    assert made.ground == "Floor" and not made.falls and said(made, "Cube") == ""
    assert np.allclose(made.thing("Floor").high[2], 2800, atol=1e-2)
    bpy.ops.plaus.check()
    assert not scene.plaus.falls


def test_a_bodys_settings_may_be_varied_together(scene):
    one, two, still = cube("One"), cube("Two", place=(2, 0, 2)), cube("Still", place=(4, 0, 2), kind="PASSIVE")
    make.select(one, two, still)
    bpy.ops.plaus.vary()
    bpy.ops.plaus.vary(level="LOT", release=True, mass=True, friction=True, bounce=True, **dict.fromkeys(
        ("position", "rotation", "velocity", "spin"), False))
    for each in (one, two):
        assert [getattr(each.plaus, what) for what in settings.VARIES] == ["SOME"] * 4 + ["LOT"] * 4
    assert {getattr(still.plaus, what) for what in settings.VARIES} == {"NONE"}


def test_keyframes_of_the_settings_themselves_are_told(scene):
    each = cube()
    ready(each)
    each.rigid_body.kinematic = True
    each.rigid_body.keyframe_insert("kinematic", frame=1)
    assert "those of the first frame count" in said(read()[0], "Cube")
