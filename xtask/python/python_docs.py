#!/usr/bin/env python3
"""The Python package's interface as pages, from its sources and the stubs of its compiled part: python_docs.py --venv V OUT.
Nothing is compiled: the stubs stand for the extension, which a test of the wheel compares with them."""

import __future__
import argparse
import importlib.util
import os
import subprocess
import sys
import types
from pathlib import Path

from environment import environment

REQUIREMENTS = ["pdoc==16.0.0", "numpy==2.4.6", "xarray==2026.9.0"]
PACKAGE = Path(__file__).resolve().parents[2] / "crates" / "plaus-python" / "python"


def stand_in() -> types.ModuleType:
    """The compiled part, as its stubs say that it is."""
    stubs = PACKAGE / "plaus" / "_plaus.pyi"
    module = types.ModuleType("plaus._plaus")
    module.__file__ = os.fspath(stubs)
    module.__version__ = "stubs"
    flags = __future__.annotations.compiler_flag
    exec(compile(stubs.read_text(encoding="utf-8"), stubs, "exec", flags=flags, dont_inherit=True), module.__dict__)
    return module


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--venv", type=Path, help="folder of the virtual environment, made where it is missing")
    parser.add_argument("out", type=Path)
    given = parser.parse_args()
    if given.venv:
        python = environment(given.venv, REQUIREMENTS)
        return subprocess.run([python, __file__, os.fspath(given.out)]).returncode
    import pdoc

    sys.path.insert(0, os.fspath(PACKAGE))
    sys.modules["plaus._plaus"] = stand_in()
    pdoc.render.configure(docformat="markdown", show_source=False)
    pdoc.pdoc("plaus", "plaus.sim", "!plaus._plaus", output_directory=given.out)
    return 0


if __name__ == "__main__":
    sys.exit(main())
