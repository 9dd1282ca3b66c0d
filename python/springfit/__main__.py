"""The program, as ``springfit`` and as ``python -m springfit``."""

from __future__ import annotations

import signal
import sys

from ._core import command_line


def main() -> int:
    """Runs the command line of this process.

    Returns:
        The exit code.
    """
    # The program answers interrupts itself, unless they are ignored.
    if signal.getsignal(signal.SIGINT) is signal.default_int_handler:
        signal.signal(signal.SIGINT, signal.SIG_DFL)
    return command_line(sys.argv[1:])


if __name__ == "__main__":
    sys.exit(main())
