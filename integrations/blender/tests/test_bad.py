"""What cannot be done is said in plain words, and the scene stays as it is."""

import os
import threading
import time

import bpy
import numpy as np
import pytest
from conftest import cube, ready, told
from test_examples import state

import make
from plaus_blender import sampling, session


def refused(words):
    """Sample must be refused with these words, and change nothing."""
    before = state()
    with pytest.raises(RuntimeError, match=words):
        bpy.ops.plaus.sample()
    assert words in bpy.context.scene.plaus.status
    assert state() == before and not len(bpy.context.scene.plaus.endings)


def test_no_rigid_bodies(scene):
    refused("Nothing moves")
    for refuses in (bpy.ops.plaus.vary, bpy.ops.plaus.wish_add):
        with pytest.raises(RuntimeError, match="Select rigid bodies of the type Active"):
            refuses()
    with pytest.raises(RuntimeError, match="Nothing moves"):
        bpy.ops.plaus.floor()


def test_no_requirement(scene):
    each = cube()
    make.select(each)
    bpy.ops.plaus.vary()
    refused("Nothing must happen yet")


def test_nothing_varies(scene):
    each = cube()
    make.wish("FALLS", each)
    refused("Nothing may vary")


def test_a_mesh_without_volume(scene):
    bpy.ops.mesh.primitive_plane_add(location=(0, 0, 1))
    each = make.body("Leaf")
    ready(each)
    refused("Leaf: has no volume")


def test_a_mesh_with_a_million_triangles(scene):
    bpy.ops.mesh.primitive_grid_add(x_subdivisions=720, y_subdivisions=720, location=(0, 0, -1))
    make.body("Terrain", "PASSIVE", "MESH")
    ready(cube())
    refused("Terrain: has 1,036,800 triangles")


def test_objects_that_overlap(scene):
    for number in range(2):
        cube(f"Cube.{number}", place=(0.3 * number, 0, 2))
    ready(bpy.data.objects["Cube.0"])
    bpy.data.objects["Cube.0"].plaus.position = "LITTLE"
    bpy.data.objects["Cube.0"].plaus.rotation = "NONE"
    refused("inside")


def test_a_wish_without_its_object(scene):
    each = cube()
    ready(each)
    make.wish("NEVER", each)
    refused("choose the other object")
    scene.plaus.wishes[1].other = bpy.data.objects["Spot"]
    refused("must be a rigid body")
    make.wish("FALLS", bpy.data.objects["Floor"])
    bpy.data.objects.remove(each)
    assert told("must be a rigid body")
    refused("Nothing moves")


def test_a_folder_that_cannot_be_written(scene, monkeypatch, tmp_path):
    ready(cube())
    (tmp_path / "file").write_text("no folder")
    monkeypatch.setattr(session, "place", lambda _: str(tmp_path / "file" / "runs"))
    refused("Cannot write to")


def test_a_file_that_cannot_be_written_is_left_alone(scene, tmp_path):
    ready(cube())
    scene.plaus.wanted = 1
    path = tmp_path / "kept.blend"
    bpy.ops.wm.save_as_mainfile(filepath=str(path))
    path.chmod(0o444)
    saved = path.read_bytes()
    bpy.ops.wm.open_mainfile(filepath=str(path))
    assert bpy.ops.plaus.sample() == {"FINISHED"} and bpy.ops.plaus.bake() == {"FINISHED"}
    assert path.read_bytes() == saved and os.listdir(tmp_path) == ["kept.blend"]


def test_no_wheel_for_this_platform(scene, monkeypatch):
    ready(cube())
    monkeypatch.setattr(session.importlib.util, "find_spec", lambda _: None)
    refused("no simulator for this computer")


def test_deleted_and_renamed_while_sampling(scene):
    kept, gone = cube("Kept", place=(-2, 0, 2)), cube("Gone", place=(2, 0, 2))
    ready(kept)
    scene.plaus.wanted = 2
    job = sampling.Job(session.prepare(bpy.context), session.place(scene))
    job.start()
    kept.name = "Renamed"
    bpy.data.objects.remove(gone)
    job.wait(120)
    assert not job.is_alive and not job.failed
    assert session.take(scene, job) == 2
    bpy.ops.plaus.bake()
    assert bpy.data.objects["Renamed"].animation_data.action is not None
    assert "1 objects; 1 were deleted" in scene.plaus.status


def test_stopped_runs_keep_what_they_have(scene):
    # More endings than are found in minutes.
    ready(cube(), within=0.1)
    scene.plaus.wanted, scene.plaus.longest = 500, 3600.0
    request = session.prepare(bpy.context)
    job = sampling.Job(request, session.place(scene))
    job.start()
    waited = threading.Event()
    while job.is_alive and job.found < 2:
        waited.wait(0.05)
    job.stop()
    job.wait(60)
    assert not job.is_alive and job.ending == "callback"
    assert session.take(scene, job) >= 2


def test_old_runs_are_deleted(monkeypatch, tmp_path):
    for name, age in (("old", 2 * session.OLD), ("new", 0.0)):
        (tmp_path / name).mkdir()
        os.utime(tmp_path / name, (time.time() - age,) * 2)
    monkeypatch.setattr(session, "runs", lambda: str(tmp_path))
    session.clear_old()
    assert os.listdir(tmp_path) == ["new"]


def test_nothing_found_in_time_is_said(scene):
    each = cube()
    make.select(each)
    bpy.ops.plaus.vary(level="LITTLE")
    make.wish("ENDS_AT", each, make.target("Far", (9.0, 9.0, 0.0), 0.01), within=0.01)
    scene.plaus.longest = 1.0
    refused("No ending was found in time")


def test_messages_name_objects(scene):
    each = cube("Cube.001")
    ready(each)
    each.rigid_body.mass = 1e9
    with pytest.raises(RuntimeError, match="Cube_001: density: "):
        bpy.ops.plaus.sample()
    assert os.path.isdir(session.place(scene)) and np.isfinite(scene.plaus.seed)
