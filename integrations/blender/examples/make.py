"""Makes the example files: `python examples/make.py FOLDER` with Blender's Python module, or in Blender by
`blender --background --python examples/make.py -- FOLDER`. Each file is ready for Sample.
"""

import math
import os
import sys
from pathlib import Path

import bpy
import numpy as np
from mathutils import Vector

sys.path.insert(0, str(Path(__file__).resolve().parent.parent))


def start(frames):
    """An empty scene with Plaus, a camera and a light."""
    if not hasattr(bpy.types.Scene, "plaus"):
        import plaus_blender

        plaus_blender.register()
    bpy.ops.wm.read_factory_settings(use_empty=True)
    scene = bpy.context.scene
    scene.frame_start, scene.frame_end, scene.render.fps = 1, frames, 24
    bpy.ops.object.light_add(type="SUN", rotation=(0.6, 0.3, 0.0))
    bpy.context.object.data.energy = 3.0
    return scene


def look(eye, at):
    """A camera at a place that looks at another one."""
    way = Vector(at) - Vector(eye)
    bpy.ops.object.camera_add(location=eye, rotation=way.to_track_quat("-Z", "Y").to_euler())
    bpy.context.scene.camera = bpy.context.object


def body(name, kind="ACTIVE", shape="CONVEX_HULL", mass=1.0, friction=0.7, bounce=0.5, colour=(0.8, 0.8, 0.8)):
    """Makes the active object a rigid body."""
    each = bpy.context.object
    each.name = name
    bpy.ops.rigidbody.object_add(type=kind)
    rigid = each.rigid_body
    rigid.collision_shape, rigid.mass, rigid.friction, rigid.restitution = shape, mass, friction, bounce
    material = bpy.data.materials.new(name)
    material.diffuse_color = (*colour, 1.0)
    if bpy.app.version < (5, 0):
        material.use_nodes = True
    material.node_tree.nodes["Principled BSDF"].inputs["Base Color"].default_value = (*colour, 1.0)
    each.data.materials.append(material)
    return each


def floor(size):
    """A level floor."""
    bpy.ops.mesh.primitive_plane_add(size=size)
    return body("Floor", "PASSIVE", "MESH", colour=(0.35, 0.4, 0.45))


def can(name, place, radius=0.033, height=0.115, **keys):
    """A cylinder that stands on a place."""
    x, y, z = place
    bpy.ops.mesh.primitive_cylinder_add(vertices=32, radius=radius, depth=height, location=(x, y, z + height / 2))
    return body(name, **keys)


def ball(name, place, radius, **keys):
    """A ball around a place."""
    bpy.ops.mesh.primitive_uv_sphere_add(segments=32, ring_count=16, radius=radius, location=place)
    return body(name, **keys)


def block(name, place, size, turn=0.0, **keys):
    """A box around a place, turned about the vertical."""
    bpy.ops.mesh.primitive_cube_add(size=1.0, location=place, rotation=(0.0, 0.0, turn))
    bpy.context.object.scale = size
    return body(name, **keys)


def solid(name, corners, faces, place, **keys):
    """A mesh with its origin at a place."""
    mesh = bpy.data.meshes.new(name)
    mesh.from_pydata(corners, [], faces)
    each = bpy.data.objects.new(name, mesh)
    bpy.context.scene.collection.objects.link(each)
    each.location = place
    select(each)
    return body(name, **keys)


def select(*objects):
    """Selects objects; the last one becomes the active one."""
    bpy.ops.object.select_all(action="DESELECT")
    for each in objects:
        each.select_set(True)
        bpy.context.view_layer.objects.active = each


def target(name, place, within):
    """An empty to aim at."""
    empty = bpy.data.objects.new(name, None)
    empty.empty_display_type, empty.empty_display_size, empty.location = "SPHERE", within, place
    bpy.context.scene.collection.objects.link(empty)
    return empty


def wish(kind, thing, other=None, **keys):
    """Something that must happen."""
    made = bpy.context.scene.plaus.wishes.add()
    made.kind, made.thing, made.other = kind, thing, other
    for key, value in keys.items():
        setattr(made, key, value)


# Which of its axes points through which number of a die, from 1 to 6: opposite ones add up to 7.
AXES = ("z", "y", "x", "minus_x", "minus_y", "minus_z")
# Where the pips of each number are, as shares of the edge from the middle.
CORNERS = [(x, y) for x in (-0.27, 0.27) for y in (-0.27, 0.27)]
SIDES = [(-0.27, 0.0), (0.27, 0.0)]
PIPS = ([(0.0, 0.0)], CORNERS[::3], [(0.0, 0.0), *CORNERS[::3]], CORNERS, [(0.0, 0.0), *CORNERS], CORNERS + SIDES)


