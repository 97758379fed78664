"""What is computed of a structure that is made of arrays."""

from __future__ import annotations

import os
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from . import _arguments
from ._files import Scratch
from ._result import Result
from ._run import Progress, check, run


class Analyses:
    """Analyses of a structure that writes itself as files and a scene."""

    def mode(
        self,
        mode: int = 1,
        harmonics: int | Sequence[int] = 5,
        *,
        max_energy_ratio: float | None = 10.0,
        modes: int | None = None,
        out: str | os.PathLike[str] | None = None,
        force: bool = False,
        progress: Progress = None,
        **overrides: Any,
    ) -> Result:
        """The conservative nonlinear mode that begins at linear mode ``mode``: its branch over energy, to ``max_energy_ratio`` times that at grazing.

        ``modes`` is the number of open modes that are retained, default those up to four times the highest harmonic; the others answer
        statically. ``out``, ``force`` and ``progress`` are those of :func:`nlmodes.run`, and ``overrides`` values of the scene:
        ``continuation__frequency_hz=[50.0, 80.0]``, ``method__contact_solver="lemke"``.
        """
        own: dict[str, Any] = {"method": {"mode": mode, "harmonics": harmonics}, "continuation": {"max_energy_ratio": max_energy_ratio}}
        if modes is not None:
            own["reduction"] = {"modes": modes}
        return self._run(own, out, force, progress, overrides)

    def damped_mode(
        self,
        damping: float | Sequence[float] | Mapping[str, float],
        frequency_hz: tuple[float, float],
        mode: int = 1,
        harmonics: int = 5,
        *,
        max_energy_ratio: float = 10.0,
        out: str | os.PathLike[str] | None = None,
        force: bool = False,
        progress: Progress = None,
        **overrides: Any,
    ) -> Result:
        """The damped nonlinear mode that begins at linear mode ``mode`` (extended periodic motion concept), with ``damping_ratio`` a column.

        ``damping`` is the ratio of all modes, a list by mode, or ``{"mass_1_s": α, "stiffness_s": β}`` of Rayleigh; ``frequency_hz`` the window.
        """
        own = {
            "method": {"mode": mode, "harmonics": harmonics},
            "continuation": {"max_energy_ratio": max_energy_ratio},
            "damping": _damping(damping),
            "response": [{"kind": "damped-mode", "frequency_hz": list(frequency_hz)}],
        }
        return self._run(own, out, force, progress, overrides)

    def _response(
        self,
        place: Mapping[str, Any],
        levels_n: float | Sequence[float],
        frequency_hz: float | tuple[float, float],
        damping: float | Sequence[float] | Mapping[str, float],
        kind: str,
        method: Mapping[str, Any],
        response: Mapping[str, Any] | None,
    ) -> dict[str, Any]:
        """The tables of a response to a force at ``place``."""
        levels = [_arguments.number("levels_n", level, above=0.0) for level in np.atleast_1d(np.asarray(levels_n)).tolist()]
        table = {"kind": _arguments.text("kind", kind, ("frequency", "force", "phase-resonance")), "levels_n": levels}
        table["frequency_hz"] = np.asarray(frequency_hz, dtype=float).tolist()
        return {
            "method": dict(method),
            "continuation": {},
            "damping": _damping(damping),
            "force": [{**place, "amplitude_n": levels[0]}],
            "response": [{**table, **dict(response or {})}],
        }

    def check(self, **tables: Any) -> list[str]:
        """Whether :meth:`mode` would begin; returns what looks wrong."""
        scratch = Scratch()
        own = {"method": {"mode": 1, "harmonics": 5}, "continuation": {"max_energy_ratio": 2.0}}
        return check(self._scene(scratch.path, own), **tables)

    def save(self, folder: str | os.PathLike[str], **tables: Any) -> Path:
        """Writes the structure and ``scene.toml`` for the command line into a new directory; returns the scene.

        ``tables`` are those of the scene: ``method={"harmonics": 5}``, ``continuation={"max_energy_ratio": 10.0}``, …
        """
        from . import _native

        place = Path(folder)
        place.mkdir(parents=True)
        own = {"method": {"mode": 1, "harmonics": 5}, "continuation": {"max_energy_ratio": 10.0}, **tables}
        scene = self._scene(place, own)
        own_files = {name: value for name, value in scene["structure"].items() if str(value).startswith(str(place))}
        scene["structure"].update({name: Path(value).name for name, value in own_files.items()})
        path = place / "scene.toml"
        path.write_text(_native.toml_of(scene), encoding="utf-8")
        return path

    def _run(
        self, own: dict[str, Any], out: str | os.PathLike[str] | None, force: bool, progress: Progress, overrides: Mapping[str, Any]
    ) -> Result:
        model = Scratch()
        return run(self._scene(model.path, own), out=out, force=force, progress=progress, **overrides)

    def _scene(self, place: Path, own: Mapping[str, Any]) -> dict[str, Any]:
        """A scene of the files that it writes."""
        raise NotImplementedError


def _damping(given: float | Sequence[float] | Mapping[str, float]) -> dict[str, Any]:
    """The table ``[damping]``."""
    if isinstance(given, Mapping):
        return {"rayleigh": {key: _arguments.number(f"damping[{key!r}]", value) for key, value in given.items()}}
    if np.ndim(given) == 0:
        return {"ratio": _arguments.number("damping", given)}
    return {"ratios": _arguments.floats("damping", given, ("modes",)).tolist()}
