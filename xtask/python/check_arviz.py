#!/usr/bin/env python3
"""Reads an exported run with ArviZ and compares it with what plaus itself says.

Makes a virtual environment of its own (Python 3.11 or newer, with venv and pip), so nothing needs to be installed beforehand.
Exit codes: 0 agreed, 1 disagreed, 77 the packages could not be installed.
"""

import argparse
import contextlib
import csv
import json
import math
import os
import re
import subprocess
import sys
import tempfile
from pathlib import Path

from environment import environment, pythons

# The newest versions that work together on Python 3.11.
REQUIREMENTS = [
    "arviz==0.23.4",
    "xarray==2026.9.0",
    "zarr==3.1.6",
    "numpy==2.4.6",
    "pandas==3.1.1",
    "scipy==1.17.1",
    "matplotlib==3.11.2",
]

# Newer Pythons, for which there is ArviZ 1.x.
NEWER = ["python3.12", "python3.13"]
REQUIREMENTS_1 = ["arviz==1.3.0", "zarr==3.1.6"]


class Comparison:
    """Counts comparisons, and remembers the disagreements."""

    def __init__(self):
        self.compared = 0
        self.wrong = []

    def equal(self, what, found, expected):
        self.compared += 1
        if found != expected:
            self.wrong.append(f"{what}: {found!r}, expected {expected!r}")

    def close(self, what, found, expected, relative):
        self.compared += 1
        near = found == expected or (found is not None and expected is not None and math.isclose(found, expected, rel_tol=relative))
        if not near:
            self.wrong.append(f"{what}: ArviZ {found!r}, plaus {expected!r}")


def read_csv(path: Path):
    """Columns by name, for each chain."""
    columns = {}
    with open(path, newline="") as file:
        for row in csv.DictReader(file):
            for name, value in row.items():
                columns.setdefault(name, {}).setdefault(int(row["chain"]), []).append(value)
    return columns


def of_scalar(dataset, name):
    """The values of a scalar: `theta_2` is the second value of the variable `theta` along its own dimension."""
    if name in dataset:
        return dataset[name]
    variable, number = name.rsplit("_", 1)
    (dimension,) = set(dataset[variable].dims) - {"chain", "draw"}
    return dataset[variable].sel({dimension: int(number)}, drop=True)


def row_of(summary, dataset, name):
    """The name of a scalar in ArviZ's summary: `theta[2]`."""
    return summary.loc[name if name in dataset else "{}[{}]".format(*name.rsplit("_", 1))]


