#!/usr/bin/env python3
"""Builds the Python package as a wheel, and tests it as users have it: installed, in its own environment.

Exit codes: 0 all is well, 1 it is not, 77 packages could not be installed.
"""

import argparse
import os
import shutil
import subprocess
import sys
import zipfile
from pathlib import Path

import third_party
from environment import NO_REGISTRY, PATIENCE, environment, pythons

ROOT = third_party.ROOT
PACKAGE = third_party.PACKAGE
# Largest wheel, in bytes.
LARGEST = 11_000_000
MATURIN = ["maturin==1.16.0"]
# Links for Linux of long ago, and for other C libraries and processors, on any Linux.
ZIG = ["ziglang==0.15.2"]
# What a wheel for Linux promises to need at most.
NEEDS = {"gnu": "manylinux_2_17", "musl": "musllinux_1_2"}
# The newest versions that work together on Python 3.11, including packages for the notebooks.
TRIED_WITH = [
    "arviz==0.23.4",
    "ipykernel==7.4.0",
    "matplotlib==3.11.2",
    "mypy==2.4.1",
    "nbclient==0.11.0",
    "numpy==2.4.6",
    "polars==2.1.0",
    "pytest==9.2.0",
    "xarray==2026.9.0",
]
# On other Pythons, all of them newer: the newest versions, so ArviZ 1.
TRIED_WITH_LITTLE = ["arviz", "numpy", "pytest", "xarray"]
PYTHONS = ["python3.12", "python3.13", "python3.14"]


def run(words: list, **how) -> int:
    """Shows a command, runs it, and returns its exit code."""
    print("$", *map(str, words), flush=True)
    return subprocess.run([str(word) for word in words], **how).returncode


def dist_of(target: Path, profile: str) -> Path:
    """The folder of the wheel: one to distribute, or one only for tests, which is not optimised."""
    return target / "wheel" / ("dist" if profile == "release" else f"dist-{profile}")


def build(target: Path, profile: str, platform: str | None) -> int:
    """Makes the wheel, in `target`/wheel/dist if it is one to distribute: for this machine, or for a platform."""
    is_old_linux = platform is not None and "-linux-" in platform
    with_zig = ("zig", MATURIN + ZIG) if is_old_linux else ("maturin", MATURIN)
    python = environment(target / "wheel" / with_zig[0], with_zig[1])
    dist = dist_of(target, profile)
    shutil.rmtree(dist, ignore_errors=True)
    # In Python, a program goes on where a bug in Rust is an exception.
    built = "python" if profile == "release" else profile
    words = [python.with_name("maturin"), "build", "--locked", "--profile", built, "--out", dist]
    words += ["--manifest-path", PACKAGE / "Cargo.toml", "--interpreter", sys.executable, "--target-dir", target]
    if profile != "release":
        words += ["--features", "tested"]
    if platform is not None:
        words += ["--target", platform]
    if is_old_linux:
        words += ["--zig", "--compatibility", NEEDS[platform.rsplit("-", 1)[1]]]
    if profile == "release" and sys.platform == "linux":
        # Without the names of functions. Not `--strip`: that sets a key of the profile, ignored for packages
        # with other settings of their own.
        words += ["--", "-C", "link-arg=-s"]
    # Maturin looks for zig beside the Python on the path.
    around = {**os.environ, "PATH": os.pathsep.join([str(python.parent), os.environ.get("PATH", "")])}
    if run(words, cwd=ROOT, env=around) != 0:
        print("maturin failed")
        return 1
    [wheel] = dist.glob("*.whl")
    size = wheel.stat().st_size
    print(f"{wheel.relative_to(ROOT) if wheel.is_relative_to(ROOT) else wheel}: {size / 1e6:.1f} MB")
    if profile == "release" and size > LARGEST:
        print(f"larger than {LARGEST / 1e6:.0f} MB")
        return 1
    names = zipfile.ZipFile(wheel).namelist()
    wanted = ["plaus/py.typed", "plaus/_plaus.pyi", "plaus/__init__.py"]
    missing = [name for name in wanted if name not in names]
    missing += [name for name in ("THIRD-PARTY.txt", "LICENSE-MIT") if not any(each.endswith(name) for each in names)]
    if missing or "-cp311-abi3-" not in wheel.name:
        print(f"missing in the wheel: {missing}, or no abi3 wheel: {wheel.name}")
        return 1
    if not any(name.endswith(".cyclonedx.json") for name in names):
        print("the wheel does not say what it is built of")
        return 1
    if (is_old_linux and NEEDS[platform.rsplit("-", 1)[1]] not in wheel.name) or "-linux_" in wheel.name:
        print(f"{wheel.name} does not work on other Linux systems")
        return 1
    return 0


