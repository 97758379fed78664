"""Laws of force of springs and dampers, as functions."""

from __future__ import annotations

import hashlib
import struct
from collections.abc import Callable, Mapping
from typing import Any

_DEEPEST = 20
"""Deepest nesting that is looked at: a scene needs four, and what is nested more deeply is refused when it is read."""

_SAMPLES = [sign * 10.0 ** (k / 4.0) for k in range(-40, 1) for sign in (-1.0, 1.0)]


class Law:
    """A spring or damper whose force is a function of Python.

    It takes the place of the law of a ``[[spring]]`` of a scene that is a dictionary. ``force`` has no value at rest; ``slope`` is its derivative,
    which is compared with differences of ``force`` when both are first used. Each is called with one number, some thousand times a point.

    Parameters
    ----------
    force
        Force against the displacement in N, by the displacement in m; of a damper by the velocity in m/s.
    slope
        Its derivative, N/m or N s/m.
    velocity
        Whether both are of the velocity: a damper.

    Examples
    --------
    >>> import nlmodes
    >>> hardening = nlmodes.Law(lambda v: 1e9 * v**3, lambda v: 3e9 * v**2)
    >>> beam = {
    ...     "structure": {
    ...         "kind": "beam", "length_m": 0.7, "elements": 10, "start": "clamped",
    ...         "material": {"youngs_modulus_pa": 210e9, "density_kg_m3": 7800.0, "poissons_ratio": 0.3},
    ...         "section": {"width_m": 0.014, "height_m": 0.014},
    ...     },
    ...     "spring": [{"at_m": 0.7, "direction": "transverse", "law": hardening}],
    ...     "method": {"harmonics": 5},
    ...     "continuation": {"start_amplitude_m": 1e-4, "max_energy_ratio": 100.0},
    ... }
    >>> bool(nlmodes.run(beam).frequency_hz[-1] > 23.7)
    True
    """

    def __init__(self, force: Callable[[float], float], slope: Callable[[float], float], *, velocity: bool = False) -> None:
        for name, given in (("force", force), ("slope", slope)):
            if not callable(given):
                raise TypeError(f"{name} is {given!r}; a function of one number was expected")
        self.force = force
        self.slope = slope
        self.velocity = bool(velocity)

    def __repr__(self) -> str:
        return f"Law({self.force!r}, {self.slope!r}{', velocity=True' if self.velocity else ''})"

    def _name(self) -> str:
        """A name that another function does not have: results of other laws are results of another scene."""
        digest = hashlib.sha256(b"velocity" if self.velocity else b"displacement")
        for at in _SAMPLES:
            try:
                value = float(self.force(at))
            except (ArithmeticError, ValueError):
                value = float("nan")
            digest.update(struct.pack("<d", value))
        return f"{getattr(self.force, '__name__', 'law').strip('<>')}_{digest.hexdigest()[:12]}"


def taken_out(scene: Mapping[str, Any]) -> tuple[dict[str, Any], list[tuple[str, Any, Any, bool]]]:
    """A scene with the names of its laws in their place, and the laws."""
    found: dict[str, Law] = {}

    def without(value: Any, depth: int = 0) -> Any:
        if depth > _DEEPEST:
            return value
        if isinstance(value, Law):
            name = value._name()
            found[name] = value
            return {"function": name}
        if isinstance(value, Mapping):
            return {key: without(item, depth + 1) for key, item in value.items()}
        if isinstance(value, (list, tuple)):
            return [without(item, depth + 1) for item in value]
        return value

    plain = without(scene)
    return plain, [(name, law.force, law.slope, law.velocity) for name, law in found.items()]
