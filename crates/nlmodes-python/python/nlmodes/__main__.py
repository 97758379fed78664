"""``python -m nlmodes`` is the command line."""

from ._command import main

main("python -m nlmodes")
