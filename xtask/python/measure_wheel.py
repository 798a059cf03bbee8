#!/usr/bin/env python3
"""Numbers of the Python package, each beside its goal. Timings are medians of several runs, taken in turn with the runs
that they are compared with."""

import argparse
import os
import re
import resource
import statistics
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import numpy as np

import plaus
from plaus import sim

SCENARIOS = Path(os.environ["PLAUS_SCENARIOS"])


def clocked(work) -> float:
    begun = time.perf_counter()
    work()
    return time.perf_counter() - begun


def say(what: str, found: str, asked: str) -> None:
    print(f"{what:<58} {found:>22}   asked: {asked}", flush=True)


def imports() -> None:
    """Processor time that `import plaus` adds to a bare interpreter. Wall-clock time would include whatever else the
    machine does."""

    def of(code: str) -> float:
        def spent() -> float:
            usage = resource.getrusage(resource.RUSAGE_CHILDREN)
            return usage.ru_utime + usage.ru_stime

        def once() -> float:
            begun = spent()
            subprocess.run([sys.executable, "-I", "-c", code], check=True)
            return spent() - begun

        return statistics.median(once() for _ in range(21))

    say(
        "import plaus, beyond a bare interpreter, on the processor",
        f"{1e3 * (of('import plaus') - of('pass')):.1f} ms",
        "at most 50 ms",
    )


def processor(work) -> float:
    """Processor seconds of this process and of those that it starts. They hardly depend on what else the machine
    does."""

    def spent() -> float:
        usage = [resource.getrusage(who) for who in (resource.RUSAGE_SELF, resource.RUSAGE_CHILDREN)]
        return sum(each.ru_utime + each.ru_stime for each in usage)

    begun = spent()
    work()
    return spent() - begun


