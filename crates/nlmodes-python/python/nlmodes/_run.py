"""Runs of scenes."""

from __future__ import annotations

import json
import os
import sys
import warnings
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any, TypeAlias

from . import _native
from ._errors import SceneWarning
from ._files import Scratch
from ._result import Result
from .law import taken_out

Scene: TypeAlias = str | os.PathLike[str] | Mapping[str, Any]
"""A scene: path of a TOML file, text of one (with a line break in it), or a dictionary of its tables."""

Progress: TypeAlias = bool | Callable[[int, float | None, str], object] | None
"""Whether a progress bar is shown, or the function to be called instead."""


def _source(scene: Scene) -> tuple[str, str] | Path:
    if isinstance(scene, Mapping):
        return "scene", _native.toml_of(dict(scene))
    if isinstance(scene, str) and "\n" in scene:
        return "scene", scene
    try:
        path = os.fspath(scene)
    except TypeError:
        kind = type(scene).__name__
        raise TypeError(f"scene is a {kind}; a path, the text of a scene or a dictionary was expected") from None
    if not isinstance(path, str):
        raise TypeError("scene is a path of bytes; a text was expected")
    if "\0" in path:
        raise ValueError("scene is a path with a null character")
    return Path(path)


def _overrides(given: Mapping[str, Any], prefix: str = "") -> list[str]:
    found = []
    for name, value in given.items():
        key = prefix + str(name).replace("__", ".")
        if isinstance(value, Mapping):
            found += _overrides(value, key + ".")
        else:
            found.append(_native.override_of(key, value))
    return found


class _Bar:
    """A bar of tqdm, made when there is something to show."""

    def __init__(self, make: Callable[..., Any]) -> None:
        self.make = make
        self.options: dict[str, Any] = {"unit": " points", "leave": False}
        self.bar: Any = None

    def __call__(self, points: int, frequency_hz: float | None, text: str) -> None:
        if self.bar is None:
            self.bar = self.make(**self.options)
        self.bar.update(points - self.bar.n)
        at = "" if frequency_hz is None else f"{frequency_hz:.6g} Hz"
        self.bar.set_postfix_str(", ".join(part for part in (at, text) if part))

    def close(self) -> None:
        if self.bar is not None:
            self.bar.close()


def _progress(wanted: Progress) -> Callable[[int, float | None, str], object] | None:
    if callable(wanted):
        return wanted
    shown = sys.stderr is not None and sys.stderr.isatty()
    if wanted is False or (wanted is None and not shown and "ipykernel" not in sys.modules):
        return None
    try:
        from tqdm.auto import tqdm
    except ImportError:
        if wanted:
            raise ImportError("progress=True needs tqdm: pip install tqdm") from None
        return None
    return _Bar(tqdm)


def run(
    scene: Scene,
    *,
    out: str | os.PathLike[str] | bool | None = None,
    resume: bool = False,
    force: bool = False,
    progress: Progress = None,
    memory_limit: str | None = None,
    **overrides: Any,
) -> Result:
    """Computes what a scene describes: branches of a structure, modal points of records, or a virtual test.

    Parameters
    ----------
    scene
        Path of a TOML file, its text, or a dictionary of its tables, in which the law of a spring may be a :class:`nlmodes.Law`.
        ``nlmodes.schema()`` has every key with unit, limits and default.
    out
        Directory of the files. Left out: the one that the scene names; for a file that names none ``results/<name of the file>``, for a
        text or a dictionary a temporary one that goes with the result, which ``out=False`` asks for in any case.
    resume, force
        Go on with an interrupted run of the same scene; overwrite results of another one.
    progress
        True or False for a bar of tqdm, default on a terminal or in a notebook; or a function of the number of points, the frequency of the
        last one (Hz or None) and a text. What it raises ends the run and is raised.
    memory_limit
        Most memory that the run may take, as ``"8GiB"``; default three quarters of the machine's.
    overrides
        Values of the scene that are replaced or added: ``method={"harmonics": 5}`` or ``method__harmonics=5``; with a number in the path
        ``**{"contact.0.gap_m": 1e-3}``.

    Raises
    ------
    SceneError
        Scene or call are wrong: with key, line, and what to do.
    RunError
        There are no results. A branch that ends early is none: see ``Branch.complete`` and ``Branch.ended_because``.
    KeyboardInterrupt
        Ctrl-C ends the run within the step. What was found is in the directory; ``resume=True`` goes on from there.

    Examples
    --------
    >>> import nlmodes
    >>> rod = {
    ...     "structure": {
    ...         "kind": "rod", "length_m": 1.0, "elements": 8, "start": "clamped",
    ...         "material": {"youngs_modulus_pa": 210e9, "density_kg_m3": 7800.0}, "section": {"area_m2": 1e-4},
    ...     },
    ...     "contact": [{"at_m": 1.0, "direction": "axial", "side": "positive", "gap_m": 1e-3}],
    ...     "method": {"harmonics": 3},
    ...     "continuation": {"max_energy_ratio": 3.0},
    ... }
    >>> result = nlmodes.run(rod)
    >>> result.complete, result.frequency_hz.dtype
    (True, dtype('float64'))
    >>> round(float(result.energy_j[-1] / result.energy_j[0]), 6)
    3.0
    >>> nlmodes.run(rod, method__harmonics=5).branches[0].coefficients.shape[2]
    6
    """
    laws: list[tuple[str, Any, Any, bool]] = []
    if isinstance(scene, Mapping):
        scene, laws = taken_out(scene)
    source = _source(scene)
    if resume and force:
        raise ValueError("resume and force exclude each other")
    over = "resume" if resume else "force" if force else "same"
    if out is True:
        raise TypeError("out is True; a directory, False or None was expected")
    scratch = Scratch() if out is False or (out is None and isinstance(source, tuple)) else None
    place = scratch.path if scratch else None
    directory = place if out is False else None if out is None else Path(out)
    shown = _progress(progress)
    try:
        outcome = _native.run(source, _overrides(overrides), directory, place, over, memory_limit, shown, laws)
    finally:
        if isinstance(shown, _Bar):
            shown.close()
    for text in outcome.warnings:
        warnings.warn(text, SceneWarning, stacklevel=2)
    written = outcome.directory
    if scratch is not None and written != place:
        scratch.remove()
        scratch = None
    return Result(written, outcome, scratch)


def check(scene: Scene, **overrides: Any) -> list[str]:
    """Whether a run of the scene would begin; returns what looks wrong with it, and computes no more than linear modes.

    Raises :class:`nlmodes.SceneError` or :class:`nlmodes.RunError` where it would not.
    """
    return _native.check(_source(scene), _overrides(overrides))


def linear_frequencies(scene: Scene, **overrides: Any) -> dict[str, list[float] | None]:
    """Lowest linear frequencies of the structure of a scene, Hz.

    ``mass_kept``: contacts open, all mass; ``mass_redistributed``: contacts open, mass of the contacts as the method has it; ``contacts_held``; ``about_rest``: the contacts closed that press at rest, None where none does.
    """
    return _native.linear_frequencies(_source(scene), _overrides(overrides))


def schema() -> dict[str, Any]:
    """The JSON schema of a scene: every key with its meaning, unit, limits and default."""
    found: dict[str, Any] = json.loads(_native.schema())
    return found


def columns() -> str:
    """What every file of results, its columns and arrays mean, with units and signs."""
    return _native.columns()
