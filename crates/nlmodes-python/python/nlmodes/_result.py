"""Results of runs, from their files."""

from __future__ import annotations

import os
import shutil
from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Any

from numpy.typing import NDArray

from . import _files, _native
from ._branch import LABELS, Branch, Origin, Verification, verification
from ._errors import RunError
from ._table import Table

if TYPE_CHECKING:
    from matplotlib.axes import Axes


class Result:
    """What came out of a scene: its branches, tables and files.

    ``result["frequency_hz"]`` and ``result.frequency_hz`` are columns of the first branch, or of the table of records.
    """

    directory: Path
    """Directory of the files; with ``report.html``, one page with all figures."""
    kind: str
    """``structure``, ``responses``, ``records`` or ``virtual-test``."""
    branches: tuple[Branch, ...]
    """All branches: of each method and number of harmonics, each with those that cross it."""
    points: Table | None
    """Modal points of records or levels, a row each; None for a structure."""
    summary: dict[str, Any]
    """``summary.json``: the scene as read, linear frequencies, events, why the branches ended."""
    wrong: list[str]
    """Why files are missing, or records gave no point."""

    def __init__(
        self, directory: Path, outcome: _native.Outcome | None = None, scratch: _files.Scratch | None = None
    ) -> None:
        self.directory = directory
        self._scratch = scratch
        self.summary = _files.table(directory, "summary.json")
        self.wrong = list(outcome.wrong) if outcome else []
        table = _files.optional(directory, "modal_points.csv")
        self.points = None if table is None else Table(table)
        self.branches = tuple(_branches(directory, self.summary, outcome, scratch)) if self.points is None else ()
        if outcome is not None:
            self.kind = outcome.kind
        else:
            kind = "responses" if "curves" in self.summary else "structure"
            self.kind = kind if self.points is None else "virtual-test" if "rig" in self.summary else "records"

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

    def plot(self, x: str | None = None, y: str | None = None, ax: Axes | None = None, **options: Any) -> Axes:
        """Draws one column over another, all branches in one figure, with matplotlib; returns the axes."""
        if self.points is not None:
            import matplotlib.pyplot

            ax = matplotlib.pyplot.subplots(layout="constrained")[1] if ax is None else ax
            x, y = x or "modal_amplitude", y or "frequency_hz"
            ax.plot(self.points[x], self.points[y], **{"marker": "o", "linestyle": "", **options})
            ax.set_xlabel(LABELS.get(x, x))
            ax.set_ylabel(LABELS.get(y, y))
            return ax
        usual = ("frequency_hz", "drive_fundamental_m") if "curves" in self.summary else ("energy_j", "frequency_hz")
        for branch in self.branches:
            ax = branch.plot(x or usual[0], y or usual[1], ax, **options)
        if ax is None:
            raise RunError(f"{self.directory} holds no branch")
        if len(self.branches) > 1:
            ax.legend()
        return ax

    def save(self, folder: str | os.PathLike[str]) -> Path:
        """Copies all files into a new directory, and returns that."""
        return Path(shutil.copytree(self.directory, folder))


def verify(results: Result | str | os.PathLike[str], point: int) -> Verification:
    """One period of the full, unfiltered structure from a computed point: by how much it fails to return.

    ``results`` is a result, or the directory of one. Raises :class:`nlmodes.RunError` where the motion cannot be integrated, or the directory
    holds no such point.
    """
    folder = results.directory if isinstance(results, Result) else Path(results)
    return verification(folder, point)


def read(folder: str | os.PathLike[str]) -> Result:
    """Results that a run has left in a directory, of this package or of the command line."""
    directory = Path(folder)
    if not directory.is_dir():
        raise RunError(f"{directory}: there is no such directory")
    if not any((directory / name).is_file() for name in ("branch.csv", "modal_points.csv", "summary.json")):
        raise RunError(f"{directory} holds no results of nlmodes")
    return Result(directory)


def _branches(
    directory: Path, summary: dict[str, Any], outcome: _native.Outcome | None, scratch: _files.Scratch | None
) -> Iterator[Branch]:
    if "branches" in summary:
        for part, told in enumerate(summary["branches"]):
            origin = Origin(outcome, scratch, part, 0) if outcome else None
            folder = directory / told["directory"]
            yield from _of_part(folder, _files.table(folder, "summary.json"), told["label"], origin)
    elif "curves" in summary:
        # Responses: all curves in one table.
        origin = Origin(outcome, scratch, -1, 0) if outcome else None
        for told in summary["curves"]:
            rows = slice(told["first_point"], told["first_point"] + told["points"])
            yield Branch(directory, told["name"], told["end"], origin, rows)
    elif (directory / "branch.csv").is_file():
        yield from _of_part(directory, summary, None, Origin(outcome, scratch, 0, 0) if outcome else None)
    else:
        for folder in sorted(entry.parent for entry in directory.glob("**/branch.csv")):
            yield Branch(folder, folder.relative_to(directory).as_posix(), None)


def _of_part(folder: Path, summary: dict[str, Any], label: str | None, origin: Origin | None) -> Iterator[Branch]:
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
