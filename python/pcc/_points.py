"""Points as NumPy has them: rows of an array, a dict of columns, a table of columns."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import Any

import numpy as np

from ._errors import PointsError


def as_points(X: Any, names: Sequence[str]) -> np.ndarray:
    """The points of ``X``, a row each, one column per input, contiguous and of type float64."""
    if isinstance(X, (Iterator, str, bytes)) or X is None:
        raise PointsError(
            f"X is {_kind(X)}, not points; give an array with a row for each point and the columns {_list(names)}, or a "
            "dict or table with these columns"
        )
    if callable(getattr(X, "collect", None)):
        raise PointsError(f"X is {_kind(X)}, which has no values yet; give X.collect()")
    if isinstance(X, Mapping):
        return _columns(X, list(X), names)
    if isinstance(X, Sequence) and len(X) and all(isinstance(row, Mapping) for row in X):
        X = {name: [row.get(name) for row in X] for name in names if any(name in row for row in X)}
        return _columns(X, list(X), names)
    columns = getattr(X, "columns", None)
    if columns is not None and not callable(columns):
        return _columns(X, list(columns), names)
    fields = getattr(getattr(X, "dtype", None), "names", None)
    if fields:
        return _columns(X, list(fields), names)
    return _rows(_numbers(X, "X"), names)


def _columns(X: Any, known: list, names: Sequence[str]) -> np.ndarray:
    missing = [name for name in names if name not in known]
    if missing:
        raise PointsError(
            f"X has no column {_list(missing)}; its columns are {_list(map(str, known)) or 'none'}, the inputs {_list(names)}"
        )
    columns = [_numbers(X[name], f"column {name}") for name in names]
    for name, column in zip(names, columns):
        if column.ndim > 1:
            raise PointsError(f"column {name} has the shape {column.shape}; give one number for each point")
    lengths = {column.size for column in columns if column.ndim == 1}
    if len(lengths) > 1:
        said = ", ".join(f"{name} {column.size}" for name, column in zip(names, columns) if column.ndim == 1)
        raise PointsError(f"the columns of X differ in length: {said}")
    length = lengths.pop() if lengths else 1
    return np.ascontiguousarray(np.column_stack([np.broadcast_to(column, (length,)) for column in columns]))


def _rows(numbers: np.ndarray, names: Sequence[str]) -> np.ndarray:
    if numbers.ndim == 1 and len(names) == 1:
        numbers = numbers[:, np.newaxis]
    if numbers.ndim == 1 and numbers.size == len(names):
        raise PointsError(
            f"X has the shape {numbers.shape}; for one point with the inputs {_list(names)} give X[np.newaxis]"
        )
    if numbers.ndim != 2 or numbers.shape[1] != len(names):
        raise PointsError(
            f"X has the shape {numbers.shape}; it takes a row for each point and {len(names)} "
            f"{'column' if len(names) == 1 else 'columns'}, {_list(names)}"
        )
    return np.ascontiguousarray(numbers)


def _numbers(values: Any, what: str) -> np.ndarray:
    """Real numbers of type float64."""
    if np.ma.isMaskedArray(values) and np.ma.is_masked(values):
        raise PointsError(f"{what} has masked values; fill them, or leave these points out")
    if hasattr(values, "toarray"):
        values = values.toarray()
    try:
        found = np.asarray(values)
    except (ValueError, TypeError, OverflowError) as error:
        raise PointsError(f"{what} is no array of numbers: {error}") from error
    if found.dtype.kind == "O" and found.ndim > 0:
        try:
            found = found.astype(np.float64)
        except (ValueError, TypeError, OverflowError) as error:
            raise PointsError(f"{what} holds what are no numbers: {error}") from error
    if found.dtype.kind not in "fiu":
        raise PointsError(f"{what} is {_kind(values)} of type {found.dtype}; give real numbers")
    return found.astype(np.float64, copy=False)


def _kind(value: Any) -> str:
    return "None" if value is None else f"a {type(value).__name__}"


def _list(names: Any) -> str:
    return ", ".join(names)
