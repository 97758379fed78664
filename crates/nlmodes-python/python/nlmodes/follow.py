"""A fold, a first touch or a mode at an energy, followed over a parameter of a scene."""

from __future__ import annotations

import json
import os
from pathlib import Path
from typing import Any

import numpy as np

from . import _native
from ._files import Scratch
from ._run import Scene, _overrides, _source
from ._table import Table


class FollowedCurve(Table):
    """A curve over a parameter: ``value`` of it, ``frequency_hz``, ``d_frequency_d_value``, amplitude, force, energy, a row a point."""

    name: str
    """What it is: a fold of the response at some frequency, a first touch, the mode."""
    ends: tuple[str, str]
    """Why it ends below and above."""
    complete: bool
    """Whether it goes from one end of the window to the other."""

    def __init__(self, content: bytes, rows: slice, about: dict[str, Any]) -> None:
        super().__init__(content, rows)
        self.name = about["name"]
        self.ends = tuple(about["ends"])
        self.complete = about["is_complete"]

    def __repr__(self) -> str:
        return f"<FollowedCurve of {len(self)} points: {self.name}>"


def follow(
    scene: Scene,
    over: str,
    between: tuple[float, float],
    *,
    of: str = "fold",
    level: float | None = None,
    energy_j: float | None = None,
    out: str | os.PathLike[str] | None = None,
    **overrides: Any,
) -> list[FollowedCurve]:
    """Follows the folds of a response, its first touches, or a mode at an energy over a parameter: the jump frequency over a gap.

    Parameters
    ----------
    scene
        Path, text or dictionary, as :func:`nlmodes.run` takes it.
    over, between
        Key of the parameter, whose value has to stand in the scene, and the values between which it is followed, in the unit of the key.
    of
        ``"fold"``, where a response over the frequency jumps; ``"touch"``, where it first touches a stop; ``"resonance"``, the phase resonance of a
        scene with one; or ``"mode"``, at ``energy_j``.
    level
        Level of the response or resonance, where the scene has several.
    energy_j
        Averaged kinetic energy of the mode, J.
    out
        Directory of ``follow.csv``, ``follow.json`` and figures; left out, they are not kept.
    overrides
        Values of the scene that are replaced, as in :func:`nlmodes.run`.

    Raises
    ------
    SceneError
        Scene or call are wrong, also where the scene has no such fold.
    RunError
        The scene cannot be computed.

    Examples
    --------
    >>> import nlmodes
    >>> rod = {
    ...     "structure": {
    ...         "kind": "rod", "length_m": 1.0, "elements": 4, "start": "clamped",
    ...         "material": {"youngs_modulus_pa": 210e9, "density_kg_m3": 7800.0}, "section": {"area_m2": 1e-4},
    ...     },
    ...     "contact": [{"at_m": 1.0, "direction": "axial", "side": "positive", "gap_m": 1e-3}],
    ...     "method": {"harmonics": 1},
    ...     "continuation": {"max_energy_ratio": 3.0},
    ... }
    >>> (curve,) = nlmodes.follow(rod, "contact.0.gap_m", (0.8e-3, 1.2e-3), of="mode", energy_j=60.0)
    >>> curve.complete
    True
    >>> bool(curve.frequency_hz[0] > curve.frequency_hz[-1])  # a narrower gap stiffens
    True
    """
    scratch = Scratch() if out is None else None
    place = scratch.path if scratch else Path(os.fspath(out))  # type: ignore[arg-type]
    window = (float(between[0]), float(between[1]))
    _native.follow(_source(scene), _overrides(overrides), of, over, window, (level, energy_j), place)
    content = (place / "follow.csv").read_bytes()
    about = json.loads((place / "follow.json").read_text(encoding="utf-8"))
    curve = Table(content)["curve"]
    curves = []
    for number, one in enumerate(about["curves"]):
        rows = np.flatnonzero(curve == number)
        own = slice(int(rows[0]), int(rows[-1]) + 1) if len(rows) else slice(0, 0)
        curves.append(FollowedCurve(content, own, one))
    return curves
