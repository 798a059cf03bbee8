#!/usr/bin/env python3
"""Reads USDA files with Pixar's own library: validators, names, time samples; and compares poses with a table.

Makes a virtual environment of its own (Python 3.11 or newer, with venv and pip), so nothing needs to be installed beforehand.
Exit codes: 0 sound, 1 not, 77 the packages could not be installed.
"""

import argparse
import csv
import math
import os
import subprocess
import sys
from pathlib import Path

from environment import environment

REQUIREMENTS = ["usd-core==26.11"]


def check(path: str, poses: str) -> list[str]:
    """What is wrong with one file."""
    from pxr import Gf, Usd, UsdGeom, UsdValidation

    stage = Usd.Stage.Open(path)
    wrong = []
    context = UsdValidation.ValidationContext(UsdValidation.ValidationRegistry().GetOrLoadAllValidators())
    for error in context.Validate(stage):
        kind = error.GetType()
        if kind in (UsdValidation.ValidationErrorType.Error, UsdValidation.ValidationErrorType.Warn):
            wrong.append(f"{error.GetValidator().GetMetadata().name}: {error.GetMessage()}")
    names = [prim.GetName() for prim in stage.Traverse() if prim.IsA(UsdGeom.Gprim)]
    if len(set(names)) != len(names):
        wrong.append("geometry is not uniquely named")
    facts = stage.GetRootLayer().customLayerData
    wrong += [f"no fact {name}" for name in ("plaus:sample", "plaus:seed", "plaus:log_p") if name not in facts]
    rate, worst, turned, count = stage.GetTimeCodesPerSecond(), 0.0, 0.0, 0
    ops = {}
    with open(poses, newline="") as table:
        for row in csv.DictReader(table):
            body = row["body"]
            if body not in ops:
                prim = UsdGeom.Xform(stage.GetPrimAtPath(f"/plaus/{body}"))
                ops[body] = {op.GetOpType(): op for op in prim.GetOrderedXformOps()}
            found = ops[body][UsdGeom.XformOp.TypeTranslate].Get(float(row["t"]) * rate)
            worst = max(worst, (Gf.Vec3d(*(float(row[axis]) for axis in "xyz")) - found).GetLength())
            orient = ops[body].get(UsdGeom.XformOp.TypeOrient)
            if orient:
                turn = Gf.Quatd(*(float(row[part]) for part in ("qw", "qx", "qy", "qz"))).GetNormalized()
                found = Gf.Quatd(orient.Get(float(row["t"]) * rate)).GetNormalized()
                cosine = abs(turn.GetReal() * found.GetReal() + Gf.Dot(turn.GetImaginary(), found.GetImaginary()))
                turned = max(turned, 2.0 * math.degrees(math.acos(min(1.0, cosine))))
            count += 1
    # The accuracy that every program must reach.
    if not count or worst > 5e-4 or turned > 0.1:
        wrong.append(f"{count} poses compared, the worst is off by {worst} m, {turned} degrees")
    print(f"{path}: {len(ops)} bodies, {count} poses, off by at most {worst * 1e3:.3f} mm and {turned:.3f} degrees; {len(wrong)} findings", flush=True)
    return wrong


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--venv", type=Path, help="folder of the virtual environment, made where it is missing")
    parser.add_argument("files", nargs="+", help="USDA, its poses as CSV, USDA, …")
    arguments = parser.parse_args()
    if arguments.venv:
        python = environment(arguments.venv, REQUIREMENTS)
        return subprocess.run([python, __file__, *map(os.fspath, arguments.files)]).returncode
    pairs = zip(arguments.files[::2], arguments.files[1::2])
    wrong = [f"{usda}: {message}" for usda, poses in pairs for message in check(usda, poses)]
    print("\n".join(["", *wrong]))
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
