"""Arguments of every kind as what the compiled part takes, or refused by their names."""

from __future__ import annotations

import operator
from typing import Any

import numpy as np
from numpy.typing import NDArray


def _shape(shape: tuple[int | str, ...]) -> str:
    comma = "," if len(shape) == 1 else ""
    return f"({', '.join(str(length) for length in shape)}{comma})"


def floats(name: str, value: Any, shape: tuple[int | str, ...], *, finite: bool = True) -> NDArray[np.float64]:
    """An array of doubles of its own, row by row; lengths that are texts may be anything but zero."""
    if hasattr(value, "toarray"):
        raise TypeError(f"{name} is sparse; pass {name}.toarray()")
    if np.ma.isMaskedArray(value) and np.ma.getmaskarray(value).any():
        raise ValueError(f"{name} has masked entries")
    try:
        given = np.asarray(value)
    except Exception as error:
        raise TypeError(f"{name} is not an array of numbers: {error}") from None
    if given.dtype.kind not in "iuf":
        raise TypeError(f"{name} has the type {given.dtype}; real numbers were expected")
    lengths = given.shape
    fits = len(lengths) == len(shape)
    if not fits or any(isinstance(want, int) and have != want for have, want in zip(lengths, shape, strict=False)):
        raise ValueError(f"{name} has the shape {_shape(lengths)}; {_shape(shape)} was expected")
    if given.size == 0:
        raise ValueError(f"{name} is empty: it has the shape {_shape(lengths)}")
    with np.errstate(all="ignore"):
        array = np.array(given, dtype=np.float64, order="C", copy=True)
    if finite and not np.isfinite(array).all():
        at = tuple(int(i) for i in np.argwhere(~np.isfinite(array))[0])
        raise ValueError(f"{name}[{', '.join(map(str, at))}] is {given[at]}; finite numbers were expected")
    return array


def number(name: str, value: Any, *, above: float | None = None, finite: bool = True) -> float:
    """A real number."""
    if isinstance(value, (bool, np.bool_, str, bytes)):
        raise TypeError(f"{name} is {value!r}; a number was expected")
    try:
        found = float(value) if np.ndim(value) == 0 else None
    except Exception:
        found = None
    if found is None:
        raise TypeError(f"{name} is {value!r}; a number was expected") from None
    if finite and not np.isfinite(found):
        raise ValueError(f"{name} is {found}; a finite number was expected")
    if above is not None and not found > above:
        raise ValueError(f"{name} is {found}; more than {above} was expected")
    return found


def count(name: str, value: Any, *, least: int = 0, most: int = 2**31) -> int:
    """A whole number."""
    if isinstance(value, (bool, np.bool_)):
        raise TypeError(f"{name} is {value!r}; a whole number was expected")
    try:
        found = operator.index(value)
    except TypeError:
        raise TypeError(f"{name} is {value!r}; a whole number was expected") from None
    if not least <= found <= most:
        raise ValueError(f"{name} is {found}; {least} to {most} was expected")
    return found


def text(name: str, value: Any, choices: tuple[str, ...] | None = None) -> str:
    """A text, one of these."""
    if not isinstance(value, str):
        raise TypeError(f"{name} is {value!r}; a text was expected")
    if choices is not None and value not in choices:
        raise ValueError(f"{name} is {value!r}; expected one of: {', '.join(choices)}")
    return value
