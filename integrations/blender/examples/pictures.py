"""Makes the pictures of docs/blender.md: `python examples/pictures.py FOLDER` with Blender's Python module and the
wheel. They show what the viewport and the list of endings show; the window itself needs a screen.
"""

import sys
from pathlib import Path

FOLDER = Path(__file__).resolve().parent
sys.path[:0] = [str(FOLDER), str(FOLDER.parent)]

import bpy  # noqa: E402
import make  # noqa: E402
import numpy as np  # noqa: E402

import plaus_blender  # noqa: E402
from plaus_blender import ghosts, session  # noqa: E402


def rendered(path, frame, share=100, samples=24):
    """The scene at a frame with the ghosts of the viewport, into a WebP file, at a share in % of its size."""
    scene = bpy.context.scene
    scene.frame_set(frame)
    for number, (each, matrix, colour) in enumerate(ghosts.poses(scene)):
        ghost = bpy.data.objects.new(f"Ghost.{number}", each.data.copy())
        scene.collection.objects.link(ghost)
        ghost.matrix_world = matrix
        ghost.data.materials.clear()
        ghost.data.materials.append(_see_through(colour))
    scene.render.engine, scene.cycles.device, scene.cycles.samples = "CYCLES", "CPU", samples
    scene.render.resolution_percentage = share
    scene.cycles.use_denoising, scene.cycles.max_bounces, scene.cycles.transparent_max_bounces = False, 2, 32
    scene.render.resolution_x, scene.render.resolution_y = 480, 300
    scene.view_settings.view_transform = "Standard"
    scene.world = bpy.data.worlds.new("Sky")
    if not scene.world.node_tree:
        scene.world.use_nodes = True
    scene.world.node_tree.nodes["Background"].inputs[0].default_value = (0.3, 0.35, 0.42, 1.0)
    scene.render.image_settings.file_format, scene.render.image_settings.quality = "WEBP", 80
    scene.render.filepath = str(path)
    bpy.ops.render.render(write_still=True)


def _see_through(colour):
    made = bpy.data.materials.new("Ghost")
    if not made.node_tree:
        made.use_nodes = True
    shader = made.node_tree.nodes["Principled BSDF"]
    shader.inputs["Base Color"].default_value = (*colour[:3], 1.0)
    shader.inputs["Alpha"].default_value = max(0.25, colour[3])
    return made


def listed(path):
    """The small pictures of the endings, side by side."""
    sheet = np.concatenate([each.picture for each in session.of(bpy.context.scene).endings], axis=1)
    image = bpy.data.images.new("Endings", sheet.shape[1], sheet.shape[0])
    image.pixels[:] = sheet.ravel().tolist()
    image.filepath_raw, image.file_format = str(path), "PNG"
    image.save()


def main():
    """Makes them."""
    folder = Path(sys.argv[1] if len(sys.argv) > 1 else ".")
    plaus_blender.register()
    for name in ("cans", "dice", "dominoes", "kick", "vase"):
        make.EXAMPLES[name]()
        scene = bpy.context.scene
        scene.plaus.wanted = 4
        bpy.ops.plaus.sample()
        if name == "cans":
            scene.plaus.ending = 1
            listed(folder / "blender-endings.png")
            rendered(folder / "blender-ghosts.webp", 30)
        else:
            bpy.ops.plaus.bake()
            rendered(folder / f"blender-{name}.webp", scene.frame_end)


if __name__ == "__main__":
    main()
