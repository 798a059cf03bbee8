"""Makes the example files: `python examples/make.py FOLDER` with Blender's Python module, or in Blender by
`blender --background --python examples/make.py -- FOLDER`. Each file is ready for Sample.
"""

import math
import os
import sys
from pathlib import Path

import bpy

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
    from mathutils import Vector

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


def dice():
    """Six dice with given sides up on given places."""
    scene = start(72)
    floor(2.0)
    for number in range(6):
        bpy.ops.mesh.primitive_cube_add(size=0.02, location=(-0.25, 0.06 * (number - 2.5), 0.1))
        die = body(f"Die.{number + 1:03}", mass=0.01, colour=(0.8, 0.1 + 0.12 * number, 0.1))
        die.plaus.thrown = (1.0, 0.0, 0.0)
        select(die)
        bpy.ops.plaus.vary(level="LOT", position=False)
        die.plaus.position = "SOME"
        spot = target(f"Spot.{number + 1}", (0.0, 0.06 * (number - 2.5), 0.0), 0.02)
        wish("ENDS_AT", die, spot, within=0.02)
        wish("SIDE_UP", die, axis=("z", "y", "x", "minus_x", "minus_y", "minus_z")[number])
    scene.plaus.wanted = 4
    look((0.3, -0.6, 0.45), (-0.05, 0.0, 0.02))


def cans():
    """A ball knocks the left one of three cans over, and leaves another one standing."""
    scene = start(72)
    floor(4.0)
    made = []
    for number in range(3):
        bpy.ops.mesh.primitive_cylinder_add(
            vertices=32, radius=0.033, depth=0.115, location=(0.0, 0.1 * (number - 1), 0.0575)
        )
        made.append(body(f"Can.{number + 1}", mass=0.1, bounce=0.3, colour=(0.2, 0.5, 0.3 + 0.2 * number)))
    bpy.ops.mesh.primitive_uv_sphere_add(segments=32, ring_count=16, radius=0.035, location=(-0.8, 0.0, 0.2))
    ball = body("Ball", mass=0.15, colour=(0.9, 0.6, 0.1))
    ball.plaus.thrown = (4.0, 0.0, 0.0)
    select(ball)
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
    made = []
    for number in range(3):
        bpy.ops.mesh.primitive_cylinder_add(
            vertices=32, radius=0.033, depth=0.115, location=(1.0, 0.2 * (number - 1), 0.0575)
        )
        made.append(body(f"Can.{number + 1}", mass=0.1, bounce=0.3, colour=(0.7, 0.2 + 0.2 * number, 0.2)))
    bpy.ops.mesh.primitive_uv_sphere_add(segments=32, ring_count=16, radius=0.05, location=(0.0, 0.0, 0.05))
    ball = body("Ball", mass=0.2, bounce=0.6, colour=(0.9, 0.9, 0.9))
    bpy.ops.mesh.primitive_cube_add(size=1.0, location=(-0.4, 0.0, 0.06))
    bpy.context.object.scale = (0.2, 0.08, 0.08)
    foot = body("Foot", bounce=0.6, colour=(0.25, 0.2, 0.15))
    foot.rigid_body.kinematic = True
    for frame, x in ((1, -0.4), (12, -0.4), (18, -0.05), (30, -0.3)):
        foot.location.x = x
        foot.keyframe_insert("location", frame=frame)
    scene.frame_set(1)
    select(ball)
    bpy.ops.plaus.vary(level="SOME", velocity=False, spin=False)
    wish("FALLS", made[1])
    wish("STANDS", made[0])
    wish("STANDS", made[2])
    scene.plaus.wanted = 4
    look((-0.5, -1.3, 0.6), (0.6, 0.0, 0.05))


def kitchen():
    """On a kitchen table, a ball knocks the left one of three cans over, and only that, and ends near the cup."""
    scene = start(120)
    floor(8.0)
    bpy.ops.mesh.primitive_cube_add(size=1.0, location=(0.0, 0.0, 0.73))
    bpy.context.object.scale = (1.6, 1.0, 0.04)
    body("Table", "PASSIVE", "BOX", friction=0.9, bounce=0.4, colour=(0.5, 0.35, 0.2))
    made = []
    for name, x, y, radius, height in (
        ("Can.left", 0.1, 0.15, 0.033, 0.115), ("Can.middle", 0.1, 0.0, 0.033, 0.115),
        ("Can.right", 0.1, -0.15, 0.033, 0.115), ("Cup", 0.3, 0.25, 0.04, 0.09),
    ):
        at = (x, y, 0.75 + height / 2)
        bpy.ops.mesh.primitive_cylinder_add(vertices=32, radius=radius, depth=height, location=at)
        made.append(body(name, mass=0.15, friction=0.9, bounce=0.3, colour=(0.8, 0.3, 0.2)))
    bpy.ops.mesh.primitive_uv_sphere_add(segments=32, ring_count=16, radius=0.06, location=(-0.5, 0.1, 0.81))
    ball = body("Ball", mass=0.2, bounce=0.5, colour=(0.9, 0.6, 0.1))
    # Felt, which soon comes to rest; thrown fast enough to tip a can.
    ball.rigid_body.linear_damping = ball.rigid_body.angular_damping = 0.8
    ball.plaus.thrown = (4.0, 0.0, 0.0)
    select(ball)
    bpy.ops.plaus.vary(level="SOME", spin=False)
    wish("FALLS", made[0])
    for other in made[1:]:
        wish("STANDS", other)
    wish("ENDS_AT", ball, target("Near the cup", (0.3, 0.25, 0.75), 0.2), within=0.2)
    scene.plaus.wanted = 5
    look((-0.9, -1.1, 1.6), (0.05, 0.05, 0.75))


