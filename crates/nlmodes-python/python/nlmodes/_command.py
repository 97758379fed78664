"""The command line: ``nlmodes`` and ``nlmodes-cli`` on the path, and ``python -m nlmodes``."""

import sys

from ._native import command


def main(name: str | None = None) -> None:
    """Executes the arguments of the process as a command, and ends the process with its status."""
    sys.exit(command([name or sys.argv[0], *sys.argv[1:]]))
