"""The command ``pcc``: ``python -m pcc`` works where another program has that name."""

from __future__ import annotations

import sys

from ._pcc import main as _main


def main() -> int:
    """Run the command line with the arguments of this process; its exit code."""
    return _main(sys.argv[1:])


if __name__ == "__main__":
    sys.exit(main())