def check(arguments) -> int:
    import arviz as az
    import numpy as np
    import xarray as xr

    data = az.from_datatree(xr.open_datatree(arguments.zarr, engine="zarr"))
    table = read_csv(arguments.csv)
    diagnosis = json.loads(arguments.diagnose.read_text())
    comparison = Comparison()

    scalars = [row["name"] for row in diagnosis["scalars"]]
    chains, draws = len(table["chain"]), len(table["chain"][0])
    for group in ["posterior", "sample_stats", "warmup_posterior", "warmup_sample_stats"]:
        comparison.equal(f"group {group}", group in data.groups(), True)
    comparison.equal("variables", sorted(data.posterior.data_vars), ["rest_x", "theta"])
    comparison.equal("dimensions", data.posterior["theta"].dims, ("chain", "draw", "bounce"))
    comparison.equal("bounces", data.posterior["bounce"].values.tolist(), [1, 2, 3, 4, 5])
    comparison.equal("unit", data.posterior["theta"].attrs["unit"], "degree")
    comparison.equal("scene", data.posterior.attrs["scene"], "ball2d")
    for name in scalars:
        comparison.equal(f"shape of {name}", of_scalar(data.posterior, name).shape, (chains, draws))
    comparison.equal("chain numbers", data.posterior["chain"].values.tolist(), list(range(chains)))
    comparison.equal("draw numbers", data.posterior["draw"].values.tolist(), list(range(draws)))

    def same(values, column, read):
        expected = np.array([[read(text) for text in table[column][chain]] for chain in range(chains)])
        comparison.equal(f"{column}, bit for bit", np.array_equal(values, expected), True)

    for name in scalars:
        same(of_scalar(data.posterior, name).values, name, float)
    same(data.sample_stats["lp"].values, "log_p", float)
    same(data.sample_stats["satisfied"].values, "satisfied", lambda text: text == "true")

    summary = az.summary(data, round_to="none")
    for row in diagnosis["scalars"]:
        name, ours = row["name"], row["summary"]
        theirs = row_of(summary, data.posterior, name)
        for field, column in [("mean", "mean"), ("sd", "sd"), ("ess_bulk", "ess_bulk"), ("ess_tail", "ess_tail"), ("rhat", "r_hat")]:
            # Of a long run plaus would read only every n-th draw; this run is short.
            comparison.close(f"{field} of {name}", float(theirs[column]), ours[field], 1e-6)

    for line in comparison.wrong:
        print(f"DIFFERS {line}")
    print(f"ArviZ {az.__version__}, xarray {xr.__version__}: {chains} chains of {draws} draws, {len(scalars)} scalars; ", end="")
    print(f"{comparison.compared - len(comparison.wrong)} comparisons agree, {len(comparison.wrong)} differ")
    return 1 if comparison.wrong else 0


def snippet(new: bool) -> str:
    """The code of docs/statistics.md: as it stands for ArviZ 0.23, or for 1.x as its comment says."""
    text = (Path(__file__).parents[2] / "docs" / "statistics.md").read_text()
    (code,) = re.findall(r"```python\n(import arviz.*?)```", text, re.DOTALL)
    (instead,) = re.findall(r"with 1\.x: (.*)", code)
    return re.sub(r"(?m)^draws = .*$", lambda _: instead, code) if new else code


def run_snippet(zarr: Path) -> int:
    """Runs the code of docs/statistics.md with the installed ArviZ, and checks the result."""
    import arviz

    names = {}
    with tempfile.TemporaryDirectory() as folder, contextlib.chdir(folder):
        os.symlink(zarr, Path(folder) / "draws.zarr")
        exec(compile(snippet(not arviz.__version__.startswith("0.")), "statistics.md", "exec"), names)
        first = names["first"]
        right = first.dims == ("chain", "draw") and first.attrs["unit"] == "degree" and bool(first.notnull().all())
    print(f"The snippet of docs/statistics.md with ArviZ {arviz.__version__}: {'right' if right else 'WRONG'}", flush=True)
    return 0 if right else 1


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--venv", type=Path, help="folder of the virtual environment, made where it is missing")
    parser.add_argument("--zarr", type=Path, required=True)
    parser.add_argument("--csv", type=Path)
    parser.add_argument("--diagnose", type=Path, help="output of `plaus diagnose --json`")
    arguments = parser.parse_args()
    arguments.zarr = arguments.zarr.resolve()
    if arguments.venv is None:
        return run_snippet(arguments.zarr) or (check(arguments) if arguments.csv else 0)
    python = environment(arguments.venv, REQUIREMENTS)
    zarr = ["--zarr", os.fspath(arguments.zarr)]
    rest = ["--csv", arguments.csv, "--diagnose", arguments.diagnose]
    done = subprocess.run([python, __file__, *zarr, *map(os.fspath, rest)]).returncode
    newer = pythons(NEWER)
    if done == 0 and newer:
        python = environment(arguments.venv.with_name(arguments.venv.name + "-1"), REQUIREMENTS_1, newer[0])
        done = subprocess.run([python, __file__, *zarr]).returncode
    elif not newer:
        print("ArviZ 1.x needs Python 3.12, which is not here: its line in docs/statistics.md was not tried", flush=True)
    return done


if __name__ == "__main__":
    sys.exit(main())
