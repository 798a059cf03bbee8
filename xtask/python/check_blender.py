#!/usr/bin/env python3
"""Imports GLB and USDA files into Blender (PyPI's bpy), and compares what it plays at random times between keys
with the poses that `plaus export --format poses` writes.

Makes a virtual environment of its own. bpy installs on only one version of Python; exit code 77 on others.
Exit codes: 0 sound, 1 not, 77 the packages could not be installed.
"""

import argparse
import math
import os
import random
import subprocess
import sys
from pathlib import Path

from environment import NO_REGISTRY, environment
from truth import Truth, angle

# Blender 5.0 is built for Python 3.11, and bpy with it. The extension is tested in the same environment.
PYTEST = "pytest==9.2.0"
REQUIREMENTS = ["bpy==5.0.1", PYTEST]
PYTHON = (3, 11)

# Largest allowed error of a body's place and orientation, in m and degrees.
FAR, TURNED = 5e-4, 0.1
# Number of random times at which all bodies are examined.
TIMES = 200


def check(path, poses):
    """What is wrong with one file."""
    import bpy

    bpy.ops.wm.read_factory_settings(use_empty=True)
    scene = bpy.context.scene
    if path.endswith(".glb"):
        bpy.ops.import_scene.gltf(filepath=path)
    else:
        bpy.ops.wm.usd_import(filepath=path)
    truth, generator = Truth(poses), random.Random(1)
    rate = scene.render.fps / scene.render.fps_base
    # A body with one mesh below it is one object, which has the mesh's name.
    found = {name: [end for end in ("", "_shape") if name + end in bpy.data.objects] for name in truth.bodies}
    objects = {name: bpy.data.objects[name + ends[0]] for name, ends in found.items() if ends}
    wrong = [f"no object {name}" for name in truth.bodies if name not in objects]
    upright = of_gltf if path.endswith(".glb") else of_usd
    worst, turned, crowded = 0.0, 0.0, 0
    for _ in range(TIMES):
        time = generator.uniform(0.0, truth.end)
        frame = time * rate
        scene.frame_set(int(frame), subframe=frame - int(frame))
        graph = bpy.context.evaluated_depsgraph_get()
        for name, thing in objects.items():
            if truth.is_crowded(name, time):
                crowded += 1
                continue
            matrix = thing.evaluated_get(graph).matrix_world
            (x, y, z), turn = truth.at(name, time)
            # y is up in the table, z in Blender.
            worst = max(worst, math.dist(matrix.translation, (x, -z, y)))
            turned = max(turned, angle(matrix.to_quaternion(), upright(turn)))
    if not objects or crowded > TIMES * len(objects) // 20 or worst > FAR or turned > TURNED:
        wrong.append(f"off by {worst * 1e3:.3f} mm and {turned:.3f} degrees")
    materials = {slot.material for thing in bpy.data.objects for slot in thing.material_slots if slot.material}
    for material in materials:
        nodes = material.node_tree.nodes if material.node_tree else []
        colours = [tuple(node.inputs["Base Color"].default_value)[:3] for node in nodes if node.type == "BSDF_PRINCIPLED"]
        if not colours:
            wrong.append(f"{material.name} has no colour")
    bare = [thing.name for thing in bpy.data.objects if thing.type == "MESH" and not thing.material_slots]
    wrong += [f"{name} has no material" for name in bare]
    print(
        f"{path}: {len(objects)} bodies, {TIMES} times, off by at most {worst * 1e3:.3f} mm and {turned:.3f} degrees "
        f"({crowded} of {TIMES * len(objects)} poses lie between impacts less than 0.5 ms apart); "
        f"{len(materials)} materials, {len(bpy.data.actions)} actions",
        flush=True,
    )
    return wrong


def of_gltf(turn):
    """The orientation that Blender's importer gives: it turns the axes of the mesh as well."""
    w, x, y, z = turn
    return (w, x, -z, y)


def of_usd(turn):
    """The same if the whole layer gets a quarter turn about x."""
    w, x, y, z = turn
    return (w - x, w + x, y - z, y + z)


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--venv", type=Path, help="folder of the virtual environment, made where it is missing")
    parser.add_argument("files", nargs="+", help="GLB or USDA, its poses as CSV, …")
    arguments = parser.parse_args()
    if arguments.venv:
        if sys.version_info[:2] != PYTHON:
            print(f"bpy is for Python {PYTHON[0]}.{PYTHON[1]}, this is {sys.version.split()[0]}", flush=True)
            return NO_REGISTRY
        python = environment(arguments.venv, REQUIREMENTS)
        return subprocess.run([python, __file__, *map(os.fspath, arguments.files)]).returncode
    pairs = zip(arguments.files[::2], arguments.files[1::2])
    wrong = [f"{path}: {message}" for path, poses in pairs for message in check(path, poses)]
    print("\n".join(["", *wrong]))
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
