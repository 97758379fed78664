"""Modal points of measured records that are in memory. Records in files: a scene with ``[recording]`` and :func:`nlmodes.run`."""

from __future__ import annotations

import warnings
from collections.abc import Iterable, Mapping, Sequence
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _arguments, _native
from ._errors import SceneWarning
from ._table import Table


class Finding(NamedTuple):
    """Something that a careful experimenter wants to know."""

    name: str
    """``clipped``, ``frequency-drift``, ``reversed-force``, …"""
    text: str
    """The same as a sentence, with its numbers."""


class Extraction(Table):
    """Modal points, a row a record: the columns of ``modal_points.csv``, each with its standard error in ``…_uncertainty``."""

    findings: list[list[Finding]]
    """What was found in each record; of one that gives no point, why not."""

    def __init__(self, content: bytes, findings: Iterable[Iterable[tuple[str, str]]]) -> None:
        super().__init__(content)
        self.findings = [[Finding(*told) for told in record] for record in findings]

    def __repr__(self) -> str:
        names = sorted({finding.name for record in self.findings for finding in record})
        return f"<Extraction of {len(self)} record{'s' * (len(self) != 1)}; findings: {' '.join(names) or 'none'}>"


def extract(
    records: ArrayLike | Mapping[str, Any],
    sample_rate_hz: float,
    channels: Sequence[Mapping[str, Any]],
    *,
    linear_modes: Mapping[str, Any] | None = None,
    structure: Mapping[str, Any] | None = None,
    stop: Mapping[str, float] | None = None,
    **extraction: Any,
) -> Extraction:
    """Turns records into points of a nonlinear mode: frequency, amplitude, damping, power-based mode indicator, contact force.

    Parameters
    ----------
    records
        One record (channels, samples), or several by their names; a row for each of ``channels``, in their units.
    sample_rate_hz
        Sampling rate, Hz.
    channels
        What was measured: dictionaries with ``name``, ``quantity`` ("force", "displacement", "velocity", "acceleration", "phase"), ``unit``,
        ``role`` ("excitation", "drive-point", "response", "contact", "excitation-phase"), and where they have them ``position_m``, ``sign``,
        ``sensitivity``, ``delay_s``, ``range``: as ``[[channel]]`` of a scene.
    linear_modes, structure, stop
        Tables of a scene: mass-normalised linear modes at the sensors, or the structure to compute them from; and where the stop is.
    extraction
        Keys of ``[extraction]``: ``mode``, ``periods``, ``harmonics``, ``pbmif_harmonics``, ``frequency_hz``.

    Examples
    --------
    >>> import numpy as np
    >>> from nlmodes import experiment
    >>> t = np.arange(2500) / 5000.0
    >>> velocity = np.cos(251.3 * t) + 0.5 * np.cos(2 * 251.3 * t)
    >>> found = experiment.extract([np.cos(251.3 * t), velocity], 5000.0, [
    ...     {"name": "force", "quantity": "force", "unit": "N", "role": "excitation", "position_m": 0.0},
    ...     {"name": "v", "quantity": "velocity", "unit": "m/s", "role": "drive-point", "position_m": 0.0},
    ... ], pbmif_harmonics=10)
    >>> bool(abs(found.pbmif[0] - 1 / np.sqrt(1.25)) < 1e-6)
    True
    """
    rate = _arguments.number("sample_rate_hz", sample_rate_hz, above=0.0)
    if isinstance(channels, (str, bytes, Mapping)) or not all(isinstance(channel, Mapping) for channel in channels):
        raise TypeError("channels: a list of dictionaries was expected, one for each channel")
    names = [str(channel.get("name", "")) for channel in channels]
    if not names:
        raise ValueError("channels is empty")
    several = dict(records) if isinstance(records, Mapping) else {"record": records}
    if not several:
        raise ValueError("records is empty")
    arrays = [(str(name), _rows(f"records[{name!r}]" if isinstance(records, Mapping) else "records", given, names)) for name, given in several.items()]
    scene = {
        "recording": {"files": [name for name, _ in arrays], "sample_rate_hz": rate},
        "channel": [dict(channel) for channel in channels],
        "linear_modes": None if linear_modes is None else dict(linear_modes),
        "structure": None if structure is None else dict(structure),
        "stop": None if stop is None else dict(stop),
        "extraction": dict(extraction) or None,
    }
    content, findings, warned = _native.extract(_native.toml_of(scene), arrays)
    for text in warned:
        warnings.warn(text, SceneWarning, stacklevel=2)
    return Extraction(content, findings)


def _rows(what: str, given: Any, names: list[str]) -> list[tuple[str, NDArray[np.float64]]]:
    array = _arguments.floats(what, given, (len(names), "samples"), finite=False)
    return list(zip(names, array, strict=True))
