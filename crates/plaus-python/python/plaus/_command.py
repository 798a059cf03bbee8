"""The command `plaus`, which comes with the package."""

import sys

from plaus import _plaus


def main() -> int:
    """Does what the command line says, and gives the exit code."""
    return _plaus.command(["plaus", *sys.argv[1:]])


if __name__ == "__main__":
    sys.exit(main())
