from collections.abc import Callable
from pathlib import Path
from typing import Any, final

import numpy as np
from numpy.typing import NDArray

__all__ = [
    "Outcome",
    "Series",
    "Study",
    "__version__",
    "check",
    "columns",
    "command",
    "conformance_cases",
    "extract",
    "follow",
    "linear_frequencies",
    "override_of",
    "run",
    "schema",
    "toml_of",
    "trace",
    "verify",
]

__version__: str

@final
class Outcome:
    @property
    def directory(self) -> Path: ...
    @property
    def kind(self) -> str: ...
    @property
    def warnings(self) -> list[str]: ...
    @property
    def wrong(self) -> list[str]: ...
    @property
    def wall_time_s(self) -> float: ...
    def history(self, part: int, branch: int, point: int, contact: int, samples: int) -> dict[str, Any]: ...

@final
class Series:
    def __new__(cls, a: NDArray[np.float64], solver: str) -> Series: ...
    def solve(
        self, b: NDArray[np.float64], start: str
    ) -> tuple[
        NDArray[np.float64], NDArray[np.float64], NDArray[np.bool_], NDArray[np.float64], NDArray[np.int64]
    ]: ...
    def response(self, closed: NDArray[np.bool_]) -> tuple[NDArray[np.float64], NDArray[np.float64]]: ...

@final
class Study:
    def __new__(
        cls, source: tuple[str, str] | Path, scene: str | None, out: Path | None, scratch: Path | None
    ) -> Study: ...
    @property
    def warnings(self) -> list[str]: ...
    @property
    def directory(self) -> Path: ...
    @property
    def title(self) -> str: ...
    @property
    def variables(self) -> list[str]: ...
    @property
    def quantities(self) -> list[str]: ...
    def ids(self) -> list[str | None]: ...
    def run(
        self,
        jobs: int | None,
        shard: str,
        retry: bool,
        drawn: bool,
        memory_limit: str | None,
        progress: Callable[[int, float | None, str], object] | None,
    ) -> None: ...
    def collect(self, written: bool) -> tuple[bytes, dict[str, int], str]: ...
    def status(self) -> dict[str, int]: ...
    def fit(self, memory_limit: str | None) -> tuple[str, Path]: ...
    def evaluate(self, values: str) -> str: ...

def follow(
    source: tuple[str, str] | Path,
    overrides: list[str],
    of: str,
    key: str,
    window: tuple[float, float],
    at: tuple[float | None, float | None],
    directory: Path,
) -> None: ...

def run(
    source: tuple[str, str] | Path,
    overrides: list[str],
    out: Path | None,
    scratch: Path | None,
    over: str,
    memory_limit: str | None,
    progress: Callable[[int, float | None, str], object] | None,
    laws: list[tuple[str, Callable[[float], float], Callable[[float], float], bool]],
) -> Outcome: ...
def check(source: tuple[str, str] | Path, overrides: list[str]) -> list[str]: ...
def linear_frequencies(source: tuple[str, str] | Path, overrides: list[str]) -> dict[str, list[float] | None]: ...
def schema() -> str: ...
def command(arguments: list[str]) -> int: ...
def columns() -> str: ...
def verify(directory: Path, point: int) -> dict[str, Any]: ...
def conformance_cases(at_most: int) -> list[tuple[str, NDArray[np.float64], NDArray[np.float64], bool]]: ...
def toml_of(scene: dict[str, Any]) -> str: ...
def override_of(key: str, given: Any) -> str: ...
def extract(
    scene: str, records: list[tuple[str, list[tuple[str, NDArray[np.float64]]]]]
) -> tuple[bytes, list[list[tuple[str, str]]], list[str]]: ...
def trace(
    f: Callable[[NDArray[np.float64], float], Any],
    jacobian: Callable[[NDArray[np.float64], float], Any] | None,
    x0: list[float],
    p0: float,
    direction: list[float],
    settings: dict[str, Any],
) -> dict[str, Any]: ...
