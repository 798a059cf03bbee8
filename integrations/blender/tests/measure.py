"""Measures the extension: `python tests/measure.py` with Blender's Python module and the wheel. Seconds by the clock,
and of the processor in brackets, all threads together.
"""

import sys
import time
from pathlib import Path

FOLDER = Path(__file__).resolve().parent.parent
sys.path[:0] = [str(FOLDER), str(FOLDER / "examples")]

import bpy  # noqa: E402
import make  # noqa: E402

import plaus_blender  # noqa: E402
from plaus_blender import sampling, session  # noqa: E402


def timed(words, action):
    """Says how long something takes."""
    clock, processor = time.perf_counter(), time.process_time()
    made = action()
    print(f"{words}: {time.perf_counter() - clock:.2f} s ({time.process_time() - processor:.2f} s)", flush=True)
    return made


def crowd(count, frames):
    """Cubes in the air above a floor."""
    scene = make.start(frames)
    make.floor(60.0)
    for number in range(count):
        bpy.ops.mesh.primitive_cube_add(size=0.3, location=(number % 10, number // 10, 1.0))
        make.body(f"Cube.{number}")
    make.select(*(each for each in scene.objects if each.name.startswith("Cube")))
    bpy.ops.plaus.vary(level="SOME")
    make.wish("ENDS_AT", bpy.data.objects["Cube.0"], make.target("Spot", (0, 0, 0), 2.0), within=2.0)
    return scene


def first_ending():
    """Waits for the first ending of the dice."""
    job = sampling.Job(session.prepare(bpy.context), session.place(bpy.context.scene))
    job.start()
    while job.is_alive and job.found < 1:
        time.sleep(0.01)
    job.stop()
    job.wait()


def main():
    """Measures."""
    plaus_blender.register()
    crowd(100, 48)
    timed("100 objects to a world", lambda: session.prepare(bpy.context))
    make.dice()
    timed("the first ending of the dice", first_ending)
    scene = crowd(30, 250)
    scene.plaus.wanted = 1
    timed("the first ending of 30 cubes", bpy.ops.plaus.sample)
    timed("30 objects baked over 250 frames", bpy.ops.plaus.bake)


if __name__ == "__main__":
    main()
