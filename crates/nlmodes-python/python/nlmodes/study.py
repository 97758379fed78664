"""Studies: a quantity over parameters, from many branches."""

from __future__ import annotations

import json
import os
import warnings
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any, Protocol, TypeAlias

import numpy as np
from numpy.typing import NDArray

from . import _native
from ._branch import LABELS
from ._errors import RunError, SceneWarning
from ._files import Scratch
from ._result import Result, read
from ._run import Scene, _Bar, _progress, _source
from ._table import Table

if TYPE_CHECKING:
    from matplotlib.axes import Axes

StudyProgress: TypeAlias = bool | Callable[[int, int, str], object] | None
"""Whether a progress bar is shown, or the function to be called instead with cases done, all cases, a text."""


class StudyTable(Table):
    """A row a case, in the order of the study: number, values, quantities with their ``_error``, points, status, reason, id.

    ``table["f_2"]`` or ``table.f_2``; what a case does not have is NaN.
    """

    counts: dict[str, int]
    """How many ``cases`` there are, and how many are ``complete``, ``incomplete``, ``failed``, ``missing`` and ``damaged``."""
    statistics: list[dict[str, Any]]
    """Of each quantity: spread with quantiles, rank correlations with their intervals, Sobol' indices with their errors."""

    def __init__(self, study: Study, content: bytes, counts: dict[str, int], statistics: str) -> None:
        super().__init__(content)
        self._study = study
        self.counts = counts
        self.statistics = json.loads(statistics)

    @property
    def complete(self) -> bool:
        """Whether all cases are there, each with a branch to a limit that was asked for."""
        return self.counts["complete"] == self.counts["cases"]

    def case(self, number: int) -> Result:
        """The results of a case, as :func:`nlmodes.read` has them."""
        if not 0 <= number < len(self):
            raise IndexError(f"case {number}: the study has {len(self)}")
        if self["status"][number] not in ("complete", "incomplete"):
            raise RunError(f"case {number} is {self['status'][number]}: {self['reason'][number]}")
        return read(self._study.directory / "cases" / str(self["id"][number]))

    def plot(self, x: str | None = None, y: str | None = None, ax: Axes | None = None, **options: Any) -> Axes:
        """Draws a column over another, a point a case, with matplotlib; default the first quantity over the first variable. Returns the axes."""
        if ax is None:
            import matplotlib.pyplot

            ax = matplotlib.pyplot.subplots(layout="constrained")[1]
        x, y = x or self._study.variables[0], y or self._study.quantities[0]
        ax.plot(self[x], self[y], **{"marker": ".", "linestyle": "", **options})
        ax.set_xlabel(LABELS.get(x, x))
        ax.set_ylabel(LABELS.get(y, y))
        return ax

    def __repr__(self) -> str:
        own = ", ".join(f"{n} {name}" for name, n in self.counts.items() if n and name != "cases")
        return f"<StudyTable of {self.counts['cases']} cases: {own}>"


class Fit:
    """What a fit found: the variables with their covariance, and the measured points beside the curve."""

    def __init__(self, found: Mapping[str, Any], points: bytes) -> None:
        self._found = found
        self.points = Table(points)
        """The measured numbers: ``column``, ``place``, ``measured``, ``measured_std``, ``before`` and ``fitted``."""

    @property
    def values(self) -> dict[str, float]:
        """Each variable as found."""
        return {one["variable"]: one["value"] for one in self._found["parameters"]}

    @property
    def std(self) -> dict[str, float]:
        """Standard deviation of each variable."""
        return {one["variable"]: one["std"] for one in self._found["parameters"]}

    @property
    def covariance(self) -> NDArray[np.float64]:
        """Covariance of the variables in their order, each in its unit."""
        return np.array(self._found["covariance"], dtype=float)

    @property
    def chi_squared(self) -> float:
        """Sum of the squares of what is left, over the deviations of the points."""
        return float(self._found["chi_squared"])

    @property
    def probability(self) -> float | None:
        """Probability that noise with the stated deviations leaves as much; None where none are stated."""
        found: float | None = self._found["probability"]
        return found

    @property
    def overrides(self) -> list[str]:
        """The variables as found, as ``--set`` of the command line takes them."""
        return list(self._found["set"])

    @property
    def details(self) -> dict[str, Any]:
        """All of ``fit.json``."""
        return dict(self._found)

    def __repr__(self) -> str:
        own = ", ".join(f"{name} = {value:.6g} ± {self.std[name]:.2g}" for name, value in self.values.items())
        return f"<Fit: {own}>"


