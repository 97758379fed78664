"""What is raised and warned of."""

from __future__ import annotations

from collections.abc import Iterable
from typing import NamedTuple


class Mistake(NamedTuple):
    """One thing that is wrong with a scene."""

    line: int | None
    """Line of the file or text, from 1; None where it is about an override."""
    key: str | None
    """Path of the key, as ``contact.0.gap_m``."""
    title: str
    """What is wrong."""
    help: list[str]
    """What to do about it."""


class SceneError(ValueError):
    """The scene or the call is wrong: nothing was computed or written.

    As text it is what the command line says: every mistake with its line, what was found there, and what to do.

    >>> import nlmodes
    >>> try:
    ...     nlmodes.check("[structure]\\nkind = 'rot'")
    ... except nlmodes.SceneError as error:
    ...     print([mistake.key for mistake in error.mistakes if mistake.line == 2])
    ['structure.kind']
    """

    mistakes: tuple[Mistake, ...]
    """All that is wrong, in the order of the text."""

    def __init__(self, text: str, mistakes: Iterable[tuple[int | None, str | None, str, list[str]]] = ()) -> None:
        super().__init__(text)
        self.mistakes = tuple(Mistake(*mistake) for mistake in mistakes)

    def _first(self) -> Mistake | None:
        """The first mistake that has a place, or the first."""
        placed = (mistake for mistake in self.mistakes if mistake.key is not None)
        return next(placed, self.mistakes[0] if self.mistakes else None)

    @property
    def key(self) -> str | None:
        """Path of the key of the first mistake that has one, as ``contact.0.gap_m``."""
        first = self._first()
        return first.key if first else None

    @property
    def line(self) -> int | None:
        """Line of that mistake, from 1; None where it is about an override."""
        first = self._first()
        return first.line if first else None

    @property
    def help(self) -> str:
        """What to do about it."""
        first = self._first()
        return "; ".join(first.help) if first else ""


class RunError(RuntimeError):
    """The computation, or the directory of its results, failed: the scene is not to blame."""


class SceneWarning(UserWarning):
    """Something about a scene looks wrong, or should be known before its results are trusted."""
