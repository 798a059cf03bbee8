#!/usr/bin/env python3
"""Whether workflows are safe, as zizmor sees them: lint_workflows.py --venv V FOLDER. Offline."""

import argparse
import subprocess
import sys
from pathlib import Path

from environment import environment

if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--venv", type=Path, required=True)
    parser.add_argument("folder", type=Path)
    given = parser.parse_args()
    python = environment(given.venv, ["zizmor==1.32.0"])
    sys.exit(subprocess.run([python.with_name("zizmor"), "--offline", "--no-progress", given.folder]).returncode)
