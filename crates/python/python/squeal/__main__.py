"""The program: ``squeal`` and ``python -m squeal``."""

import signal
import sys

from squeal import _squeal


def main() -> None:
    """Run the program with the arguments of the command line, and exit with its code."""
    # An interrupt ends it at once; what it keeps is at most five seconds old.
    signal.signal(signal.SIGINT, signal.SIG_DFL)
    sys.exit(_squeal.main(["squeal", *sys.argv[1:]]))


if __name__ == "__main__":
    main()
