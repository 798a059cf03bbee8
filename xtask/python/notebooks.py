#!/usr/bin/env python3
"""Runs notebooks from their first cell to their last, each in a folder of its own; says which cell failed, and how."""

import sys
import tempfile
import time
from pathlib import Path

import nbformat
from nbclient import NotebookClient
from nbclient.exceptions import CellExecutionError


def main() -> int:
    wrong = 0
    for path in sorted(Path(sys.argv[1]).glob("*.ipynb")):
        notebook = nbformat.read(path, as_version=4)
        nbformat.validate(notebook)
        begun = time.perf_counter()
        with tempfile.TemporaryDirectory() as place:
            client = NotebookClient(
                notebook, timeout=120, kernel_name="python3", resources={"metadata": {"path": place}}
            )
            try:
                client.execute()
            except CellExecutionError as error:
                print(f"{path.name}: FAILED\n{error}")
                wrong += 1
                continue
        shown = sum(len(cell.get("outputs", [])) for cell in notebook.cells if cell.cell_type == "code")
        print(f"{path.name}: {shown} outputs in {time.perf_counter() - begun:.1f} s", flush=True)
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
