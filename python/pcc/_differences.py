"""Derivatives of matrices by differences of matrices.

The step of each input is chosen once, at the medians of all inputs, by the matrices themselves: differences of steps
that shrink by a factor of 4 agree better and better as long as their error is that of the formula, and worse and worse
once it is the rounding of the matrices. The step is taken where they agree best; how well they do is its error. Steps
are those of the standardized variable, so that they fit small and large values of a law alike. No eigenvalue is
computed.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from ._errors import AnswerError

#: The first step, relative to the interval that holds the middle half of the law, and by what it shrinks.
FIRST_STEP = 0.25
SHRINK = 4.0

#: Steps that are tried at most: the last is a millionth of the first.
STEPS = 10

#: Steps after the best that are tried to see that it was.
BEYOND = 2

#: A derivative that is known no better than to this part of itself is of no use to a fit ...
LARGEST_ERROR = 1e-3

#: ... unless what it says of the matrices over all of the law is below this part of them.
NEGLIGIBLE = 1e-8

Matrices = Callable[[list], np.ndarray]


def nodes(study: Any, point: list, j: int, step: float) -> tuple[float, float]:
    """Two values of input `j` beside that of the point: one on each side, or both on one where the law ends."""
    lower, upper = study.neighbour(j, point[j], -step), study.neighbour(j, point[j], step)
    if lower is None and upper is not None:
        lower = study.neighbour(j, point[j], 2.0 * step)
    elif upper is None and lower is not None:
        upper = study.neighbour(j, point[j], -2.0 * step)
    if lower is None or upper is None or len({lower, upper, point[j]}) < 3:
        raise AnswerError(f"{study.names[j]} cannot be varied about {point[j]!r}; give the derivatives, or fit none")
    return lower, upper


def derivative(matrices: Matrices, study: Any, point: list, at_point: np.ndarray, j: int, step: float) -> np.ndarray:
    """The derivative by input `j`: that of the parabola through the matrices at the point and two values beside it."""
    values = nodes(study, point, j, step)
    a, b = values[0] - point[j], values[1] - point[j]
    first, second = (_differing(matrices(point[:j] + [x] + point[j + 1 :]), at_point) for x in values)
    return (first * (b / a) - second * (a / b)) / (b - a)


def _differing(there: np.ndarray, here: np.ndarray) -> np.ndarray:
    """What two answers differ by, each the matrices A, or M, C and K, of one system."""
    if len(there) != len(here):
        forms = {1: "A", 3: "M, C, K"}
        raise AnswerError(
            f"the function has returned {forms[len(here)]} at one point and {forms[len(there)]} beside it; it must return "
            "the same everywhere"
        )
    if there.shape != here.shape:
        raise AnswerError(
            f"the matrices are {there.shape[1]} × {there.shape[1]} at one point and {here.shape[1]} × {here.shape[1]} beside it"
        )
    return there - here


def best_step(matrices: Matrices, study: Any, point: list, at_point: np.ndarray, j: int) -> float:
    """The step of input `j` at which differences agree best."""
    # Each of M, C and K is measured by itself.
    scale = np.abs(at_point).max(axis=(1, 2))
    scale[scale == 0.0] = 1.0
    size = lambda matrix: float((np.abs(matrix).max(axis=(1, 2)) / scale).max())  # noqa: E731
    step = FIRST_STEP * (study.spreads[j] or 1.0)
    steps, found, errors = [step], [derivative(matrices, study, point, at_point, j, step)], []
    while len(steps) <= STEPS:
        steps.append(steps[-1] / SHRINK)
        found.append(derivative(matrices, study, point, at_point, j, steps[-1]))
        errors.append(size(found[-2] - found[-1]))
        if errors[-1] == 0.0 or len(errors) - 1 - int(np.argmin(errors)) >= BEYOND:
            break
    best = int(np.argmin(errors))
    # While the error still falls as that of the formula does, the smaller of the two steps is the better one.
    is_falling = best > 0 and errors[best] <= errors[best - 1] / SHRINK
    width = abs(nodes(study, point, j, steps[0])[1] - point[j]) / FIRST_STEP
    if errors[best] > LARGEST_ERROR * size(found[best]) and errors[best] * width > NEGLIGIBLE:
        part = errors[best] / max(size(found[best]), np.finfo(float).tiny)
        raise AnswerError(
            f"derivatives of the matrices by {study.names[j]} cannot be had by differences: with steps of {steps[best]:.1e} and "
            f"{steps[best + 1]:.1e} of its standardized value they differ by {part:.0e} of themselves, so the matrices jump or "
            f'carry noise; return them with the matrices, or fit without: fit={{"derivatives": False}}'
        )
    return steps[best + 1] if is_falling else steps[best]
