#!/usr/bin/env python3
"""The extension for Blender: packs it with the wheel, and tests it in Blender's Python module.

Exit codes: 0 all is well, 1 it is not, 77 packages could not be installed.
"""

import argparse
import os
import shutil
import subprocess
import sys
import tomllib
import zipfile
from pathlib import Path

import check_blender
from environment import NO_REGISTRY, PATIENCE, environment, pythons
from wheel import dist_of

ROOT = Path(__file__).resolve().parent.parent.parent
FOLDER = ROOT / "integrations" / "blender"
SOURCE = FOLDER / "plaus_blender"
# The oldest Blender that the extension is for, the last of each later one, and the Python that it has.
VERSIONS = {"python3.11": ["4.2.0", "4.3.0", "4.4.0", "4.5.15", "5.0.1"], "python3.13": ["5.1.2", "5.2.3", "5.3.0"]}
# Ends of wheels' names, and what Blender calls these platforms.
PLATFORMS = {
    "linux_x86_64": "linux-x64",
    "win_amd64": "windows-x64",
    "macosx_arm64": "macos-arm64",
    "macosx_x86_64": "macos-x64",
}


def platform(wheel: Path) -> str:
    """Blender's name of the platform that a wheel is for."""
    tag = wheel.stem.split("-")[-1]
    first, last = tag.split("_")[0], "_".join(tag.split("_")[-2:])
    name = f"{first.removeprefix('many')}_{last if last.startswith('x86') else tag.split('_')[-1]}"
    found = [shown for ending, shown in PLATFORMS.items() if ending in (name, tag)]
    if not found:
        sys.exit(f"{wheel.name}: for which of Blender's platforms is it? Known are {', '.join(PLATFORMS)}")
    return found[0]


def pack(target: Path, wheel: Path) -> Path:
    """Writes the zip that Blender installs: the extension, its licence, and the wheel as it is."""
    text = (SOURCE / "blender_manifest.toml").read_text(encoding="utf-8")
    manifest = tomllib.loads(text)
    where = platform(wheel)
    # Keys of the document come before its first table.
    head, table, rest = text.partition("\n[permissions]")
    bundled = f'\nplatforms = ["{where}"]\nwheels = ["./wheels/{wheel.name}"]\n'
    made = target / "blender" / f"{manifest['id']}-{manifest['version']}-{where}.zip"
    made.parent.mkdir(parents=True, exist_ok=True)
    with zipfile.ZipFile(made, "w", zipfile.ZIP_DEFLATED) as out:
        out.writestr("blender_manifest.toml", head + bundled + table + rest)
        for path in sorted(SOURCE.glob("*.py")):
            out.write(path, path.name)
        out.write(FOLDER / "LICENSE", "LICENSE")
        # Compressed already, and to stay as it is.
        out.write(wheel, f"wheels/{wheel.name}", zipfile.ZIP_STORED)
    print(f"{made}: {made.stat().st_size / 1e6:.1f} MB", flush=True)
    return made


def tried(target: Path, wheel: Path, made: Path, python: Path) -> bool:
    """Has one Blender judge the zip, and runs the tests in it with the wheel installed."""
    [cli] = python.parent.parent.glob("lib/*/site-packages/bpy/*/scripts/addons_core/bl_pkg/cli/blender_ext.py")
    pip = [python, "-m", "pip", "install", "--quiet", "--disable-pip-version-check", *PATIENCE]
    tests = [python, "-m", "pytest", "-q", "-x", "-p", "no:cacheprovider", FOLDER / "tests", "--durations=5"]
    # Blender's settings and extensions of this run are its own.
    home = target / "blender" / "home"
    shutil.rmtree(home, ignore_errors=True)
    around = {**os.environ, "BLENDER_USER_RESOURCES": str(home), "PLAUS_ZIP": str(made)}
    for words in ([python, cli, "validate", made], [*pip, "--force-reinstall", "--no-deps", wheel], tests):
        print("$", *map(str, words), flush=True)
        if subprocess.run([str(word) for word in words], cwd=target, env=around).returncode != 0:
            return False
    return True


def check(target: Path, wheel: Path) -> int:
    """Tries the zip in the Blender that exports are tried in."""
    made = pack(target, wheel)
    if sys.version_info[:2] != check_blender.PYTHON:
        print(f"bpy is for Python {check_blender.PYTHON}, this is {sys.version.split()[0]}", flush=True)
        return NO_REGISTRY
    python = environment(target / "blender-venv", check_blender.REQUIREMENTS)
    return 0 if tried(target, wheel, made, python) else 1


def check_all(target: Path, wheel: Path) -> int:
    """Tries the zip in every Blender that the Pythons of this machine can install, one after the other."""
    made = pack(target, wheel)
    bases = {base: path for base in VERSIONS for path in pythons([base])}
    for base in VERSIONS.keys() - bases.keys():
        print(f"no {base}: without Blender {', '.join(VERSIONS[base])}", flush=True)
    failed = []
    for base, path in bases.items():
        for version in VERSIONS[base]:
            folder = target / "blender" / f"venv-{version}"
            python = environment(folder, [f"bpy=={version}", check_blender.PYTEST], path)
            failed += [] if tried(target, wheel, made, python) else [version]
            # A Blender takes a gigabyte.
            shutil.rmtree(folder)
    print(f"failed: {', '.join(failed)}" if failed else "all passed", flush=True)
    return 1 if failed else 0 if bases else NO_REGISTRY


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("what", choices=["zip", "check", "check-all"])
    parser.add_argument("--target", type=Path, required=True, help="the folder that cargo builds into")
    parser.add_argument("--profile", default="release", help="that of the wheel")
    given = parser.parse_args()
    target = given.target.resolve()
    wheels = sorted(dist_of(target, given.profile).glob("*.whl"))
    if len(wheels) != 1:
        print(f"{len(wheels)} wheels in {dist_of(target, given.profile)}, and not one: cargo xtask wheel")
        return 1
    if given.what == "zip":
        pack(target, wheels[0])
        return 0
    return (check if given.what == "check" else check_all)(target, wheels[0])


if __name__ == "__main__":
    sys.exit(main())
