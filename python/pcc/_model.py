"""Functions as models: what they answer, checked and in one form."""

from __future__ import annotations

import contextlib
import os
import threading
import traceback
from collections.abc import Callable, Coroutine, Iterator, Mapping
from typing import Any

import numpy as np

from . import _differences
from ._errors import AnswerError

#: What a function is to return.
FORMS = "return M, C, K; or A; or eigenvalues"


class Function:
    """A function of the user's with the study that it belongs to, as the library calls it.

    A call with the values of the inputs, in their order, gives the form of the answer ("second order", "first order" or
    "eigenvalues"), its numbers, and the derivatives of matrices by each input if they are wanted.
    """

    def __init__(self, function: Callable, study: Any) -> None:
        self.function = function
        self.study = study
        self.names = list(study.names)
        self.constants = dict(study.constants)
        self.answers = study.answers
        self._steps: dict[int, float] = {}
        self._at_middle: np.ndarray | None = None
        self._lock = threading.Lock()

    def __call__(self, values: list, with_derivatives: bool) -> tuple[str, np.ndarray, np.ndarray | None]:
        form, numbers, given = self._answer(values)
        if form == "eigenvalues" or not with_derivatives:
            return form, numbers, None
        return form, numbers, self._derivatives(values, numbers, given)

    def _answer(self, values: list) -> tuple[str, np.ndarray, Mapping]:
        form, numbers, given = read(self.function(**dict(zip(self.names, values)), **self.constants))
        if kind_of(form) != self.answers:
            raise AnswerError(
                f'the function has returned {kind_of(form)}, but the study says answers = "{self.answers}"'
            )
        return form, numbers, given

    def _derivatives(self, values: list, numbers: np.ndarray, given: Mapping) -> np.ndarray:
        unknown = [str(name) for name in given if name not in self.names]
        if unknown:
            raise AnswerError(f"derivatives by {', '.join(unknown)}, but the inputs are {', '.join(self.names)}")
        found = np.empty((len(self.names), *numbers.shape))
        for j, name in enumerate(self.names):
            if name in given:
                found[j] = _given(given[name], name, numbers.shape)
            else:
                found[j] = _differences.derivative(self._matrices, self.study, values, numbers, j, self._step(j))
        return found

    def _matrices(self, values: list) -> np.ndarray:
        return self._answer(values)[1]

    def _step(self, j: int) -> float:
        """The step of an input, chosen when a run first needs it: the same whatever the run."""
        with self._lock:
            if j not in self._steps:
                middle = self.study.medians
                if self._at_middle is None:
                    self._at_middle = self._matrices(middle)
                self._steps[j] = _differences.best_step(self._matrices, self.study, middle, self._at_middle, j)
            return self._steps[j]


def kind_of(form: str) -> str:
    """What a study calls answers of this form."""
    return "eigenvalues" if form == "eigenvalues" else "matrices"


def read(answer: Any) -> tuple[str, np.ndarray, Mapping]:
    """The form of an answer, its numbers, and the derivatives that came with it."""
    is_nothing = isinstance(answer, (str, bytes, Iterator, Coroutine)) or answer is None or _is_dict(answer)
    if is_nothing or callable(answer):
        kind = "None" if answer is None else f"a {type(answer).__name__}"
        raise AnswerError(f"the function has returned {kind}; {FORMS}")
    given: Mapping = {}
    if isinstance(answer, tuple) and answer and _is_dict(answer[-1]):
        *parts, given = answer
        answer = tuple(parts) if len(parts) != 1 else parts[0]
    if isinstance(answer, (tuple, list)) and len(answer) and any(_dimensions(part) == 2 for part in answer):
        if len(answer) != 3:
            raise AnswerError(f"the function has returned {len(answer)} matrices; {FORMS}, with None for a C of zeros")
        mass, damping, stiffness = answer
        for name, part in (("M", mass), ("K", stiffness)):
            if part is None:
                raise AnswerError(f"{name} is None; C alone may be None, for zeros")
        sized = _matrix(mass, "M")
        parts = [sized, np.zeros_like(sized) if damping is None else _matrix(damping, "C"), _matrix(stiffness, "K")]
        for name, part in zip("CK", parts[1:]):
            if part.shape != sized.shape:
                raise AnswerError(f"{name} is {_size(part)}, but M is {_size(sized)}")
        return "second order", np.ascontiguousarray(parts), given
    if isinstance(answer, tuple) and all(_dimensions(part) == 0 for part in answer):
        raise AnswerError(
            "the function has returned a tuple of numbers; for one degree of freedom return np.array([[m]]), np.array([[c]]), "
            "np.array([[k]]), for eigenvalues an array of them"
        )
    if _dimensions(answer) == 2:
        return "first order", np.ascontiguousarray([_matrix(answer, "A")]), given
    return "eigenvalues", _eigenvalues(answer), given