def pips(number, edge=48):
    """The picture of a side of a die, which the .blend file keeps."""
    image = bpy.data.images.new(f"Pips.{number}", edge, edge)
    shares = (np.arange(edge) + 0.5) / edge - 0.5
    far = np.min([np.hypot(shares - x, shares[:, None] - y) for x, y in PIPS[number - 1]], axis=0)
    white = np.clip((far - 0.1) * edge, 0.0, 1.0)[:, :, None]
    ivory, ink = np.array((0.93, 0.9, 0.82, 1.0)), np.array((0.05, 0.05, 0.06, 1.0))
    image.pixels.foreach_set((white * ivory + (1 - white) * ink).astype(np.float32).ravel())
    image.pack()
    return image


def painted(name, image):
    """A material with a picture on it."""
    made = bpy.data.materials.new(name)
    if bpy.app.version < (5, 0):
        made.use_nodes = True
    texture = made.node_tree.nodes.new("ShaderNodeTexImage")
    texture.image = image
    base = made.node_tree.nodes["Principled BSDF"].inputs["Base Color"]
    made.node_tree.links.new(texture.outputs["Color"], base)
    return made


def numbered(die):
    """Paints numbers onto the sides of a cube."""
    mesh = die.data
    corners = ((0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0))
    for side in mesh.polygons:
        axis = max(range(3), key=lambda at: abs(side.normal[at]))
        number = AXES.index(("" if side.normal[axis] > 0 else "minus_") + "xyz"[axis]) + 1
        known = bpy.data.materials.get(f"Side.{number}")
        mesh.materials.append(known or painted(f"Side.{number}", pips(number)))
        side.material_index = len(mesh.materials) - 1
        for loop, corner in zip(side.loop_indices, corners):
            mesh.uv_layers.active.data[loop].uv = corner


def dice():
    """Six dice, thrown so that 1 to 6 lie in a row."""
    scene = start(72)
    floor(2.0)
    for number in range(6):
        bpy.ops.mesh.primitive_cube_add(size=0.02, location=(-0.25, 0.06 * (number - 2.5), 0.1))
        die = body(f"Die.{number + 1:03}", mass=0.01, colour=(0.93, 0.9, 0.82))
        numbered(die)
        die.plaus.thrown = (1.0, 0.0, 0.0)
        select(die)
        bpy.ops.plaus.vary(level="LOT", position=False)
        die.plaus.position = "SOME"
        spot = target(f"Spot.{number + 1}", (0.0, 0.06 * (number - 2.5), 0.0), 0.02)
        wish("ENDS_AT", die, spot, within=0.02)
        wish("SIDE_UP", die, axis=AXES[number])
    scene.plaus.wanted = 4
    look((0.42, -0.2, 0.4), (-0.08, 0.0, 0.02))


def cans():
    """A ball knocks the left one of three cans over, and leaves another one standing."""
    scene = start(72)
    floor(4.0)
    made = [
        can(f"Can.{n + 1}", (0.0, 0.1 * (n - 1), 0.0), mass=0.1, bounce=0.3, colour=(0.2, 0.5, 0.3 + 0.2 * n))
        for n in range(3)
    ]
    thrown = ball("Ball", (-0.8, 0.0, 0.2), 0.035, mass=0.15, colour=(0.9, 0.6, 0.1))
    thrown.plaus.thrown = (4.0, 0.0, 0.0)
    select(thrown)
    bpy.ops.plaus.vary(level="SOME", spin=False)
    wish("FALLS", made[0])
    wish("FALLS", made[1])
    wish("STANDS", made[2])
    scene.plaus.wanted = 6
    look((-0.7, -0.9, 0.5), (0.0, 0.0, 0.05))


