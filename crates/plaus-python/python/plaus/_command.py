"""The command `plaus`, which comes with the package."""

import sys

from plaus import _plaus


def main() -> int:
    """Runs the command line, and returns the exit code."""
    return _plaus.command(["plaus", *sys.argv[1:]])


if __name__ == "__main__":
    sys.exit(main())
