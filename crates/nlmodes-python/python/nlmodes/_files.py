"""Files of results."""

from __future__ import annotations

import json
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


def content(path: Path) -> bytes:
    """The bytes of a file."""
    try:
        return path.read_bytes()
    except OSError as error:
        raise RunError(f"{path} cannot be read: {error.strerror}") from None


def optional(path: Path) -> bytes | None:
    """The bytes of a file; None where there is none."""
    try:
        return path.read_bytes()
    except (FileNotFoundError, NotADirectoryError, IsADirectoryError):
        return None
    except OSError as error:
        raise RunError(f"{path} cannot be read: {error.strerror}") from None


def table(path: Path) -> dict[str, Any]:
    """The table of a JSON file; empty where there is none."""
    text = optional(path)
    if text is None:
        return {}
    try:
        found = json.loads(text)
    except ValueError as error:
        raise RunError(f"{path} is damaged: {error}") from None
    if not isinstance(found, dict):
        raise RunError(f"{path} is damaged")
    return found


def stamp(path: Path) -> tuple[int, int, int] | None:
    """What changes when a file is written anew; None where there is none."""
    try:
        found = path.stat()
    except OSError:
        return None
    return found.st_ino, found.st_mtime_ns, found.st_size