def kick():
    """An animated foot kicks a ball, which knocks the middle one of three cans over and leaves the others standing."""
    scene = start(72)
    floor(6.0)
    made = [
        can(f"Can.{n + 1}", (1.0, 0.2 * (n - 1), 0.0), mass=0.1, bounce=0.3, colour=(0.7, 0.2 + 0.2 * n, 0.2))
        for n in range(3)
    ]
    kicked = ball("Ball", (0.0, 0.0, 0.05), 0.05, mass=0.2, bounce=0.6, colour=(0.9, 0.9, 0.9))
    foot = block("Foot", (-0.4, 0.0, 0.06), (0.2, 0.08, 0.08), bounce=0.6, colour=(0.25, 0.2, 0.15))
    foot.rigid_body.kinematic = True
    # A leg to be seen, which nothing collides with.
    bpy.ops.mesh.primitive_cylinder_add(vertices=32, radius=0.045, depth=0.3, location=(-0.46, 0.0, 0.25))
    leg = bpy.context.object
    leg.name, leg.parent, leg.matrix_parent_inverse = "Leg", foot, foot.matrix_basis.inverted()
    leg.data.materials.append(foot.active_material)
    for frame, x in ((1, -0.4), (12, -0.4), (18, -0.05), (30, -0.3)):
        foot.location.x = x
        foot.keyframe_insert("location", frame=frame)
    scene.frame_set(1)
    select(kicked)
    bpy.ops.plaus.vary(level="SOME", velocity=False, spin=False)
    wish("FALLS", made[1])
    wish("STANDS", made[0])
    wish("STANDS", made[2])
    scene.plaus.wanted = 4
    look((-0.7, -2.0, 1.15), (0.35, 0.0, 0.0))


def kitchen():
    """On a kitchen table, a ball knocks the left one of three cans over, and only that, and ends near the cup."""
    scene = start(120)
    floor(8.0)
    wood = {"friction": 0.9, "bounce": 0.4, "colour": (0.5, 0.35, 0.2)}
    block("Table", (0.0, 0.0, 0.73), (1.6, 1.0, 0.04), kind="PASSIVE", shape="BOX", **wood)
    tin = {"mass": 0.15, "friction": 0.9, "bounce": 0.3, "colour": (0.8, 0.3, 0.2)}
    places = {"Can.left": 0.15, "Can.middle": 0.0, "Can.right": -0.15}
    made = [can(name, (0.1, y, 0.75), **tin) for name, y in places.items()]
    made.append(can("Cup", (0.3, 0.25, 0.75), 0.04, 0.09, **{**tin, "colour": (0.85, 0.85, 0.8)}))
    thrown = ball("Ball", (-0.5, 0.1, 0.81), 0.06, mass=0.2, bounce=0.5, colour=(0.9, 0.6, 0.1))
    # Felt, which soon comes to rest; thrown fast enough to tip a can.
    thrown.rigid_body.linear_damping = thrown.rigid_body.angular_damping = 0.8
    thrown.plaus.thrown = (4.0, 0.0, 0.0)
    select(thrown)
    bpy.ops.plaus.vary(level="SOME", spin=False)
    wish("FALLS", made[0])
    for other in made[1:]:
        wish("STANDS", other)
    wish("ENDS_AT", thrown, target("Near the cup", (0.3, 0.25, 0.75), 0.2), within=0.2)
    scene.plaus.wanted = 5
    look((-0.9, -1.1, 1.6), (0.05, 0.05, 0.75))


def dominoes():
    """A ball rolls into a row of dominoes at a marker; the row falls as far as the camera, where the last one stays."""
    scene = start(96)
    floor(4.0)
    stone = {"mass": 0.01, "friction": 0.6, "bounce": 0.3, "colour": (0.9, 0.9, 0.8)}
    made = [
        block(f"Domino.{n + 1:02}", (0.025 * n, 0.00125 * n * n, 0.024), (0.0075, 0.024, 0.048), 0.1 * n, **stone)
        for n in range(10)
    ]
    # The gap before the last one may be just too wide.
    select(made[-1])
    bpy.ops.plaus.vary(level="SOME", velocity=False, spin=False)
    rolled = ball("Ball", (-0.4, 0.0, 0.02), 0.02, mass=0.05, bounce=0.3, colour=(0.8, 0.2, 0.2))
    rolled.plaus.thrown = (0.6, 0.0, 0.0)
    select(rolled)
    bpy.ops.plaus.vary(level="SOME", spin=False, rotation=False)
    scene.timeline_markers.new("Start", frame=17)
    wish("HITS", rolled, made[0], marker="Start", frames=2.0)
    wish("FALLS", made[-2])
    wish("STANDS", made[-1])
    scene.plaus.wanted = 6
    look((0.42, 0.2, 0.13), (0.09, 0.03, 0.01))


