"""Places of bodies from `plaus export --format poses`, to be compared with where a program puts them."""

import csv
import math

# Slightly more than a hundredth of a frame of 1/24 s, in s.
CROWDED = 4.5e-4


class Truth:
    """Poses at many times. Between these, poses follow from parabolas and even turning. The table has 960 rows per
    second, so the error of that is a hundred times smaller than the allowed error."""

    def __init__(self, path):
        self.bodies, self.impacts = {}, {}
        with open(path, newline="") as table:
            for row in csv.DictReader(table):
                numbers = [float(row[name]) for name in ("t", "x", "y", "z", "qw", "qx", "qy", "qz")]
                self.bodies.setdefault(row["body"], []).append(numbers)
                if row["impact"] == "true":
                    self.impacts.setdefault(row["body"], []).append(numbers[0])
        self.end = max(rows[-1][0] for rows in self.bodies.values())

    def is_crowded(self, body, time):
        """Whether impacts here are so close that Blender takes them for one key: within a hundredth of a frame."""
        near = [impact for impact in self.impacts.get(body, []) if abs(impact - time) < 2 * CROWDED]
        return len(near) > 1

    def at(self, body, time):
        rows = self.bodies[body]
        low, high = 0, len(rows) - 1
        while high - low > 1:
            middle = (low + high) // 2
            if rows[middle][0] <= time:
                low = middle
            else:
                high = middle
        a, b = rows[low], rows[high]
        share = (time - a[0]) / (b[0] - a[0]) if b[0] > a[0] else 0.0
        place = [p + share * (q - p) for p, q in zip(a[1:4], b[1:4])]
        sign = 1.0 if sum(p * q for p, q in zip(a[4:], b[4:])) >= 0.0 else -1.0
        turn = [p + share * (sign * q - p) for p, q in zip(a[4:], b[4:])]
        return place, turn


def angle(a, b):
    """Degrees between two orientations, given as (w, x, y, z) of any length."""
    size = math.hypot(*a) * math.hypot(*b)
    return 2.0 * math.degrees(math.acos(min(1.0, abs(sum(p * q for p, q in zip(a, b))) / size)))
