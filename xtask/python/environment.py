"""A virtual environment for one check, with the packages it needs."""

import os
import shutil
import subprocess
import sys
from pathlib import Path

# Exit code of a check that could not install what it needs.
NO_REGISTRY = 77
# Finds out within about a minute that a registry is out of reach, even if it does not answer at all; pip alone would
# wait for several minutes.
PATIENCE = ["--retries", "2", "--timeout", "10"]


def pythons(names: list[str]) -> list[str]:
    """The Pythons with these names that can be run here, from the PATH or from pyenv: one for each name."""
    root = Path(os.environ.get("PYENV_ROOT", Path.home() / ".pyenv"))
    found = []
    for name in names:
        on_path = shutil.which(name)
        places = [on_path] if on_path else []
        places += sorted(str(path) for path in root.glob(f"versions/*/bin/{name}"))
        # A shim may be there without a Python behind it.
        runs = (path for path in places if subprocess.run([path, "-c", ""], capture_output=True).returncode == 0)
        found += [path for path in [next(runs, None)] if path]
    return found


def environment(folder: Path, requirements: list[str], base: str = sys.executable) -> Path:
    """The environment's Python, made by `base`, with everything installed."""
    python = folder / ("Scripts/python.exe" if os.name == "nt" else "bin/python")
    stamp = folder / "installed.txt"
    wanted = "\n".join(requirements)
    if stamp.exists() and stamp.read_text() == wanted and python.exists():
        return python
    print(f"installing {', '.join(requirements)} into {folder}", flush=True)
    made = subprocess.run([base, "-m", "venv", "--clear", str(folder)])
    if made.returncode != 0:
        print("python3 -m venv failed", flush=True)
        sys.exit(NO_REGISTRY)
    pip = [str(python), "-m", "pip", "install", "--quiet", "--disable-pip-version-check", *PATIENCE, *requirements]
    if subprocess.run(pip).returncode != 0:
        print("pip could not install them: is the package registry out of reach?", flush=True)
        sys.exit(NO_REGISTRY)
    stamp.write_text(wanted)
    return python