def vase():
    """A vase in shards falls beside a glass and spares it."""
    scene = start(72)
    floor(4.0)
    glass = can("Glass", (0.22, 0.0, 0.0), 0.035, 0.12, mass=0.2, friction=0.5, bounce=0.2, colour=(0.5, 0.7, 0.9))
    shards, around, rings = [], 6, [(0.04, 0.0), (0.065, 0.09), (0.035, 0.16)]
    clay = {"mass": 0.03, "bounce": 0.2, "colour": (0.8, 0.5, 0.3)}
    for ring, ((low, under), (high, above)) in enumerate(zip(rings, rings[1:])):
        for turn in range(around):
            # A shard is the piece of a thick wall between two angles, with a gap to its neighbours.
            sides = [(turn + share) * 2 * math.pi / around for share in (0.03, 0.97)]
            corners = [
                ((radius - thick) * math.cos(angle), (radius - thick) * math.sin(angle), height)
                for radius, height in ((low, under + 0.001), (high, above - 0.001))
                for thick in (0.0, 0.008)
                for angle in sides
            ]
            faces = [(0, 1, 5, 4), (2, 6, 7, 3), (0, 4, 6, 2), (1, 3, 7, 5), (0, 2, 3, 1), (4, 5, 7, 6)]
            x, y, z = (sum(corner[axis] for corner in corners) / 8 for axis in range(3))
            corners = [(a - x, b - y, c - z) for a, b, c in corners]
            shards.append(solid(f"Shard.{len(shards) + 1:02}", corners, faces, (x, y, z + 0.15), **clay))
    for shard in shards:
        shard.plaus.thrown = (0.3, 0.0, 0.0)
        wish("NEVER", shard, glass)
    select(*shards)
    bpy.ops.plaus.vary(level="SOME", position=False, rotation=False)
    wish("STANDS", glass)
    scene.plaus.wanted = 4
    look((0.55, -0.85, 0.5), (0.06, 0.0, 0.09))


def bowl():
    """A monkey's head and a ball are thrown into a bowl."""
    scene = start(96)
    floor(4.0)
    # A bowl as a surface of revolution: inside and outside, so that it is solid.
    outline = [(0.0, 0.0), (0.12, 0.0), (0.25, 0.12), (0.24, 0.13), (0.115, 0.02), (0.0, 0.02)]
    corners, faces, around = [], [], 32
    for radius, height in outline:
        corners += [
            (radius * math.cos(2 * math.pi * turn / around), radius * math.sin(2 * math.pi * turn / around), height)
            for turn in range(around)
        ]
    for ring in range(len(outline) - 1):
        for turn in range(around):
            here, there = ring * around, (ring + 1) * around
            after = (turn + 1) % around
            faces.append((here + turn, here + after, there + after, there + turn))
    solid("Bowl", corners, faces, (0.5, 0.0, 0.0), kind="PASSIVE", shape="MESH", colour=(0.3, 0.5, 0.7))
    # The box around the bowl has room below its rim, so a box within it says what is inside.
    inside = target("Inside", (0.5, 0.0, 0.12), 0.1)
    inside.empty_display_type = "CUBE"
    bpy.ops.mesh.primitive_monkey_add(size=0.1, location=(-0.5, 0.0, 0.3))
    head = body("Suzanne", mass=0.3, bounce=0.4, colour=(0.6, 0.4, 0.2))
    marble = ball("Ball", (-0.5, 0.15, 0.3), 0.03, mass=0.1, bounce=0.6, colour=(0.8, 0.2, 0.2))
    for one in (head, marble):
        one.plaus.thrown = (1.8, 0.0, 1.5)
    select(head, marble)
    bpy.ops.plaus.vary(level="SOME")
    wish("ENDS_INSIDE", head, inside)
    wish("ENDS_INSIDE", marble, inside)
    scene.plaus.wanted = 4
    look((-0.5, -1.4, 0.9), (0.2, 0.0, 0.1))


EXAMPLES = {
    "dice": dice, "cans": cans, "kick": kick, "dominoes": dominoes, "vase": vase, "bowl": bowl, "kitchen": kitchen
}


def main():
    """Writes all of them."""
    words = sys.argv[sys.argv.index("--") + 1 :] if "--" in sys.argv else sys.argv[1:]
    folder = words[0] if words else "."
    os.makedirs(folder, exist_ok=True)
    for name, make in EXAMPLES.items():
        make()
        path = os.path.join(os.path.abspath(folder), f"{name}.blend")
        bpy.ops.wm.save_as_mainfile(filepath=path, compress=True)
        print(path)


if __name__ == "__main__":
    main()