class Executor(Protocol):
    """What computes cases elsewhere: an executor of ``concurrent.futures`` or a client of Dask, ``distributed.Client``."""

    def submit(self, function: Callable[..., Any], /, *arguments: Any) -> Any:
        """A future with ``result()``."""


class Study:
    """A study: one branch for each of many values, and a table of quantities.

    Parameters
    ----------
    study
        Path of the TOML file that ``nlmodes-cli study`` takes, its text, or a dictionary of its tables, in which ``scene`` may be a dictionary or
        a text too. Cases and their names are those of the command line: what that has computed is not computed again, and the other way round.
    out
        Directory of the study. Left out: the one that it names; for a file that names none ``results/<name of the file>``, for a text or a
        dictionary a temporary one that goes with the study.

    Raises
    ------
    SceneError
        Study or scene are wrong: with key, line, and what to do.

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
    ...     "continuation": {"max_energy_ratio": 2.0},
    ... }
    >>> study = nlmodes.Study({
    ...     "scene": rod,
    ...     "vary": [{"key": "contact.0.gap_m", "name": "gap_m", "values": [1e-3, 2e-3, 3e-3]}],
    ...     "quantity": [{"name": "force", "of": "peak_contact_force_n", "at": "last"}],
    ... })
    >>> table = study.run()
    >>> table.counts["complete"], table.complete
    (3, True)
    >>> bool(abs(table.force[2] / table.force[0] - 3) < 1e-9)  # a wider gap scales the motion, and nothing else
    True
    >>> study.evaluate(gap_m=2e-3)["quantities"]["force"] == float(table.force[1])
    True
    """

    def __init__(self, study: Scene, *, out: str | os.PathLike[str] | None = None) -> None:
        scene = None
        if isinstance(study, Mapping) and study.get("scene") is not None:
            own = _source(study["scene"])
            if isinstance(own, tuple):
                scene = own[1]
            study = {**study, "scene": "scene.toml" if scene else str(own)}
        source = _source(study)
        self._scratch = Scratch() if out is None and isinstance(source, tuple) else None
        place = self._scratch.path if self._scratch else None
        self._native = _native.Study(source, scene, None if out is None else Path(out), place)
        here = source if isinstance(source, tuple) else source.absolute()
        self._where = (here, scene, self.directory.absolute(), Path.cwd())
        for text in self._native.warnings:
            warnings.warn(text, SceneWarning, stacklevel=2)

    @property
    def directory(self) -> Path:
        """Directory of the study, with ``cases/<id>`` for each case; after a run with table, figures and ``report.html``."""
        return Path(self._native.directory)

    @property
    def title(self) -> str:
        """Title of tables and page."""
        return self._native.title

    @property
    def variables(self) -> list[str]:
        """Names of what varies."""
        return self._native.variables

    @property
    def quantities(self) -> list[str]:
        """Names of what is wanted of each case."""
        return self._native.quantities

    def ids(self) -> list[str | None]:
        """Names of all cases in their order: hashes of their scenes and of the version. None where the values make no sound scene."""
        return self._native.ids()

    def run(
        self,
        *,
        jobs: int | None = None,
        shard: str = "0/1",
        retry_failed: bool = False,
        figures: bool = False,
        memory_limit: str | None = None,
        progress: StudyProgress = None,
    ) -> StudyTable:
        """Computes the cases that are not there yet, and returns the table; table, figures and page are written too.

        Parameters
        ----------
        jobs
            Cases at a time; default as many as the machine has cores.
        shard
            ``"i/n"``: every n-th point of the design only, beginning with point i.
        retry_failed, figures
            Compute cases that failed once more; draw figures and page of each case too.
        memory_limit
            Most memory of all cases that are computed at the same time, as ``"8GiB"``; default three quarters of the machine's.
        progress
            True or False for a bar of tqdm, default on a terminal or in a notebook; or a function of the number of cases that are there, of all
            cases, and a text. What it raises ends the study and is raised.

        Raises
        ------
        RunError
            A file cannot be written. A case that fails is a row with its reason.
        KeyboardInterrupt
            Ctrl-C ends the cases in progress; the same call goes on from there.
        """
        if jobs is not None and (isinstance(jobs, bool) or not isinstance(jobs, int)):
            raise TypeError(f"jobs is a {type(jobs).__name__}; a whole number was expected")
        if jobs is not None and jobs < 1:
            raise ValueError(f"jobs is {jobs}; at least 1 was expected")
        total = len(self.ids())
        shown = _shown(progress, total)
        try:
            self._native.run(jobs, shard, retry_failed, figures, memory_limit, shown)
        finally:
            if isinstance(shown, _Bar):
                shown.close()
        return self._table(True)

    def map(self, executor: Executor, *, chunks: int | None = None, retry_failed: bool = False, attempts: int = 3) -> StudyTable:
        """Computes the cases that are not there yet by an executor of ``concurrent.futures`` or Dask, and returns the table.

        A case is a call that leaves its directory: workers need the package, and the directory of the study and the files of its scene at the
        same paths. A worker that is lost takes the cases in progress with it and nothing else; they are computed again, or by the next call.

        Parameters
        ----------
        executor
            With ``submit(function, *arguments)`` that returns a future: ``ProcessPoolExecutor(8)``, ``distributed.Client(...)``, of threads too.
        chunks
            Calls into which the cases are divided, each with every n-th point; default one a case, at most 1000.
        retry_failed
            Compute cases that failed once more.
        attempts
            How often a call whose worker was lost is submitted.

        Raises
        ------
        RunError
            Calls have failed ``attempts`` times. What was computed stays; the same call goes on from there.

        Examples
        --------
        >>> from concurrent.futures import ThreadPoolExecutor
        >>> import nlmodes
        >>> study = nlmodes.Study({
        ...     "scene": {
        ...         "structure": {
        ...             "kind": "rod", "length_m": 1.0, "elements": 4, "start": "clamped",
        ...             "material": {"youngs_modulus_pa": 210e9, "density_kg_m3": 7800.0}, "section": {"area_m2": 1e-4},
        ...         },
        ...         "contact": [{"at_m": 1.0, "direction": "axial", "side": "positive", "gap_m": 1e-3}],
        ...         "method": {"harmonics": 1},
        ...         "continuation": {"max_energy_ratio": 2.0},
        ...     },
        ...     "vary": [{"key": "contact.0.gap_m", "name": "gap_m", "values": [1e-3, 2e-3]}],
        ...     "quantity": [{"name": "force", "of": "peak_contact_force_n", "at": "last"}],
        ... })
        >>> with ThreadPoolExecutor(2) as workers:
        ...     study.map(workers).complete
        True
        """
        cases = len(self.ids())
        parts = max(1, min(chunks or 1000, cases))
        missing: Sequence[int] = range(parts)
        why = ""
        for _ in range(max(1, attempts)):
            futures = [(part, _submitted(executor, (*self._where, f"{part}/{parts}", retry_failed))) for part in missing]
            lost = []
            for part, future in futures:
                try:
                    future.result()
                except Exception as error:  # noqa: BLE001: each library has its own for a worker that is lost
                    lost.append(part)
                    why = f"{type(error).__name__}: {error}"
            missing = lost
            if not missing:
                return self._table(True)
        raise RunError(
            f"{len(missing)} of {parts} calls have failed {attempts} times; the last one said {why}\n"
            "what was computed until then stays; the same call goes on from there"
        )

    def fit(self, *, memory_limit: str | None = None) -> Fit:
        """Fits the variables to the measured points of the study, its ``[fit]``, by Gauss-Newton with exact gradients of the curve.

        ``fit.json``, ``fit.csv`` and figures are written into the directory of the study.

        Raises
        ------
        SceneError
            Nothing is measured, or fewer numbers than there are variables; the curve at the start does not reach the points.
        RunError
            The search does not come to an end, or the points do not tell the variables apart.

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
        >>> made = nlmodes.run(rod, contact=[{"at_m": 1.0, "direction": "axial", "side": "positive", "gap_m": 1.1e-3}])
        >>> import pathlib, tempfile
        >>> place = pathlib.Path(tempfile.mkdtemp())
        >>> rows = zip(made.energy_j[2:6].tolist(), made.frequency_hz[2:6].tolist())
        >>> _ = (place / "points.csv").write_text("energy_j,frequency_hz\\n" + "".join(f"{e!r},{f!r}\\n" for e, f in rows))
        >>> found = nlmodes.Study({
        ...     "scene": rod,
        ...     "fit": {"measured": str(place / "points.csv"), "over": "energy_j"},
        ...     "vary": [{"key": "contact.0.gap_m", "name": "gap_m"}],
        ... }).fit()
        >>> bool(abs(found.values["gap_m"] - 1.1e-3) < 1e-8)
        True
        """
        found, points = self._native.fit(memory_limit)
        return Fit(json.loads(found), points.read_bytes())

    def collect(self) -> StudyTable:
        """The table of what there is; nothing is computed or written. Cases that are missing have a row that says so."""
        return self._table(False)

    def status(self) -> dict[str, int]:
        """How many cases there are in which state, without a look at their branches."""
        return self._native.status()

    def evaluate(self, **values: Any) -> dict[str, Any]:
        """One case with these values, whatever the design: for samplers and optimisers.

        Names are those of the study's variables, or keys of the scene (``**{"contact.0.gap_m": 1e-3}``); what is not named is as in the scene. What is
        there is not computed again. Returns ``status``, ``reason``, ``quantities`` (None where the case does not have one) and ``id``.
        """
        plain = {name: value.tolist() if hasattr(value, "tolist") else value for name, value in values.items()}
        found: dict[str, Any] = json.loads(self._native.evaluate(json.dumps(plain, allow_nan=False)))
        return found

    def _table(self, written: bool) -> StudyTable:
        return StudyTable(self, *self._native.collect(written))

    def __len__(self) -> int:
        """Number of cases."""
        return self.status()["cases"]

    def __repr__(self) -> str:
        return f"<Study of {', '.join(self.quantities)} over {', '.join(self.variables)} in {self.directory}>"


def _submitted(executor: Executor, case: tuple[Any, ...]) -> Any:
    # Dask takes equal calls for one, whose result it may still have; a case that failed is to be computed again.
    if hasattr(executor, "scheduler_info"):
        return executor.submit(_computed, *case, pure=False)  # type: ignore[call-arg]
    return executor.submit(_computed, *case)


def _computed(source: tuple[str, str] | Path, scene: str | None, directory: Path, place: Path, shard: str, retry: bool) -> None:
    """Computes a share of a study where a worker is."""
    if isinstance(source, tuple) and Path.cwd() != place:
        # Files of a text count from where it was written.
        os.chdir(place)
    _native.Study(source, scene, directory, None).run(1, shard, retry, False, None, None)


def _shown(wanted: StudyProgress, total: int) -> Callable[[int, float | None, str], object] | None:
    if callable(wanted):
        tell = wanted
        return lambda done, _, text: tell(done, total, text)
    shown = _progress(wanted)
    if isinstance(shown, _Bar):
        shown.options = {"unit": " cases", "total": total, "leave": False}
    return shown
