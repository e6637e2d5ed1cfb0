"""A surrogate in NumPy, vectorised over points."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from surrogate import MultiIndex, Surrogate

# Points evaluated together. All terms at that many points fit the cache more or less; fewer leave NumPy's own cost
# per call. For some 500 terms 1024 to 4096 are about equally fast.
BLOCK = 2048


class Step(NamedTuple):
    """One product: row `row` of the terms = row `parent` * polynomial of degree `degree` in input `variable`."""

    row: int
    parent: int
    variable: int
    degree: int


class NumpyEvaluator:
    """Terms are built one from the other, by one product each; one matrix product makes components of them."""

    def __init__(self, surrogate: Surrogate) -> None:
        self.surrogate = surrogate
        terms = _with_parents(surrogate.indices)
        row = {index: position for position, index in enumerate(terms)}
        self.steps = [_step(index, row) for index in terms[1:]]
        self.terms = np.ones((len(terms), BLOCK))
        self.coefficients = np.zeros((len(surrogate.components), len(terms)))
        self.coefficients[:, [row[index] for index in surrogate.indices]] = surrogate.physical_coefficients().T
        self.middle = (surrogate.lower + surrogate.upper) / 2.0
        self.half_width = (surrogate.upper - surrogate.lower) / 2.0

    def __call__(self, points: np.ndarray) -> np.ndarray:
        """Values of the components, one column each, at physical points, one row each."""
        values = np.empty((len(points), len(self.surrogate.components)))
        for start in range(0, len(points), BLOCK):
            block = points[start : start + BLOCK]
            values[start : start + BLOCK] = self._components(block).T
        return values

    def _components(self, points: np.ndarray) -> np.ndarray:
        """Values at one block of points, one row per component."""
        standardized = (points - self.middle) / self.half_width
        tables = [
            _polynomials(np.ascontiguousarray(column), off_diagonal)
            for column, off_diagonal in zip(standardized.T, self.surrogate.off_diagonal, strict=True)
        ]
        terms = self.terms[:, : len(points)]
        for row, parent, variable, degree in self.steps:
            np.multiply(terms[parent], tables[variable][degree], out=terms[row])
        return self.coefficients @ terms


def _polynomials(z: np.ndarray, off_diagonal: np.ndarray) -> np.ndarray:
    """All polynomials of one variable, one row per degree, by their recurrence."""
    table = np.ones((len(off_diagonal) + 1, len(z)))
    if len(off_diagonal) > 0:
        table[1] = z / off_diagonal[0]
    for k in range(1, len(off_diagonal)):
        table[k + 1] = (z * table[k] - off_diagonal[k - 1] * table[k - 1]) / off_diagonal[k]
    return table


def _parent(index: MultiIndex, variable: int) -> MultiIndex:
    """The multi-index without `variable` and all after it."""
    return index[:variable] + (0,) * (len(index) - variable)


def _with_parents(indices: list[MultiIndex]) -> list[MultiIndex]:
    """The multi-indices and all they are built from, each after its parent."""
    prefixes = {_parent(index, variable) for index in indices for variable in range(len(index) + 1)}
    return sorted(prefixes)


def _step(index: MultiIndex, row: dict[MultiIndex, int]) -> Step:
    last = max(variable for variable, degree in enumerate(index) if degree > 0)
    return Step(row[index], row[_parent(index, last)], last, index[last])
