"""Measures the extension: `python tests/measure.py` with Blender's Python module and the wheel. One table: what is
measured, what it should be at most, and what it is, in seconds by the clock.
"""

import sys
import time
from pathlib import Path

FOLDER = Path(__file__).resolve().parent.parent
sys.path[:0] = [str(FOLDER), str(FOLDER / "examples"), str(FOLDER / "tests")]

import bpy  # noqa: E402
import conftest  # noqa: E402, F401 - which registers the extension
import make  # noqa: E402
from plaus_blender import asked, ghosts, session  # noqa: E402



def row(words, most, found, unit="s"):
    """A line of the table."""
    verdict = "" if found <= most else "  short"
    print(f"{words:58} {most:8g} {found:10.3g} {unit}{verdict}", flush=True)


def timed(action):
    """How long something takes."""
    begun = time.perf_counter()
    action()
    return time.perf_counter() - begun


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


def sampled(scene):
    """Samples as with a window: seconds until an ending is listed and until all are, and the longest time for which one
    tick of the timer, with the ghosts drawn after it, held Blender up."""
    from test_modal import Operator, SimpleNamespace, Window

    window, operator = Window(scene), Operator()
    tick = SimpleNamespace(type="TIMER", value="NOTHING")
    begun, first, longest = time.perf_counter(), None, 0.0
    operator.invoke(window, None)
    made = {"PASS_THROUGH"}
    while made <= {"PASS_THROUGH", "RUNNING_MODAL"}:
        held = time.perf_counter()
        made = operator.modal(window, tick)
        if made == {"CANCELLED"}:
            raise SystemExit(scene.plaus.status)
        ghosts.poses(scene)
        asked.fingerprint(scene)
        longest = max(longest, time.perf_counter() - held)
        if first is None and len(scene.plaus.endings):
            first = time.perf_counter() - begun
        time.sleep(0.02)
    return first, time.perf_counter() - begun, longest


def main():
    """Measures."""
    print(f"{'Blender ' + bpy.app.version_string:58} {'at most':>8} {'found':>10}")
    crowd(100, 48)
    row("100 objects to a world", 2, timed(lambda: session.prepare(bpy.context)))
    make.dice()
    first, all_of_them, held = sampled(bpy.context.scene)
    row("the dice: first ending listed after Sample", 3, first)
    row("the dice: Blender held up at once", 0.05, held)
    make.kitchen()
    first, all_of_them, held = sampled(bpy.context.scene)
    row("the kitchen: five endings", 5, all_of_them)
    row("the kitchen: Blender held up at once", 0.05, held)
    scene = crowd(100, 48)
    scene.plaus.wanted = 4
    _, _, held = sampled(scene)
    row("100 objects sampled: Blender held up at once", 0.05, held)
    scene = crowd(30, 250)
    scene.plaus.wanted = 1
    bpy.ops.plaus.sample()
    row("30 objects baked over 250 frames", 1, timed(bpy.ops.plaus.bake))
    from test_examples import agrees

    worst = 0.0
    for example in make.EXAMPLES.values():
        example()
        bpy.context.scene.plaus.wanted = 1
        bpy.ops.plaus.sample()
        bpy.ops.plaus.bake()
        worst = max(worst, agrees(bpy.context.scene, session.of(bpy.context.scene), 0))
    row("baked against plaus replay, at frames and impacts", 1e-4, worst, "m")


if __name__ == "__main__":
    main()
