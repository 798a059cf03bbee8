"""Worlds of `cargo xtask tradeoff` in MuJoCo, which has shapes and joints of its own: time, and error by step.

With MuJoCo installed (`pip install mujoco`), from the root of the repository:

    python xtask/python/beside_mujoco.py [DRAWS]

Starts follow the laws of that command's worlds, but are not the same. Each draw runs for a fixed time, also after
everything is at rest. Processor time is measured, without the time to make the model.
"""

import math
import statistics
import sys
import time

import mujoco
import numpy

COIN = {"radius": 0.012, "ratio": 0.35, "seconds": 3.0}
DOMINO = {"edges": (0.008, 0.024, 0.048), "count": 20, "seconds": 4.0}
RODS = ((0.06, 0.1, 0.5), (0.05, 0.06, 0.4))


def model(bodies, step, integrator="implicitfast", friction=0.3):
    floor = f'<geom type="plane" size="5 5 1" friction="{friction} 0 0"/>'
    options = f'<option timestep="{step}" gravity="0 0 -9.81" integrator="{integrator}" cone="elliptic"/>'
    return mujoco.MjModel.from_xml_string(f"<mujoco>{options}<worldbody>{floor}{bodies}</worldbody></mujoco>")


def run(model, data, seconds):
    """Processor time of a run of this many seconds."""
    begin = time.process_time()
    mujoco.mj_step(model, data, nstep=round(seconds / model.opt.timestep))
    return time.process_time() - begin


def free(shape, at, turn, friction=0.3, density=1000):
    place = " ".join(map(str, at)), " ".join(map(str, turn))
    return (
        f'<body pos="{place[0]}" quat="{place[1]}"><freejoint/>'
        f'<geom {shape} density="{density}" friction="{friction} 0 0"/></body>'
    )


def turned(axis, angle):
    length = math.sqrt(sum(a * a for a in axis)) or 1.0
    return [math.cos(angle / 2), *(math.sin(angle / 2) * a / length for a in axis)]


def coin(random, step):
    """Which side is up: 0 heads, 1 edge, 2 tails."""
    height = 2 * COIN["radius"] * COIN["ratio"]
    angles = random.uniform(-3, 3, 3)
    turn = turned(angles, float(numpy.linalg.norm(angles)))
    at = (0, 0, 0.3 + random.uniform(-0.1, 0.1))
    shape = f'type="cylinder" size="{COIN["radius"]} {height / 2}"'
    m = model(free(shape, at, turn, density=8000), step)
    data = mujoco.MjData(m)
    # MuJoCo's angular velocities are about the body's own axes.
    data.qvel[:] = [*random.uniform(-0.5, 0.5, 3), *random.uniform(-30, 30, 3)]
    seconds = run(m, data, COIN["seconds"])
    up = data.xmat[1].reshape(3, 3)[2, 2]
    return seconds, 0 if up > 0.7 else 1 if up > -0.7 else 2


def dominoes(random, step):
    """How many fell."""
    edges, x, bodies, turns = DOMINO["edges"], 0.0, "", []
    size = " ".join(str(edge / 2) for edge in edges)
    for _ in range(DOMINO["count"]):
        turns.append(random.uniform(-0.17, 0.17))
        bodies += free(f'type="box" size="{size}"', (x, 0, edges[2] / 2), turned((0, 0, 1), turns[-1]), density=1200)
        x += edges[0] + random.uniform(0.35, 0.75) * edges[2]
    m = model(bodies, step)
    data = mujoco.MjData(m)
    spin = random.uniform(12, 18)
    forward = (math.cos(turns[0]), math.sin(turns[0]))
    # It tips about its lower front edge, which is at rest.
    along, up = spin * edges[2] / 2, spin * edges[0] / 2
    data.qvel[:6] = [along * forward[0], along * forward[1], up, 0, spin, 0]
    seconds = run(m, data, DOMINO["seconds"])
    fallen = sum(data.xmat[k].reshape(3, 3)[2, 2] < 0.8 for k in range(1, DOMINO["count"] + 1))
    return seconds, int(fallen)


def pendulum(angles, step, integrator, seconds):
    """Angles of both rods after so many seconds."""
    rods = [f'type="box" pos="0 0 {-z / 2}" size="{x / 2} {y / 2} {z / 2}" density="1000"' for x, y, z in RODS]
    joint = '<joint type="hinge" axis="0 -1 0"/>'
    second = f'<body pos="0 0 {-RODS[0][2]}">{joint}<geom {rods[1]} contype="0" conaffinity="0"/></body>'
    bodies = f'<body pos="0 0 2">{joint}<geom {rods[0]} contype="0" conaffinity="0"/>{second}</body>'
    m = model(bodies, step, integrator)
    data = mujoco.MjData(m)
    data.qpos[:] = [angles[0], angles[1] - angles[0]]
    cost = run(m, data, seconds)
    return cost, data.qpos.copy()


def swings(random, draws):
    print("double pendulum, 2.5 s: ms, and the median error in mm of the second rod's end after 1 s")
    starts = [(random.uniform(0.5, 1.5), random.uniform(-1, 2)) for _ in range(draws)]
    truths = [pendulum(start, 1e-5, "RK4", 1.0)[1] for start in starts]

    def end(joints):
        angles = (joints[0], joints[0] + joints[1])
        along = [sum(rod[2] * f(angle) for rod, angle in zip(RODS, angles)) for f in (math.sin, math.cos)]
        return numpy.array(along)

    for integrator, steps in (("implicitfast", (1e-3, 1e-4)), ("RK4", (1e-2, 5e-3, 2e-3, 1e-3))):
        for step in steps:
            costs = [pendulum(start, step, integrator, 2.5)[0] for start in starts]
            ends = [pendulum(start, step, integrator, 1.0)[1] for start in starts]
            errors = [1e3 * float(numpy.linalg.norm(end(a) - end(b))) for a, b in zip(ends, truths)]
            print(f"  {integrator}, step {step}: {1e3 * statistics.median(costs):.2f} ms, "
                  f"{statistics.median(errors):.1e} mm")


def shares(name, world, random, draws, steps):
    print(name)
    for step in steps:
        found = [world(random, step) for _ in range(draws)]
        costs, outcomes = zip(*found)
        counts = {outcome: outcomes.count(outcome) for outcome in sorted(set(outcomes))}
        print(f"  step {step}: {1e3 * statistics.median(costs):.2f} ms, outcomes {counts}")


def main():
    draws = int(sys.argv[1]) if len(sys.argv) > 1 else 100
    random = numpy.random.default_rng(1)
    print(f"MuJoCo {mujoco.__version__}, {draws} draws a row")
    swings(random, draws)
    shares("coin, 3 s: heads 0, edge 1, tails 2", coin, random, draws, (4e-3, 1e-3, 2.5e-4))
    shares("dominoes, 4 s: how many fell", dominoes, random, max(draws // 10, 1), (4e-3, 1e-3))


if __name__ == "__main__":
    main()
