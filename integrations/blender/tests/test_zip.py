"""From the zip to a baked ending, as a user gets there: installed by Blender, with the wheel that is in it."""

import os
import subprocess
import sys

import pytest

ZIP = os.environ.get("PLAUS_ZIP", "")
# What an animator clicks or types, one line each, after a cube above a plane was made.
SCRIPT = """
import glob, os, sys, bpy

bpy.ops.wm.read_factory_settings(use_empty=True)
clicks = []

def click(words, action):
    clicks.append(words)
    assert action() in ({"FINISHED"}, None), words

click("install", lambda: bpy.ops.extensions.package_install_files(
    filepath=sys.argv[1], repo="user_default", enable_on_install=True))
# The tests' environment has the wheel too; what counts here is the one that Blender has unpacked.
[own] = glob.glob(os.path.join(bpy.utils.user_resource("EXTENSIONS"), ".local", "lib", "*", "site-packages"))
sys.path.insert(0, own)
import plaus
assert plaus.__file__.startswith(own), plaus.__file__
bpy.ops.mesh.primitive_plane_add(size=20)
bpy.ops.rigidbody.object_add(type="PASSIVE")
bpy.ops.mesh.primitive_cube_add(size=0.2, location=(0, 0, 1))
bpy.ops.rigidbody.object_add()
cube, scene = bpy.context.object, bpy.context.scene
scene.frame_end = 48
click("vary", lambda: bpy.ops.plaus.vary())
click("this side up", lambda: bpy.ops.plaus.wish_add(kind="SIDE_UP"))
click("ends at", lambda: bpy.ops.plaus.wish_add(kind="ENDS_AT"))
click("drag the empty", lambda: setattr(bpy.data.objects["Cube target"], "location", (0.1, 0, 0)))
scene.plaus.wanted = 2
click("sample", lambda: bpy.ops.plaus.sample())
click("bake", lambda: bpy.ops.plaus.bake())
assert cube.animation_data.action is not None and scene.plaus.endings[0].baked
runs = bpy.utils.extension_path_user("bl_ext.user_default.plaus", path="runs")
assert os.listdir(runs), "runs are in the extension's own folder"
print("clicks:", len(clicks))
bpy.ops.preferences.addon_disable(module="bl_ext.user_default.plaus")
assert not hasattr(bpy.types.Scene, "plaus")
"""


@pytest.mark.skipif(not ZIP, reason="PLAUS_ZIP names no zip: cargo xtask blender --extension makes one")
def test_from_the_zip_to_a_baked_ending(tmp_path):
    around = {**os.environ, "BLENDER_USER_RESOURCES": str(tmp_path), "PYTHONPATH": ""}
    made = subprocess.run(
        [sys.executable, "-c", SCRIPT, ZIP], cwd=tmp_path, env=around, capture_output=True, text=True, timeout=300
    )
    assert made.returncode == 0, made.stdout + made.stderr
    assert "clicks: 7" in made.stdout
