"""Files of results."""

from __future__ import annotations

import json
import os
import shutil
import weakref
from pathlib import Path
from tempfile import mkdtemp
from typing import Any

from ._errors import RunError


class Scratch:
    """A directory that goes with what refers to it."""

    def __init__(self) -> None:
        self.path = Path(mkdtemp(prefix="nlmodes-")).resolve()
        self.remove = weakref.finalize(self, shutil.rmtree, self.path, True)


def content(folder: Path, name: str) -> bytes:
    """The bytes of a file in a directory."""
    found = optional(folder, name)
    if found is None:
        raise RunError(f"there is no file {folder / name}")
    return found


def optional(folder: Path, name: str) -> bytes | None:
    """The bytes of a file in a directory; None where there is none."""
    try:
        # All at once: without a buffer, and without an object for the path.
        with open(os.path.join(folder, name), "rb", buffering=0) as file:
            return file.readall()
    except (FileNotFoundError, NotADirectoryError, IsADirectoryError):
        return None
    except OSError as error:
        raise RunError(f"{folder / name} cannot be read: {error.strerror}") from None


def table(folder: Path, name: str) -> dict[str, Any]:
    """The table of a JSON file in a directory; empty where there is none."""
    text = optional(folder, name)
    if text is None:
        return {}
    try:
        found = json.loads(text)
    except ValueError as error:
        raise RunError(f"{folder / name} is damaged: {error}") from None
    if not isinstance(found, dict):
        raise RunError(f"{folder / name} is damaged")
    return found


def stamp(folder: Path, name: str) -> tuple[int, int, int] | None:
    """What changes when a file in a directory is written anew; None where there is none."""
    try:
        found = os.stat(os.path.join(folder, name))
    except OSError:
        return None
    return found.st_ino, found.st_mtime_ns, found.st_size