def dominoes():
    """A ball rolls into a row of dominoes at a marker; the row falls as far as the camera, where the last one stays."""
    scene = start(96)
    floor(4.0)
    made = []
    for number in range(10):
        bpy.ops.mesh.primitive_cube_add(
            size=1.0, location=(0.025 * number, 0.00125 * number * number, 0.024), rotation=(0, 0, 0.1 * number)
        )
        bpy.context.object.scale = (0.0075, 0.024, 0.048)
        made.append(body(f"Domino.{number + 1:02}", mass=0.01, friction=0.6, bounce=0.3, colour=(0.9, 0.9, 0.8)))
    # The gap before the last one may be just too wide.
    select(made[-1])
    bpy.ops.plaus.vary(level="SOME", velocity=False, spin=False)
    bpy.ops.mesh.primitive_uv_sphere_add(segments=32, ring_count=16, radius=0.02, location=(-0.4, 0.0, 0.02))
    ball = body("Ball", mass=0.05, bounce=0.3, colour=(0.8, 0.2, 0.2))
    ball.plaus.thrown = (0.6, 0.0, 0.0)
    select(ball)
    bpy.ops.plaus.vary(level="SOME", spin=False, rotation=False)
    scene.timeline_markers.new("Start", frame=17)
    wish("HITS", ball, made[0], marker="Start", frames=2.0)
    wish("FALLS", made[-2])
    wish("STANDS", made[-1])
    scene.plaus.wanted = 6
    look((0.36, 0.16, 0.1), (0.12, 0.03, 0.02))


def vase():
    """A vase in shards falls beside a glass and spares it."""
    scene = start(72)
    floor(4.0)
    bpy.ops.mesh.primitive_cylinder_add(vertices=32, radius=0.035, depth=0.12, location=(0.22, 0.0, 0.06))
    glass = body("Glass", mass=0.2, friction=0.5, bounce=0.2, colour=(0.5, 0.7, 0.9))
    shards, around, rings = [], 5, [(0.045, 0.0), (0.07, 0.08), (0.04, 0.16)]
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
            mesh = bpy.data.meshes.new("Shard")
            middle = [sum(corner[axis] for corner in corners) / 8 for axis in range(3)]
            mesh.from_pydata([[at - shift for at, shift in zip(corner, middle)] for corner in corners], [], faces)
            shard = bpy.data.objects.new("Shard", mesh)
            scene.collection.objects.link(shard)
            shard.location = (middle[0], middle[1], middle[2] + 0.15)
            select(shard)
            shards.append(body(f"Shard.{ring * around + turn + 1:02}", mass=0.03, bounce=0.2, colour=(0.8, 0.5, 0.3)))
    for shard in shards:
        shard.plaus.thrown = (0.3, 0.0, 0.0)
        wish("NEVER", shard, glass)
    select(*shards)
    bpy.ops.plaus.vary(level="SOME", position=False, rotation=False)
    wish("STANDS", glass)
    scene.plaus.wanted = 4
    look((0.5, -0.75, 0.45), (0.05, 0.0, 0.05))


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
    mesh = bpy.data.meshes.new("Bowl")
    mesh.from_pydata(corners, [], faces)
    each = bpy.data.objects.new("Bowl", mesh)
    scene.collection.objects.link(each)
    each.location = (0.5, 0.0, 0.0)
    select(each)
    body("Bowl", "PASSIVE", "MESH", colour=(0.3, 0.5, 0.7))
    # The box around the bowl has room below its rim, so a box within it says what is inside.
    inside = target("Inside", (0.5, 0.0, 0.12), 0.1)
    inside.empty_display_type = "CUBE"
    bpy.ops.mesh.primitive_monkey_add(size=0.1, location=(-0.5, 0.0, 0.3))
    head = body("Suzanne", mass=0.3, bounce=0.4, colour=(0.6, 0.4, 0.2))
    bpy.ops.mesh.primitive_uv_sphere_add(segments=32, ring_count=16, radius=0.03, location=(-0.5, 0.15, 0.3))
    ball = body("Ball", mass=0.1, bounce=0.6, colour=(0.8, 0.2, 0.2))
    for one in (head, ball):
        one.plaus.thrown = (1.8, 0.0, 1.5)
    select(head, ball)
    bpy.ops.plaus.vary(level="SOME")
    wish("ENDS_INSIDE", head, inside)
    wish("ENDS_INSIDE", ball, inside)
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
