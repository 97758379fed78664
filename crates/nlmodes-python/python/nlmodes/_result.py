"""Results of runs, from their files."""

from __future__ import annotations

import json
import os
import shutil
import weakref
from collections.abc import Iterator
from pathlib import Path
from tempfile import mkdtemp
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from . import _arguments, _native
from ._errors import RunError
from ._table import Table

if TYPE_CHECKING:
    from matplotlib.axes import Axes

_LABELS = {
    "energy_j": "averaged kinetic energy / J",
    "total_energy_j": "energy / J",
    "frequency_hz": "frequency / Hz",
    "modal_amplitude": "modal amplitude / (m √kg)",
    "force_n": "force / N",
    "drive_fundamental_m": "fundamental of the drive point / m",
    "fundamental_m": "fundamental of the first contact / m",
    "peak_contact_force_n": "largest contact force / N",
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


class Scratch:
    """A directory that goes with what refers to it."""

    def __init__(self) -> None:
        self.path = Path(mkdtemp(prefix="nlmodes-")).resolve()
        self.remove = weakref.finalize(self, shutil.rmtree, self.path, True)


class _Origin(NamedTuple):
    """Where a branch comes from within a run of this session."""

    outcome: _native.Outcome
    scratch: Scratch | None
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

    def __init__(self, folder: Path, label: str, end: dict[str, Any] | None, origin: _Origin | None = None) -> None:
        super().__init__(_bytes(folder / "branch.csv"))
        self.folder = folder
        self.label = label
        self.end_reason = end["reason"] if end else "cut-off"
        self.ended_because = end["message"] if end else "the run was cut off before it wrote a summary"
        self.complete = bool(end and end["complete"])
        self._origin = origin
        self._archive = folder / "harmonics.npz"
        self._stamp = _stamp(self._archive)
        self._harmonics: dict[str, NDArray[Any]] = {}

    def __repr__(self) -> str:
        return f"<Branch {self.label!r}: {len(self)} points; ended: {self.ended_because}>"

    def _array(self, name: str) -> NDArray[Any]:
        if name not in self._harmonics:
            if self._stamp is None:
                raise RunError(f"there is no {self._archive}: the run did not come to its end")
            if _stamp(self._archive) != self._stamp:
                raise RunError(f"{self._archive} was written anew since this branch was read")
            with np.load(self._archive) as archive:
                self._harmonics = {key: archive[key] for key in archive.files}
            for array in self._harmonics.values():
                array.flags.writeable = False
        return self._harmonics[name]

    @property
    def coefficients(self) -> NDArray[np.complex128]:
        """Fourier coefficients (points, coordinates, harmonics + 1): q(t) = Re Σ c_n exp(i n ω t), m or rad."""
        return self._array("coefficients")

    @property
    def omega(self) -> NDArray[np.float64]:
        """Angular frequency (points,), rad/s."""
        return self._array("omega")

    @property
    def positions_m(self) -> NDArray[np.float64]:
        """Where the coordinates are (coordinates,), m."""
        return self._array("dof_position_m")

    @property
    def kinds(self) -> NDArray[np.str_]:
        """What the coordinates are (coordinates,): ``axial``, ``deflection``, ``rotation``, ``x``, …"""
        return self._array("dof_kind")

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
        """Motion and force of a contact over one period of a point: of a run of this session only."""
        if self._origin is None:
            raise RunError("histories are computed from a run that is in memory; these results were read from files")
        contact = _arguments.count("contact", contact)
        samples = _arguments.count("samples", samples, least=2, most=1 << 20)
        outcome, _, part, branch = self._origin
        return History(**outcome.history(part, branch, self._point(point), contact, samples))

    def verify(self, point: int) -> Verification:
        """One period of the full, unfiltered structure from a point: see :func:`nlmodes.verify`."""
        return verify(self.folder, self._point(point))

    def plot(self, x: str = "energy_j", y: str = "frequency_hz", ax: Axes | None = None, **options: Any) -> Axes:
        """Draws one column over another with matplotlib; energies and forces over a logarithmic axis."""
        import matplotlib.pyplot

        if ax is None:
            ax = matplotlib.pyplot.subplots(layout="constrained")[1]
        if x == "energy_j" and "energy_j" in self:
            ax.set_xscale("log")
        ax.plot(self[x], self[y], **{"label": self.label, **options})
        ax.set_xlabel(_LABELS.get(x, x))
        ax.set_ylabel(_LABELS.get(y, y))
        return ax

    def _point(self, point: int) -> int:
        found = _arguments.count("point", point, least=-len(self), most=len(self) - 1)
        return found % len(self)

    def _harmonic(self, harmonic: int) -> int:
        return _arguments.count("harmonic", harmonic, most=self.coefficients.shape[2] - 1)


class Result:
    """What came out of a scene: its branches, tables and files.

    ``result["frequency_hz"]`` and ``result.frequency_hz`` are columns of the first branch, or of the table of records.
    """

    directory: Path
    """Directory of the files; with ``report.html``, one page with all figures."""
    kind: str
    """``structure``, ``records`` or ``virtual-test``."""
    branches: tuple[Branch, ...]
    """All branches: of each method and number of harmonics, each with those that cross it."""
    points: Table | None
    """Modal points of records or levels, a row each; None for a structure."""
    summary: dict[str, Any]
    """``summary.json``: the scene as read, linear frequencies, events, why the branches ended."""
    wrong: list[str]
    """Why files are missing, or records gave no point."""

    def __init__(
        self, directory: Path, outcome: _native.Outcome | None = None, scratch: Scratch | None = None
    ) -> None:
        self.directory = directory
        self._scratch = scratch
        self.summary = _json(directory / "summary.json")
        self.wrong = list(outcome.wrong) if outcome else []
        table = directory / "modal_points.csv"
        self.points = Table(_bytes(table)) if table.is_file() else None
        self.branches = tuple(_branches(directory, outcome, scratch)) if self.points is None else ()
        if outcome is not None:
            self.kind = outcome.kind
        else:
            self.kind = "structure" if self.points is None else "virtual-test" if "rig" in self.summary else "records"

    @property
    def table(self) -> Table:
        """The first branch, or the table of records."""
        if self.points is not None:
            return self.points
        if not self.branches:
            raise RunError(f"{self.directory} holds no branch")
        return self.branches[0]

    @property
    def complete(self) -> bool:
        """Whether all was computed and written, each branch to a limit that was asked for."""
        return not self.wrong and all(branch.complete for branch in self.branches)

    @property
    def ended_because(self) -> str:
        """Why the first branch has no further points."""
        return self.branches[0].ended_because if self.branches else "; ".join(self.wrong)

    @property
    def report(self) -> Path:
        """The page with all figures, for a browser."""
        return self.directory / "report.html"

    def __getitem__(self, name: str) -> NDArray[Any]:
        return self.table[name]

    def __getattr__(self, name: str) -> NDArray[Any]:
        if not name.startswith("_") and {"points", "branches"} <= self.__dict__.keys():
            table = self.points if self.points is not None else self.branches[0] if self.branches else ()
            if name in table:
                return self[name]
        raise AttributeError(f"'Result' has no attribute or column {name!r}")

    def __dir__(self) -> list[str]:
        return [*super().__dir__(), *self.table.columns]

    def __iter__(self) -> Iterator[Branch]:
        return iter(self.branches)

    def __repr__(self) -> str:
        if self.points is not None:
            return f"<Result of {self.kind}: {len(self.points)} modal points>"
        lines = [f"<Result with {len(self.branches)} branch{'es' * (len(self.branches) != 1)}"]
        return "\n  ".join([*lines, *(repr(branch) for branch in self.branches[:5])]) + ">"

    def _repr_html_(self) -> str:
        from html import escape

        return f"<pre>{escape(repr(self))}</pre>"

    def to_pandas(self) -> Any:
        """All points as a ``pandas.DataFrame``; of several branches with their label in the column ``branch``."""
        import pandas

        if len(self.branches) < 2:
            return self.table.to_pandas()
        frames = [branch.to_pandas().assign(branch=branch.label) for branch in self.branches]
        return pandas.concat(frames, ignore_index=True)

    def plot(self, x: str | None = None, y: str = "frequency_hz", ax: Axes | None = None, **options: Any) -> Axes:
        """Draws one column over another, all branches in one figure, with matplotlib; returns the axes."""
        if self.points is not None:
            import matplotlib.pyplot

            ax = matplotlib.pyplot.subplots(layout="constrained")[1] if ax is None else ax
            x = x or "modal_amplitude"
            ax.plot(self.points[x], self.points[y], **{"marker": "o", "linestyle": "", **options})
            ax.set_xlabel(_LABELS.get(x, x))
            ax.set_ylabel(_LABELS.get(y, y))
            return ax
        for branch in self.branches:
            ax = branch.plot(x or "energy_j", y, ax, **options)
        if ax is None:
            raise RunError(f"{self.directory} holds no branch")
        if len(self.branches) > 1:
            ax.legend()
        return ax

    def save(self, folder: str | os.PathLike[str]) -> Path:
        """Copies all files into a new directory, and returns that."""
        return Path(shutil.copytree(self.directory, folder))


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


def verify(results: Result | str | os.PathLike[str], point: int) -> Verification:
    """One period of the full, unfiltered structure from a computed point: by how much it fails to return.

    ``results`` is a result, or the directory of one. Raises :class:`nlmodes.RunError` where the motion cannot be integrated, or the directory
    holds no such point.
    """
    folder = results.directory if isinstance(results, Result) else Path(results)
    return Verification(**_native.verify(folder, _arguments.count("point", point)))


def read(folder: str | os.PathLike[str]) -> Result:
    """Results that a run has left in a directory, of this package or of the command line."""
    directory = Path(folder)
    if not directory.is_dir():
        raise RunError(f"{directory}: there is no such directory")
    if not any((directory / name).is_file() for name in ("branch.csv", "modal_points.csv", "summary.json")):
        raise RunError(f"{directory} holds no results of nlmodes")
    return Result(directory)


def _branches(directory: Path, outcome: _native.Outcome | None, scratch: Scratch | None) -> Iterator[Branch]:
    summary = _json(directory / "summary.json")
    if "branches" in summary:
        for part, told in enumerate(summary["branches"]):
            origin = _Origin(outcome, scratch, part, 0) if outcome else None
            yield from _of_part(directory / told["directory"], told["label"], origin)
    elif (directory / "branch.csv").is_file():
        yield from _of_part(directory, None, _Origin(outcome, scratch, 0, 0) if outcome else None)
    else:
        for folder in sorted(entry.parent for entry in directory.glob("**/branch.csv")):
            yield Branch(folder, folder.relative_to(directory).as_posix(), None)


def _of_part(folder: Path, label: str | None, origin: _Origin | None) -> Iterator[Branch]:
    summary = _json(folder / "summary.json")
    label = label or summary.get("label") or _label(summary)
    yield Branch(folder, label, summary.get("end"), origin)
    for number, told in enumerate(summary.get("other_branches", []), 1):
        own = origin._replace(branch=number) if origin else None
        yield Branch(folder / told["directory"], f"{label}, branch {number}", told, own)


def _label(summary: dict[str, Any]) -> str:
    method = summary.get("scene", {}).get("method", {})
    names = {"ms-hbm": "MS-HBM", "hbm": "HBM", "shooting": "shooting"}
    kind = names.get(method.get("kind", ""), "branch")
    count = method.get("harmonics")
    return kind if count is None or kind == "shooting" else f"{kind}, {count} harmonic{'s' * (count != 1)}"


def _bytes(path: Path) -> bytes:
    try:
        return path.read_bytes()
    except OSError as error:
        raise RunError(f"{path} cannot be read: {error.strerror}") from None


def _json(path: Path) -> dict[str, Any]:
    if not path.is_file():
        return {}
    try:
        found = json.loads(_bytes(path))
    except ValueError as error:
        raise RunError(f"{path} is damaged: {error}") from None
    if not isinstance(found, dict):
        raise RunError(f"{path} is damaged")
    return found


def _stamp(path: Path) -> tuple[int, int, int] | None:
    try:
        found = path.stat()
    except OSError:
        return None
    return found.st_ino, found.st_mtime_ns, found.st_size