def overhead(command: Path, rounds: int) -> None:
    """The time of `plaus.sample` together with the diagnosis that ends the command, relative to the command's time."""
    how = ["--seed", "1", "--iterations", "400000", "--threads", "1", "--quiet"]
    ratios = []
    for index in range(rounds):
        with tempfile.TemporaryDirectory() as place:
            words = [command, "sample", SCENARIOS / "ball2d.toml", *how, "--out", f"{place}/a"]

            def ours() -> None:
                made = plaus.sample(
                    SCENARIOS / "ball2d.toml", seed=1, iterations=400_000, threads=1, out=f"{place}/b", progress=False
                )
                made.diagnose(400_000 // made.chains)

            theirs = lambda: subprocess.run(words, check=False, capture_output=True)
            first, second = (ours, theirs) if index % 2 else (theirs, ours)
            one, two = processor(first), processor(second)
            ratios.append(one / two if index % 2 else two / one)
    spread = f"{min(ratios):.3f} to {max(ratios):.3f}"
    say(f"plaus.sample over the command, {rounds} pairs ({spread})", f"{statistics.median(ratios):.3f}", "at most 1.03")


def requirement() -> None:
    """Iterations per second of dice-one under a requirement, all chains together."""

    def near(outcome):
        x = outcome["rest_x_1"]
        return -0.5 * (x / 50.0) ** 2, True

    def moving(outcome):
        height = max(outcome.motion.poses(times=[0.1])[1][0, :, 1])
        return -0.5 * (height / 0.1) ** 2, True

    def rate(asked) -> tuple[float, float]:
        made = []
        how = dict(iterations=600, warmup=0, requirement=asked, progress=False)
        begun = time.perf_counter()
        spent = processor(lambda: made.append(plaus.sample(SCENARIOS / "dice-one.toml", **how)))
        count = made[0].iterations * made[0].chains
        return count / (time.perf_counter() - begun), count / spent

    def resting(outcome):
        return -0.5 * (outcome.rest["die_1"][0] / 0.05) ** 2, True

    for name, function, processes in [
        ("none", None, 0),
        ("on numbers", near, 0),
        ("on poses at rest", resting, 0),
        ("on motion", moving, 0),
        ("on motion, 2 processes", moving, 2),
    ]:
        asked = plaus.Requirement(function, processes=processes) if function else None
        wall, core = rate(asked)
        cost = f", {asked.cost.calls} calls of {asked.cost.microseconds_a_call:.0f} us" if asked else ""
        found = f"{wall:,.0f} it/s, {core:,.0f} a core"
        say(f"dice-one, requirement {name}{cost}", found, "at least 2,000 it/s")


def tree() -> None:
    """Time to make a DataTree of 100,000 draws, after xarray is loaded."""
    import xarray  # noqa: F401

    made = plaus.sample(SCENARIOS / "dice-one.toml", chains=4, iterations=25_000, warmup=0, progress=False)
    took = statistics.median(clocked(made.to_datatree) for _ in range(5))
    say("100,000 draws of dice-one to a DataTree", f"{took:.3f} s", "at most 0.3 s")


def simulator(examples: Path, rounds: int) -> None:
    """Throughput of batches on one thread, relative to that of the Rust examples."""
    rng = np.random.default_rng(7)
    runs = 2000
    edge, width, breadth = 0.007, 0.14, 0.1
    drops = np.zeros((runs, 10, 3))
    drops[:, :, 0] = edge + (width - 2 * edge) * rng.random((runs, 10))
    drops[:, :, 1] = edge + (breadth - 2 * edge) * rng.random((runs, 10))
    drops[:, :, 2] = 0.072
    release = np.tile(0.1 * np.arange(10), (runs, 1))
    bins, ratios = sim.World.bins(10), []
    for _ in range(rounds):
        # The fastest of nine runs each, so that what else the machine does hardly counts.
        words = [examples / "spelling_drops", "1000", "standard", "10", "0.1", "time"]
        said = subprocess.run(words, check=True, capture_output=True, text=True).stdout
        events, each = (
            float(number) for number in re.search(r"events per run ([\d.]+), ns per event (\d+)", said).groups()
        )
        ours = processor(lambda: bins.run(drops, release=release, threads=1)) / runs
        ratios.append(1e-9 * events * each / ours)
    say(
        f"ten marbles, {1e6 * ours:.0f} us a run: throughput over the Rust example's",
        f"{statistics.median(ratios):.2f}",
        "at least 0.9",
    )

    starts = dict(
        position=np.zeros((runs, 1, 3)), velocity=np.zeros((runs, 1, 3)), spin=rng.uniform(-30, 30, (runs, 1, 3))
    )
    starts["position"][:, 0, 2] = rng.uniform(0.08, 0.12, runs)
    for axis, (low, high) in enumerate([(0.5, 1.5), (-0.2, 0.2), (-0.5, 0.0)]):
        starts["velocity"][:, 0, axis] = rng.uniform(low, high, runs)
    turns = rng.normal(size=(runs, 1, 4))
    starts["orientation"] = turns / np.linalg.norm(turns, axis=2, keepdims=True)
    die, ratios = sim.World.dice(1), []
    for _ in range(rounds):
        words = [examples / "die", "2000", "0", "standard"]
        said = subprocess.run(words, check=True, capture_output=True, text=True).stdout
        theirs = float(re.search(r"standard\s+0\s+\S+us\s+\S+us\s+([\d.]+)us", said).group(1))
        ours = 1e6 * processor(lambda: die.run(**starts, threads=1)) / runs
        ratios.append(theirs / ours)
    say(
        f"one die, {ours:.1f} us a throw: throughput over the Rust example's",
        f"{statistics.median(ratios):.2f}",
        "at least 0.9",
    )
    for name, world, given in [("one die", die, starts), ("ten marbles", bins, dict(position=drops, release=release))]:
        whole = lambda threads: world.run(**given, threads=threads)
        one, all_cores = (min(clocked(lambda: whole(threads)) for _ in range(rounds)) for threads in (1, 0))
        spent, spent_by_all = (min(processor(lambda: whole(threads)) for _ in range(rounds)) for threads in (1, 0))
        found = f"{one / all_cores:.2f}, {spent_by_all / spent:.2f} of its processor"
        say(f"{name}, all {os.cpu_count()} cores over one", found, "")


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--command", type=Path, required=True)
    parser.add_argument("--examples", type=Path, required=True)
    parser.add_argument("--rounds", type=int, default=7)
    given = parser.parse_args()
    print(f"plaus {plaus.__version__}, Python {sys.version.split()[0]}, numpy {np.__version__}, {os.cpu_count()} cores")
    imports()
    tree()
    requirement()
    overhead(given.command, given.rounds)
    simulator(given.examples, given.rounds)
    return 0


if __name__ == "__main__":
    sys.exit(main())
