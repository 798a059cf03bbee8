"""Where MuJoCo puts the bodies, joints and shapes of models in MJCF and URDF: the truth of `imported_models.rs`.

With MuJoCo installed (`pip install mujoco`), from the root of the repository:

    python xtask/python/mjcf_poses.py crates/plaus-scenes/tests/models frames.xml joints.xml crane.urdf
"""

import json
import pathlib
import re
import sys

import mujoco
import numpy


def listed(numbers):
    return [round(float(number), 12) for number in numbers]


def poses(path):
    model = mujoco.MjModel.from_xml_path(str(path))
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    bodies = {
        model.body(index).name: {"at": listed(data.xpos[index]), "turn": listed(data.xquat[index])}
        for index in range(1, model.nbody)
    }
    joints = {
        model.joint(index).name: {"at": listed(data.xanchor[index]), "axis": listed(data.xaxis[index])}
        for index in range(model.njnt)
        if model.jnt_type[index] != mujoco.mjtJoint.mjJNT_FREE
    }
    # Of a mesh, the corners: MuJoCo puts its axes along those of inertia.
    geoms = {}
    for index in range(model.ngeom):
        at, turn = data.geom_xpos[index], data.geom_xmat[index].reshape(3, 3)
        if model.geom_type[index] == mujoco.mjtGeom.mjGEOM_MESH:
            mesh = model.geom_dataid[index]
            first, count = model.mesh_vertadr[mesh], model.mesh_vertnum[mesh]
            corners = model.mesh_vert[first : first + count].astype(float) @ turn.T + at
            geoms[model.geom(index).name] = {"corners": [listed(corner) for corner in corners]}
        else:
            geoms[model.geom(index).name] = {"at": listed(at), "axes": [listed(turn[:, k]) for k in range(3)]}
    # What has no joint is part of what it belongs to: mass, centre of mass and moments of inertia of all of it.
    moving = {}
    for owner in sorted(set(model.body_weldid) - {0}):
        parts = [index for index in range(model.nbody) if model.body_weldid[index] == owner]
        masses = model.body_mass[parts]
        centre = masses @ data.xipos[parts] / masses.sum()
        inertia = numpy.zeros((3, 3))
        for index, mass in zip(parts, masses):
            axes, away = data.ximat[index].reshape(3, 3), data.xipos[index] - centre
            inertia += axes @ numpy.diag(model.body_inertia[index]) @ axes.T
            inertia += mass * (away @ away * numpy.eye(3) - numpy.outer(away, away))
        moving[model.body(owner).name] = {
            "mass": round(float(masses.sum()), 12),
            "centre": listed(centre),
            "moments": listed(numpy.linalg.eigvalsh(inertia)),
        }
    return {"bodies": bodies, "joints": joints, "geoms": geoms, "moving": moving}


def main():
    folder, *names = sys.argv[1:]
    said = {name.split(".")[0]: poses(pathlib.Path(folder) / name) for name in names}
    said["mujoco"] = mujoco.__version__
    text = json.dumps(said, indent=1)
    # Lists of numbers take one line.
    text = re.sub(r"\[[^\[\]{}]*\]", lambda found: re.sub(r"\s+", " ", found[0]).replace("[ ", "["), text)
    (pathlib.Path(folder) / "poses.json").write_text(text + "\n", encoding="utf-8")


main()
