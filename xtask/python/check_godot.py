#!/usr/bin/env python3
"""Imports GLB files into Godot 4, and compares what it plays at random times between keys with the poses that
`plaus export --format poses` writes.

Exit codes: 0 sound, 1 not.
"""

import argparse
import math
import random
import shutil
import subprocess
import sys
from pathlib import Path

from truth import Truth, angle

# Largest allowed error of a body's place and orientation, in m and degrees.
FAR, TURNED = 5e-4, 0.1
# Number of random times at which all bodies are examined.
TIMES = 200
PROJECT = 'config_version=5\n\n[application]\n\nconfig/name="plaus"\n'


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--godot", required=True, help="the program")
    parser.add_argument("--project", type=Path, required=True, help="folder of the project that is made")
    parser.add_argument("files", nargs="+", help="GLB with its .import beside it, its poses as CSV, …")
    arguments = parser.parse_args()
    shutil.rmtree(arguments.project, ignore_errors=True)
    arguments.project.mkdir(parents=True)
    (arguments.project / "project.godot").write_text(PROJECT)
    shutil.copy(Path(__file__).parent.parent / "godot" / "play.gd", arguments.project)
    godot = [arguments.godot, "--headless", "--path", str(arguments.project)]
    generator, truths, words = random.Random(1), {}, []
    for glb, poses in zip(arguments.files[::2], arguments.files[1::2]):
        glb = Path(glb)
        shutil.copy(glb, arguments.project)
        shutil.copy(f"{glb}.import", arguments.project)
        truth = truths[glb.name] = Truth(poses)
        times = [repr(generator.uniform(0.0, truth.end)) for _ in range(TIMES)]
        words += [glb.name, ",".join(times), ",".join(truth.bodies)]
    subprocess.run([*godot, "--import"], check=True, stdout=subprocess.DEVNULL)
    played = subprocess.run([*godot, "--script", "play.gd", "--", *words], check=True, capture_output=True, text=True)
    worst = {name: [0, 0.0, 0.0] for name in truths}
    for row in (line.split(",") for line in played.stdout.splitlines() if line.startswith("pose,")):
        _, name, time, body, *numbers = row
        place, turn = truths[name].at(body, float(time))
        numbers = [float(number) for number in numbers]
        if truths[name].is_crowded(body, float(time)):
            continue
        count, far, turned = worst[name]
        worst[name] = [count + 1, max(far, math.dist(place, numbers[:3])), max(turned, angle(turn, numbers[3:]))]
    wrong = 0
    for name, (count, far, turned) in worst.items():
        sound = count >= TIMES * len(truths[name].bodies) * 0.95 and far <= FAR and turned <= TURNED
        wrong += not sound
        print(f"{'ok' if sound else 'WRONG'} {name}: {count} poses, off by {far * 1e3:.3f} mm and {turned:.3f} degrees")
    return 1 if wrong or not worst else 0


if __name__ == "__main__":
    sys.exit(main())
