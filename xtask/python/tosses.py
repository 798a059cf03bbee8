"""First state and last pose of each published toss of a real cube, as CSV: the content of
xtask/figures/data/tosses/tosses.csv.

    python3 xtask/python/tosses.py FOLDER > xtask/figures/data/tosses/tosses.csv

FOLDER is `data` of https://github.com/DAIRLab/contact-nets (commit c3dc21c): it has `tosses_processed/*.pt` and
`params_processed/experiment.json`. A file holds one table with one row for each frame: position (3),
quaternion with the real part first (4), velocity (3), angular velocity in the body's axes (3), six zeros. Lengths there
are in half widths of the cube; here they are in metres. Needs only Python: PyTorch's old format is a few pickles
followed by the numbers.
"""

import array
import json
import pickle
import sys
from pathlib import Path

HALF_WIDTH = 0.0524
COLUMNS = 19
POSE = ["x", "y", "z", "qw", "qx", "qy", "qz"]
RATES = ["vx", "vy", "vz", "wx", "wy", "wz"]


class Reader(pickle.Unpickler):
    """Reads the shape of a tensor; builds none of the objects that a pickle names."""

    def find_class(self, module, name):
        if (module, name) == ("torch._utils", "_rebuild_tensor_v2"):
            return lambda storage, offset, size, stride, *rest: (storage, offset, size, stride)
        if (module, name) == ("torch", "DoubleStorage"):
            return name
        if (module, name) == ("collections", "OrderedDict"):
            return dict
        raise pickle.UnpicklingError(f"unexpected {module}.{name}")

    def persistent_load(self, saved):
        return saved[1]


def rows(path):
    """The frames of a toss."""
    with path.open("rb") as file:
        for _ in range(3):  # a magic number, the version, the machine
            Reader(file).load()
        storage, offset, size, stride = Reader(file).load()
        Reader(file).load()  # the names of storages
        count = int.from_bytes(file.read(8), sys.byteorder)
        numbers = array.array("d", file.read(8 * count))
    size = size[-2:]
    if storage != "DoubleStorage" or offset != 0 or size[1] != COLUMNS or stride[-2:] != (COLUMNS, 1):
        raise ValueError(f"{path}: not a table of {COLUMNS} doubles a row")
    return [numbers[k * COLUMNS : (k + 1) * COLUMNS] for k in range(size[0])]


def state(row):
    """Position, quaternion, velocity, angular velocity; with metres as the unit of length, to six decimals."""
    scaled = [n * HALF_WIDTH for n in row[:3]] + list(row[3:7]) + [n * HALF_WIDTH for n in row[7:10]] + list(row[10:13])
    return [f"{n:.6f}" for n in scaled]


def main(folder):
    step = json.loads((folder / "params_processed" / "experiment.json").read_text())["dt"]
    names = [f"first_{name}" for name in POSE + RATES] + [f"last_{name}" for name in POSE]
    print(",".join(["toss", "seconds", *names]))
    files = sorted((folder / "tosses_processed").glob("*.pt"), key=lambda path: int(path.stem))
    for path in files:
        frames = rows(path)
        first, last = state(frames[0]), state(frames[-1])
        print(",".join([path.stem, f"{(len(frames) - 1) * step:.6f}", *first, *last[: len(POSE)]]))


if __name__ == "__main__":
    if len(sys.argv) != 2:
        sys.exit(__doc__)
    main(Path(sys.argv[1]))
