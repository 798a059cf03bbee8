"""Worlds of `cargo xtask tradeoff` in MuJoCo, which has shapes and joints of its own: time, and error by step.

With MuJoCo installed (`pip install mujoco`), from the root of the repository:

    python xtask/python/beside_mujoco.py [DRAWS]

Starts follow the laws of that command's worlds, but are not the same. Each draw runs for a fixed time, also after
everything is at rest; only throws end at rest. Processor time is measured, without the time to make the model.
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


def parts(shape):
    """The boxes of a shape: half edges, place from the centre of gravity, and turn about the y axis; and its inertia."""
    if shape == "box":
        mass, (x, y, z) = 2400 * 0.06 * 0.03 * 0.005, (0.06, 0.03, 0.005)
        inertia = [mass / 12 * (a * a + b * b) for a, b in ((y, z), (x, z), (x, y))]
        return [((x / 2, y / 2, z / 2), (0, 0, 0), 0)], mass, inertia
    sides = [((0.011, 0.015, 0.0025), (0.019 * k, 0, 0.005 * abs(k) - 0.01 / 3), -0.5 * k) for k in (-1, 0, 1)]
    # As our compound has it: the sum over the boxes.
    return sides, 0.02376, [2.1027608e-6, 6.8580600e-6, 8.3192993e-6]


def thrown(random, shape, restitution, stiffness=4e8, step=1e-5):
    """The ring of 50 mm about the middle in which a body lies that fell from 1 m, as the world `shard` reads it.

    Contact is a stiff spring and damper, given per mass, so that a single point rebounds with this restitution.
    """
    boxes, mass, inertia = parts(shape)
    geoms = "".join(
        f'<geom type="box" size="{numbers(half)}" pos="{numbers(at)}" quat="{numbers(turned((0, 1, 0), angle))}"/>'
        for half, at, angle in boxes
    )
    body = f'<inertial pos="0 0 0" mass="{mass}" diaginertia="{numbers(inertia)}"/>{geoms}'
    m = stiff(body, 0.4, ratio_of(restitution), stiffness)
    data = mujoco.MjData(m)
    angles = random.uniform(-3, 3, 3)
    turn = turned(angles, float(numpy.linalg.norm(angles)))
    data.qpos[:] = [*(numpy.array([-0.09, -0.045, 1.0]) + random.uniform(-0.005, 0.005, 3)), *turn]
    axes = numpy.zeros(9)
    mujoco.mju_quat2Mat(axes, numpy.array(turn))
    data.qvel[3:] = axes.reshape(3, 3).T @ random.uniform(-6, 6, 3)
    m.opt.timestep = 2e-4
    while data.qpos[2] > 0.045:
        mujoco.mj_step(m, data)
    m.opt.timestep, still = step, 0
    while data.time < 6 and still < 3:
        mujoco.mj_step(m, data, nstep=round(0.02 / step))
        speed = numpy.linalg.norm(data.qvel[:3]) + 0.03 * numpy.linalg.norm(data.qvel[3:])
        still = still + 1 if speed < 0.005 else 0
    return min(int(math.hypot(*data.qpos[:2]) / 0.05), 11)


def numbers(values):
    return " ".join(f"{v:.9g}" for v in values)


def stiff(body, friction, ratio, stiffness):
    """A body over a floor; contact is a spring and damper, the latter with this ratio to the critical one."""
    damping = 2 * ratio * math.sqrt(stiffness)
    return mujoco.MjModel.from_xml_string(
        f"""<mujoco><option gravity="0 0 -9.81" cone="elliptic" integrator="Euler" impratio="100" tolerance="1e-12"/>
        <default><geom friction="{friction} 0 0" condim="3" solref="{-stiffness} {-damping}"
        solimp="0.999 0.9999 0.0001"/></default><worldbody><geom type="plane" size="5 5 1"/><body><freejoint/>{body}
        </body></worldbody></mujoco>"""
    )


def skim(friction, step=5e-7):
    """The velocity of a ball that comes down at 1 m/s while it slides at 8 m/s, after an impact without restitution."""
    m = stiff('<geom type="sphere" size="0.01"/>', friction, 8, 1e8)
    m.opt.timestep, m.opt.gravity = step, 0
    data = mujoco.MjData(m)
    data.qpos[2], data.qvel[:3] = 0.0101, (8, 0, -1)
    mujoco.mj_step(m, data, nstep=round(4e-3 / step))
    return data.qvel[:3].copy()


def rebound(ratio):
    """Restitution of a unit mass on a unit spring that only pushes, with this ratio of damping to the critical one."""
    x, v, h = 0.0, -1.0, 1e-4
    while True:
        force = -2 * ratio * v - x
        if force <= 0 < v:
            return v
        v += h * force
        x += h * v


def ratio_of(restitution):
    low, high = 0.0, 20.0
    for _ in range(30):
        middle = 0.5 * (low + high)
        low, high = (middle, high) if rebound(middle) > restitution else (low, middle)
    return 0.5 * (low + high)


def throws(random, draws):
    print("a ball that slides at 8 m/s strikes at 1 m/s without restitution: its velocity after that")
    for friction in (0.0, 0.1, 0.2):
        print(f"  friction {friction}: {numbers(skim(friction))}; Coulomb's law: {8 - friction:.1f} 0 0")
    print("bodies from 1 m, friction 0.4: the mean ring in which they lie")
    for shape in ("shard", "box"):
        for restitution in (0.3, 0.05):
            rings = [thrown(random, shape, restitution) for _ in range(draws)]
            error = statistics.stdev(rings) / math.sqrt(draws)
            print(f"  {shape}, restitution {restitution}: {statistics.mean(rings):.2f} ± {error:.2f}")


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
    throws(random, draws)
    shares("coin, 3 s: heads 0, edge 1, tails 2", coin, random, draws, (4e-3, 1e-3, 2.5e-4))
    shares("dominoes, 4 s: how many fell", dominoes, random, max(draws // 10, 1), (4e-3, 1e-3))


if __name__ == "__main__":
    main()
