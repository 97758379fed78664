"""Branches of results."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from . import _arguments, _files, _native
from ._errors import RunError
from ._table import Table

if TYPE_CHECKING:
    from matplotlib.axes import Axes

_HARMONICS = "harmonics.npz"
LABELS = {
    "energy_j": "averaged kinetic energy / J",
    "total_energy_j": "energy / J",
    "frequency_hz": "frequency / Hz",
    "modal_amplitude": "modal amplitude / (m √kg)",
    "force_n": "force / N",
    "drive_fundamental_m": "fundamental of the drive point / m",
    "fundamental_m": "fundamental of the first contact / m",
    "peak_contact_force_n": "largest contact force / N",
    "impulse_ns": "impulse of all contacts over a period / (N s)",
    "contact_fraction": "share of the period in contact",
    "damping_ratio": "damping ratio",
}


class History(NamedTuple):
    """Motion and force of a contact over one period, exact at the contact."""

    time_s: NDArray[np.float64]
    displacement_m: NDArray[np.float64]
    velocity_m_s: NDArray[np.float64]
    acceleration_m_s2: NDArray[np.float64]
    force_n: NDArray[np.float64]
    stop_m: float
    """Signed position of the stop."""
    instants: list[tuple[float, bool]]
    """Instants at which the contact closes (True) or opens (False), s."""


class Motion(NamedTuple):
    """Displacements over one period."""

    time_s: NDArray[np.float64]
    """(samples,)"""
    displacement: NDArray[np.float64]
    """(samples, coordinates), m, rotations in rad."""


class Verification(NamedTuple):
    """What is missing after one period of the full structure; shares of the largest value, but for the units in names."""

    modes: int
    """Modes of the full structure."""
    period_s: float
    energy_j: float
    energy_norm: float
    """Missing in the energy norm, over the root of the energy."""
    displacement: float
    velocity: float
    energy_drift: float
    peak_contact_force_n: float
    contact_intervals: int
    contact_fraction: list[float]
    """Share of the period in which each contact is closed."""
    exact: dict[str, Any] | None
    """The exact motion beside the point: ``frequency_hz``, ``largest_multiplier``, ``stable``; or why it was ``not_found``."""


def verification(folder: Path, point: int) -> Verification:
    """That of a point of the branch in a directory."""
    return Verification(**_native.verify(folder, _arguments.count("point", point)))


class Origin(NamedTuple):
    """Where a branch comes from within a run of this process."""

    outcome: _native.Outcome
    scratch: _files.Scratch | None
    part: int
    branch: int


class Branch(Table):
    """A branch: a row a point, in the order in which the points were found.

    Columns are those of ``branch.csv``: ``frequency_hz``, ``energy_j``, ``peak_contact_force_n``, ``event``, …
    """

    folder: Path
    """Directory of its files."""
    label: str
    """Name in legends."""
    ended_because: str
    """Why it has no further points."""
    end_reason: str
    """The same in a word: ``max-energy``, ``frequency-window``, ``max-points``, ``no-step``, …"""
    complete: bool
    """Whether it ended at a limit that was asked for."""

    def __init__(
        self,
        folder: Path,
        label: str,
        end: dict[str, Any] | None,
        origin: Origin | None = None,
        rows: slice | None = None,
    ) -> None:
        super().__init__(_files.content(folder, "branch.csv"), rows)
        self.folder = folder
        self.label = label
        self.end_reason = end["reason"] if end else "cut-off"
        self.ended_because = end["message"] if end else "the run was cut off before it wrote a summary"
        self.complete = bool(end and end["complete"])
        self._origin = origin
        self._stamp = _files.stamp(folder, _HARMONICS)
        self._harmonics: dict[str, NDArray[Any]] = {}
        self._stops = _files.optional(folder, "contacts.csv")

    def __repr__(self) -> str:
        return f"<Branch {self.label!r}: {len(self)} points; ended: {self.ended_because}>"

    def _array(self, name: str) -> NDArray[Any]:
        if name not in self._harmonics:
            path = self.folder / _HARMONICS
            if self._stamp is None:
                raise RunError(f"there is no {path}: the run did not come to its end")
            if _files.stamp(self.folder, _HARMONICS) != self._stamp:
                raise RunError(f"{path} was written anew since this branch was read")
            with np.load(path) as archive:
                self._harmonics = {key: archive[key] for key in archive.files}
            for array in self._harmonics.values():
                array.flags.writeable = False
        return self._harmonics[name]

    @property
    def coefficients(self) -> NDArray[np.complex128]:
        """Fourier coefficients (points, coordinates, harmonics + 1): q(t) = Re Σ c_n exp(i n ω t), m or rad."""
        return self._array("coefficients")[self._rows]

    @property
    def omega(self) -> NDArray[np.float64]:
        """Angular frequency (points,), rad/s."""
        return self._array("omega")[self._rows]

    @property
    def positions_m(self) -> NDArray[np.float64]:
        """Where the coordinates are (coordinates,), m."""
        return self._array("dof_position_m")

    @property
    def kinds(self) -> NDArray[np.str_]:
        """What the coordinates are (coordinates,): ``axial``, ``deflection``, ``rotation``, ``x``, …"""
        return self._array("dof_kind")

    @property
    def contacts(self) -> Table:
        """``contacts.csv``: a row a point and stop, with share of contact, forces, impulse, touches and approach."""
        if self._stops is None:
            raise RunError(f"there is no {self.folder / 'contacts.csv'}: the run did not come to its end")
        stops = Table(self._stops)
        if self._rows == slice(None):
            return stops
        first, last = np.searchsorted(stops["point"], [self._rows.start, self._rows.stop])
        return Table(self._stops, slice(int(first), int(last)))

    def gradient(self, key: str, of: str = "frequency") -> NDArray[np.float64]:
        """Derivative of every point (points,) by a parameter of ``[[sensitivity]]``, per unit of its key.

        ``of`` is ``frequency`` (Hz), ``amplitude``, ``peak`` (m), ``peak_force`` (N), ``impulse`` (N s), ``level`` or ``damping_ratio``. Modes are
        differentiated at constant energy, responses at constant frequency and level, their frequency at constant amplitude; NaN where a point has
        no such derivative.
        """
        column = f"d_{of}_d_{key}"
        if column not in self:
            begin, own = f"d_{of}_d_", [name for name in self.columns if name.startswith("d_") and "_d_" in name[2:]]
            keys = sorted({name.split("_d_", 1)[1] for name in own})
            kinds = sorted({name[2:].split("_d_", 1)[0] for name in own})
            if not own:
                raise KeyError(f"there are no gradients; the scene needs [[sensitivity]] key = {key!r}")
            if any(name.startswith(begin) for name in own):
                raise KeyError(f"there is no gradient by {key!r}; the scene has: {', '.join(keys)}")
            raise KeyError(f"there is no gradient of {of!r}; there are: {', '.join(kinds)}")
        return np.asarray(self[column], dtype=np.float64)

    def shape(self, point: int, harmonic: int = 1) -> NDArray[np.complex128]:
        """Complex amplitudes (coordinates,) of a harmonic at a point, m or rad."""
        return self.coefficients[self._point(point), :, self._harmonic(harmonic)]

    def motion(self, point: int, samples: int = 256) -> Motion:
        """Displacements of all coordinates over one period of a point."""
        samples = _arguments.count("samples", samples, least=1, most=1 << 20)
        point = self._point(point)
        own = self.coefficients[point]
        phase = 2 * np.pi * np.arange(samples) / samples
        waves = np.exp(1j * np.outer(phase, np.arange(own.shape[1])))
        return Motion(phase / self.omega[point], np.real(waves @ own.T))

    def history(self, point: int, contact: int = 0, samples: int = 512) -> History:
        """Motion and force of a contact over one period of a point: of a run of this process only."""
        if self._origin is None or self._origin.part < 0:
            raise RunError("histories are computed from a run that is in memory; these results were read from files")
        contact = _arguments.count("contact", contact)
        samples = _arguments.count("samples", samples, least=2, most=1 << 20)
        outcome, _, part, branch = self._origin
        return History(**outcome.history(part, branch, self._point(point), contact, samples))

    def verify(self, point: int) -> Verification:
        """One period of the full, unfiltered structure from a point: see :func:`nlmodes.verify`."""
        return verification(self.folder, (self._rows.start or 0) + self._point(point))

    def plot(self, x: str = "energy_j", y: str = "frequency_hz", ax: Axes | None = None, **options: Any) -> Axes:
        """Draws one column over another with matplotlib; energies and forces over a logarithmic axis."""
        import matplotlib.pyplot

        if ax is None:
            ax = matplotlib.pyplot.subplots(layout="constrained")[1]
        if x == "energy_j":
            ax.set_xscale("log")
        ax.plot(self[x], self[y], **{"label": self.label, **options})
        ax.set_xlabel(LABELS.get(x, x))
        ax.set_ylabel(LABELS.get(y, y))
        return ax

    def _point(self, point: int) -> int:
        found = _arguments.count("point", point, least=-len(self), most=len(self) - 1)
        return found % len(self)

    def _harmonic(self, harmonic: int) -> int:
        return _arguments.count("harmonic", harmonic, most=self.coefficients.shape[2] - 1)
