"""A virtual environment of a check's own, with the packages it needs."""

import subprocess
import sys
from pathlib import Path

# Exit code of a check that could not install what it needs.
NO_REGISTRY = 77
# A registry that is out of reach is known to be so within about a minute, also where it does not even refuse; pip's own patience is for several.
PATIENCE = ["--retries", "2", "--timeout", "10"]


def environment(folder: Path, requirements: list[str]) -> Path:
    """The environment's Python, with everything installed."""
    python = folder / "bin" / "python"
    stamp = folder / "installed.txt"
    wanted = "\n".join(requirements)
    if stamp.exists() and stamp.read_text() == wanted and python.exists():
        return python
    print(f"installing {', '.join(requirements)} into {folder}", flush=True)
    made = subprocess.run([sys.executable, "-m", "venv", "--clear", str(folder)])
    if made.returncode != 0:
        print("python3 -m venv failed", flush=True)
        sys.exit(NO_REGISTRY)
    pip = [str(python), "-m", "pip", "install", "--quiet", "--disable-pip-version-check", *PATIENCE, *requirements]
    if subprocess.run(pip).returncode != 0:
        print("pip could not install them: is the package registry out of reach?", flush=True)
        sys.exit(NO_REGISTRY)
    stamp.write_text(wanted)
    return python
