"""Where the bodies of MJCF models come to rest, in Plaus and in MuJoCo.

With MuJoCo installed (`pip install mujoco`), from the root of the repository:

    python xtask/python/rests_beside_mujoco.py target/release/plaus MODEL.xml ...

Each model becomes a world by `plaus new --from`, without uncertainty, and runs until it rests. MuJoCo starts where that
world does, and runs for as long as the world may, at most 60 s, with the model's own options. Printed are, for each
model, the largest distance between a body's two resting places, and the largest angle between its two orientations.

MuJoCo's contact is soft: a body at rest lies in its support by a depth d with g = d k, where k follows from `solref`
and `solimp`. With the defaults that is 0.1 to 0.4 mm a contact; heights differ by as much.
"""

import csv
import math
import pathlib
import re
import subprocess
import sys
import tempfile

import mujoco
import numpy

# Slower than this, in m/s and rad/s, a body in MuJoCo is at rest.
AT_REST = 1e-3


def without_uncertainty(text):
    """A scenario with the middle of each normal law in its place."""
    return re.sub(r"\{ normal = \[([^,\]]+), [^\]]+\] \}", r"\1", text)


def ours(plaus, model, folder):
    """Places of bodies' origins and their orientations, at the start and at the end, by name, z up."""
    world, run, poses = (folder / name for name in ("world.toml", "run", "poses.csv"))
    commands = (
        ["new", "--from", model, world],
        ["sample", world, "--solutions", "1", "--chains", "1", "--max-time", "60s", "--set", "world.custom.duration_s=60", "--out", run],
        ["export", run, "--most-different", "1", "--format", "poses", "--out", poses],
    )
    for command in commands:
        done = subprocess.run([plaus, *map(str, command)], capture_output=True, text=True, timeout=120)
        if done.returncode != 0:
            raise RuntimeError(f"plaus {command[0]}: {(done.stderr or done.stdout).strip().splitlines()[-1]}")
        if command[0] == "new":
            world.write_text(without_uncertainty(world.read_text()))
    found = {}
    with poses.open() as file:
        for row in csv.DictReader(file):
            x, y, z = (float(row[f"origin_{axis}"]) for axis in "xyz")
            qx, qy, qz, qw = (float(row[f"q{axis}"]) for axis in "xyzw")
            # From y up to z up: a quarter turn about x.
            half = math.sqrt(0.5)
            turn = half * numpy.array([qw - qx, qx + qw, qy - qz, qz + qy])
            pose = numpy.array([x, -z, y]), turn
            found.setdefault(row["body"], []).append((float(row["t"]), *pose))
    return {name: (rows[0], rows[-1]) for name, rows in found.items()}


def body_names(model):
    """The names that our import gives bodies: their own, or their number among all."""
    names = {}
    for body in range(1, model.nbody):
        name = model.body(body).name or f"body_{body}"
        names[re.sub(r"[^A-Za-z0-9_-]", "_", name)] = body
    return names


def angle_between(a, b):
    """The angle in degrees between two orientations."""
    cosine = min(1.0, abs(float(a @ b)) / float(numpy.linalg.norm(a) * numpy.linalg.norm(b)))
    return math.degrees(2 * math.acos(cosine))


def compared(plaus, path):
    """What to print about a model."""
    with tempfile.TemporaryDirectory() as folder:
        poses = ours(plaus, path, pathlib.Path(folder))
    model = mujoco.MjModel.from_xml_path(str(path))
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    names = body_names(model)
    both = [(names[name], *ends) for name, ends in poses.items() if name in names]
    if not both:
        return "no body in common"
    # What overlaps at the start was moved apart: MuJoCo starts in the same places.
    for body, start, _ in both:
        joint = model.body_jntadr[body]
        if model.body_jntnum[body] == 1 and model.jnt_type[joint] == mujoco.mjtJoint.mjJNT_FREE:
            at = model.jnt_qposadr[joint]
            data.qpos[at : at + 3] += start[1] - data.xpos[body]
    while data.time < 60:
        mujoco.mj_step(model, data)
        if data.time > 2 and abs(data.qvel).max() < 1e-9:
            break
    mujoco.mj_forward(model, data)
    if abs(data.qvel).max() > AT_REST:
        return f"does not rest in MuJoCo ({abs(data.qvel).max():.1e})"
    far = [(float(numpy.linalg.norm(end[1] - data.xpos[body])), angle_between(end[2], data.xquat[body]), body)
           for body, _, end in both]
    distance, _, worst = max(far)
    moved = max(float(numpy.linalg.norm(end[1] - start[1])) for _, start, end in both)
    at = 1e3 * (next(end for body, _, end in both if body == worst)[1] - data.xpos[worst])
    return (f"{1e3 * distance:.3f} mm ({', '.join(f'{v:+.3f}' for v in at)}), {max(f[1] for f in far):.3f}°, "
            f"{len(both)} bodies, moved by up to {1e3 * moved:.0f} mm, rest at {max(e[0] for _, _, e in both):.1f} s")


def main():
    plaus, *models = sys.argv[1:]
    for model in models:
        try:
            said = compared(plaus, pathlib.Path(model))
        except (RuntimeError, ValueError, subprocess.TimeoutExpired) as error:
            said = f"left out: {error}"
        print(f"{pathlib.Path(model).name}: {said}", flush=True)


if __name__ == "__main__":
    main()
