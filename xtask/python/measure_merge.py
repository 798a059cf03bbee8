#!/usr/bin/env python3
"""Makes many small pieces of one run, merges them, and reports the cost: time, memory, files.

    measure_merge.py --plaus PLAUS --scenario FILE --work FOLDER --pieces N [--chains N] [--iterations N]
"""

import argparse
import os
import shutil
import subprocess
import time
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path


def used(words, cwd):
    """Runs a command. Returns its seconds, its processor seconds, and its largest memory in megabytes."""
    begin = time.perf_counter()
    process = subprocess.Popen(words, cwd=cwd, stdout=subprocess.DEVNULL)
    _, code, usage = os.wait4(process.pid, 0)
    seconds = time.perf_counter() - begin
    if code != 0:
        raise SystemExit(f"{words} failed")
    return seconds, usage.ru_utime + usage.ru_stime, usage.ru_maxrss / 1024


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--plaus", type=Path, required=True)
    parser.add_argument("--scenario", type=Path, required=True)
    parser.add_argument("--work", type=Path, required=True)
    parser.add_argument("--pieces", type=int, required=True)
    parser.add_argument("--chains", type=int, help="of all pieces together; one a piece unless given")
    parser.add_argument("--iterations", type=int, default=1000)
    arguments = parser.parse_args()
    plaus, place = str(arguments.plaus.resolve()), arguments.work.resolve() / f"merge-{arguments.pieces}"
    shutil.rmtree(place, ignore_errors=True)
    place.mkdir(parents=True)
    shutil.copy(arguments.scenario, place / "scenario.toml")
    run = [plaus, "sample", "scenario.toml", "--chains", str(arguments.chains or arguments.pieces)]
    run += ["--iterations", str(arguments.iterations), "--warmup", "0", "--thin", "1", "--threads", "1", "--quiet", "--out", "pieces/{shard}"]

    def sample(piece):
        # Exit code 1 if solutions are rare and no iteration has found one yet.
        subprocess.run([*run, "--shard", f"{piece}/{arguments.pieces}"], cwd=place, stderr=subprocess.DEVNULL)

    begin = time.perf_counter()
    with ThreadPoolExecutor(os.cpu_count()) as pool:
        list(pool.map(sample, range(1, arguments.pieces + 1)))
    took = time.perf_counter() - begin
    size = sum(path.stat().st_size for path in (place / "pieces").glob("*/chain-*")) / 1e9
    made = f"{arguments.pieces} pieces, {arguments.chains or arguments.pieces} chains"
    print(f"{made}, {size:.3f} GB, made in {took:.1f} s", flush=True)
    for again in range(3):
        out = f"run-{again}"
        seconds, processor, memory = used([plaus, "merge", "pieces", "--out", out, "--quiet"], place)
        cost = f"{seconds:.2f} s, {processor:.2f} s of processor, {memory:.0f} MB of memory"
        print(f"merge: {cost}, {seconds / size:.2f} s a GB", flush=True)
    seconds, processor, memory = used(["sh", "-c", '"$0" diagnose run-0 > diagnosis.txt; [ $? -le 1 ]', plaus], place)
    print(f"diagnose: {seconds:.2f} s, {processor:.2f} s of processor, {memory:.0f} MB of memory", flush=True)


if __name__ == "__main__":
    main()