def bare(python: Path) -> dict[str, str]:
    """An environment without a Rust toolchain: the PATH keeps only folders that have neither cargo nor rustc."""
    folders = [str(python.parent), *os.environ.get("PATH", "").split(os.pathsep)]
    has_rust = lambda folder: any(shutil.which(tool, path=folder) for tool in ("cargo", "rustc"))
    kept = [folder for folder in folders if folder and not has_rust(folder)]
    gone = ("CARGO", "RUSTUP", "PYTHONPATH")
    rest = {key: value for key, value in os.environ.items() if not key.startswith(gone)}
    return {**rest, "PATH": os.pathsep.join(kept), "PLAUS_SCENARIOS": str(ROOT / "scenarios")}


def install(python: Path, wheel: Path) -> int:
    """Installs the wheel in an environment, in place of an earlier one."""
    pip = [python, "-m", "pip", "install", "--quiet", "--disable-pip-version-check", *PATIENCE]
    return run([*pip, "--force-reinstall", "--no-deps", wheel])


def tests(python: Path, target: Path, command: Path | None) -> int:
    """Runs the package's tests on an installed wheel."""
    around = bare(python)
    if command is not None:
        around["PLAUS_COMMAND"] = str(command)
    words = [python, "-m", "pytest", "-q", "-x", "-p", "no:cacheprovider", PACKAGE / "tests" / "test_plaus.py"]
    # Not in the folder of the sources, so that the installed package is imported.
    return run(words, cwd=target / "wheel", env=around)


def types(python: Path, target: Path) -> int:
    """Checks that the stubs describe the compiled part, and that the package's types are right."""
    words = [[python, "-m", "mypy.stubtest", "plaus._plaus"], [python, "-m", "mypy", "--strict", "-p", "plaus"]]
    return max(run(each, cwd=target / "wheel", env=bare(python)) for each in words)


def notebooks(python: Path, target: Path) -> int:
    """Runs every notebook, cell by cell."""
    return run(
        [python, ROOT / "xtask/python/notebooks.py", PACKAGE / "examples"], cwd=target / "wheel", env=bare(python)
    )


def check(target: Path, profile: str, with_notebooks: bool, all_of_them: bool) -> int:
    """Tests and notebooks on the Python that runs this script, and tests on all other installed ones."""
    [wheel] = dist_of(target, profile).glob("*.whl")
    python = environment(target / "wheel" / "tried", TRIED_WITH)
    command = target / "release" / "plaus"
    command = command if command.exists() else None
    for step in (
        lambda: install(python, wheel),
        lambda: types(python, target),
        lambda: tests(python, target, command),
        lambda: notebooks(python, target) if with_notebooks else 0,
    ):
        if step() != 0:
            return 1
    for other in pythons(PYTHONS) if all_of_them else []:
        fresh = target / "wheel" / Path(other).name
        print(f"{other}: an environment made for this", flush=True)
        shutil.rmtree(fresh, ignore_errors=True)
        if subprocess.run([other, "-m", "venv", fresh]).returncode != 0:
            print(f"{other} makes no environment")
            continue
        own = fresh / "bin" / "python"
        pip = [own, "-m", "pip", "install", "--quiet", "--disable-pip-version-check", *PATIENCE, *TRIED_WITH_LITTLE]
        if run(pip) != 0:
            return NO_REGISTRY
        if install(own, wheel) != 0 or tests(own, target, command) != 0:
            return 1
    return 0


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("what", choices=["build", "check", "licences", "write-licences", "measure"])
    parser.add_argument("--target", type=Path, required=True, help="the folder that cargo builds into")
    parser.add_argument("--profile", default="release")
    parser.add_argument("--platform", help="a target of rustc: for Linux, a wheel that also works on old systems")
    parser.add_argument("--all", action="store_true", help="on all Pythons that are there")
    parser.add_argument("--no-notebooks", action="store_true", help="only the tests")
    given = parser.parse_args()
    given.target = given.target.resolve()
    if given.what == "write-licences":
        third_party.LIST.write_text(third_party.listing(), encoding="utf-8")
        return 0
    if given.what == "licences":
        wrong = third_party.problems()
        print("\n".join(wrong) or "every crate in the wheel is listed with its licence")
        return 1 if wrong else 0
    if given.what == "build":
        return build(given.target, given.profile, given.platform)
    if given.what == "measure":
        python = given.target / "wheel" / "tried" / "bin" / "python"
        words = [python, ROOT / "xtask/python/measure_wheel.py", "--command", given.target / "release" / "plaus"]
        return run(
            [*words, "--examples", given.target / "release" / "examples"], cwd=given.target / "wheel", env=bare(python)
        )
    return check(given.target, given.profile, not given.no_notebooks, given.all)


if __name__ == "__main__":
    sys.exit(main())
