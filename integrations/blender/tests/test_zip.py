"""From the zip to a baked ending, as a user gets there: installed by Blender, with the wheel that is in it."""

import ast
import base64
import csv
import hashlib
import io
import os
import subprocess
import sys
import tomllib
import zipfile

import pytest

ZIP = os.environ.get("PLAUS_ZIP", "")
# What an animator clicks, after a cube above a plane was made: each button is looked for on the panel as it is then.
SCRIPT = """
import glob, os, sys, bpy

bpy.ops.wm.read_factory_settings(use_empty=True)
bpy.ops.mesh.primitive_plane_add(size=20)
bpy.ops.rigidbody.object_add(type="PASSIVE")
bpy.ops.mesh.primitive_cube_add(size=0.2, location=(0, 0, 1))
bpy.ops.rigidbody.object_add()
cube, scene = bpy.context.object, bpy.context.scene
scene.frame_end = 48
sys.path.insert(0, sys.argv[2])
from layout import press

clicks, keys = ["drop the zip onto the window", "OK"], []
assert bpy.ops.extensions.package_install_files(
    filepath=sys.argv[1], repo="user_default", enable_on_install=True) == {"FINISHED"}
# The tests' environment has the wheel too; what counts here is the one that Blender has unpacked.
[own] = glob.glob(os.path.join(bpy.utils.user_resource("EXTENSIONS"), ".local", "lib", "*", "site-packages"))
sys.path.insert(0, own)
import plaus
assert plaus.__file__.startswith(own), plaus.__file__
keys.append("N")
clicks.append("the tab Plaus")
press(clicks, "Vary Selected")
press(clicks, "Add for Selected", "This side up")
press(clicks, "Sample")
press(clicks, "Bake")
assert cube.animation_data.action is not None and scene.plaus.endings[0].baked
print("clicks:", len(clicks), "keys:", len(keys))
runs = bpy.utils.extension_path_user("bl_ext.user_default.plaus", path="runs")
assert os.listdir(runs), "runs are in the extension's own folder"
bpy.ops.preferences.addon_disable(module="bl_ext.user_default.plaus")
assert not hasattr(bpy.types.Scene, "plaus")
"""


@pytest.mark.skipif(not ZIP, reason="PLAUS_ZIP names no zip: cargo xtask blender --extension makes one")
def test_from_the_zip_to_a_baked_ending(tmp_path):
    around = {**os.environ, "BLENDER_USER_RESOURCES": str(tmp_path), "PYTHONPATH": ""}
    words = [sys.executable, "-c", SCRIPT, ZIP, os.path.dirname(os.path.abspath(__file__))]
    made = subprocess.run(words, cwd=tmp_path, env=around, capture_output=True, text=True, timeout=300)
    assert made.returncode == 0, made.stdout + made.stderr
    assert "clicks: 8 keys: 1" in made.stdout


@pytest.mark.skipif(not ZIP, reason="PLAUS_ZIP names no zip: cargo xtask blender --extension makes one")
def test_the_zip_keeps_blenders_rules():
    with zipfile.ZipFile(ZIP) as packed:
        manifest = tomllib.loads(packed.read("blender_manifest.toml").decode())
        assert manifest["license"] == ["SPDX:GPL-3.0-or-later"] and manifest["blender_version_min"] == "4.2.0"
        assert b"GNU GENERAL PUBLIC LICENSE" in packed.read("LICENSE") and manifest["permissions"].keys() == {"files"}
        [wheel] = manifest["wheels"]
        sources = [name for name in packed.namelist() if name.endswith(".py")]
        assert set(packed.namelist()) == {"blender_manifest.toml", "LICENSE", wheel.removeprefix("./"), *sources}
        used = set()
        for name in sources:
            for each in ast.walk(ast.parse(packed.read(name))):
                names = [one.name for one in each.names] if isinstance(each, ast.Import) else []
                used |= {name.split(".")[0] for name in [*names, getattr(each, "module", None) or ""]}
        assert not used & {"socket", "urllib", "http", "requests", "ssl", "subprocess", "multiprocessing"}
        inner = packed.read(wheel.removeprefix("./"))
    # Nothing in the wheel was changed since it was built: its own list says what is in it.
    with zipfile.ZipFile(io.BytesIO(inner)) as built:
        [record] = [name for name in built.namelist() if name.endswith(".dist-info/RECORD")]
        rows = {path: digest for path, digest, _ in csv.reader(built.read(record).decode().splitlines())}
        assert rows.keys() == set(built.namelist())
        for path in rows.keys() - {record}:
            digest = base64.urlsafe_b64encode(hashlib.sha256(built.read(path)).digest()).decode().rstrip("=")
            assert rows[path] == f"sha256={digest}", path