def _is_dict(part: Any) -> bool:
    """A dict, and none of SciPy's sparse matrices that is one."""
    return isinstance(part, Mapping) and not hasattr(part, "toarray")


def _dimensions(part: Any) -> int:
    try:
        return part.ndim if hasattr(part, "ndim") else np.ndim(part)
    except ValueError:
        return -1


def _matrix(part: Any, name: str) -> np.ndarray:
    if hasattr(part, "toarray"):
        part = part.toarray()
    _refuse_masked(part, name)
    matrix = np.asarray(part)
    if matrix.dtype.kind == "O":
        # Numbers of another kind, such as those of SymPy.
        with contextlib.suppress(TypeError, ValueError, OverflowError):
            matrix = matrix.astype(np.float64)
    if matrix.ndim != 2 or matrix.shape[0] != matrix.shape[1] or matrix.size == 0:
        raise AnswerError(f"{name} is {_size(matrix)}; it must be square")
    if matrix.dtype.kind not in "fiu":
        raise AnswerError(f"{name} is of type {matrix.dtype}; its entries must be real numbers")
    matrix = matrix.astype(np.float64, copy=False)
    if not np.isfinite(matrix).all():
        row, column = np.argwhere(~np.isfinite(matrix))[0]
        raise AnswerError(f"{name}[{row}, {column}] is {matrix[row, column]}, no finite number")
    return matrix


def _refuse_masked(part: Any, name: str) -> None:
    if np.ma.is_masked(part):
        raise AnswerError(f"{name} has masked entries; fill them")


def _eigenvalues(answer: Any) -> np.ndarray:
    _refuse_masked(answer, "the vector of eigenvalues")
    try:
        found = np.asarray(answer)
    except (ValueError, TypeError) as error:
        raise AnswerError(f"the function has returned what is no array: {error}; {FORMS}") from error
    if found.ndim == 0 and found.dtype.kind == "O":
        raise AnswerError(f"the function has returned a {type(answer).__name__}; {FORMS}")
    if found.ndim != 1 or found.size == 0 or found.dtype.kind not in "fiuc":
        raise AnswerError(f"the function has returned an array of type {found.dtype} and shape {found.shape}; {FORMS}")
    found = np.ascontiguousarray(found, dtype=np.complex128)
    if not np.isfinite(found).all():
        raise AnswerError(
            f"eigenvalue {int(np.argmin(np.isfinite(found)))} is {found[~np.isfinite(found)][0]}, no finite number"
        )
    return found


def _given(derivative: Any, name: str, shape: tuple[int, ...]) -> np.ndarray:
    """The derivatives of all matrices by an input, of which None are zeros."""
    parts = derivative if shape[0] > 1 else (derivative,)
    if shape[0] > 1 and (not isinstance(parts, (tuple, list)) or len(parts) != shape[0]):
        raise AnswerError(f"the derivatives by {name} must be three matrices, dM, dC, dK, with None for zeros")
    found = np.zeros(shape)
    for k, part in enumerate(parts):
        if part is not None:
            matrix = _matrix(part, f"the derivative by {name}")
            if matrix.shape != shape[1:]:
                raise AnswerError(
                    f"the derivative by {name} is {_size(matrix)}, but the matrix {shape[1]} × {shape[2]}"
                )
            found[k] = matrix
    return found


def _size(matrix: np.ndarray) -> str:
    return {0: "a number", 1: f"a vector of {matrix.size}"}.get(matrix.ndim, " × ".join(map(str, matrix.shape)))


def describe(error: BaseException) -> str:
    """An exception in a line: its kind, what it says, and where it was raised."""
    if isinstance(error, AnswerError):
        return str(error)
    said = "".join(traceback.format_exception_only(type(error), error)).strip().splitlines()[-1]
    own = os.path.dirname(os.path.abspath(__file__))
    frames = [frame for frame in traceback.extract_tb(error.__traceback__) if os.path.dirname(frame.filename) != own]
    place = f" ({os.path.basename(frames[-1].filename)}, line {frames[-1].lineno})" if frames else ""
    return said + place
