"""Builds: here, or of runs that somebody else makes."""

from __future__ import annotations

import os
import warnings
from collections.abc import Mapping, Sequence, Set
from typing import Any

import numpy as np

from . import _pcc
from ._arguments import runs
from ._errors import AnswerError, StudyError, TellError
from ._files import path_of
from ._model import describe, read
from ._points import as_points
from ._progress import progress as _progress
from ._study import Study
from ._surrogate import Surrogate


def build(
    study: Study,
    *,
    jobs: int = 1,
    journal: str | os.PathLike | None = None,
    retry_failed: bool = False,
    progress: bool | None = None,
) -> Surrogate:
    """Build the surrogate of a study.

    Parameters
    ----------
    study : Study
        The study.
    jobs : int
        Calls of its function that go on at once. One is made by the thread that calls this function, as if you called
        the function yourself. More are made by threads, which pays where the function waits or computes in NumPy.
    journal : path, optional
        A file in which every run is recorded; a build with the same journal goes on from there.
    retry_failed : bool
        Whether recorded failures that the study would skip are tried again.
    progress : bool, optional
        Whether progress is shown; if it is not said, in terminals and notebooks. What a build has to say besides goes
        to the log ``pcc``.

    Returns
    -------
    Surrogate

    Raises
    ------
    RunError
        If the function raised: with the inputs, and the exception as its cause.
    BuildError
        If the runs make no surrogate.

    Examples
    --------
    >>> import numpy as np, pcc
    >>> def oscillator(k, c):
    ...     return np.array([[0.0, 1.0], [-k, -c]])
    >>> study = pcc.Study({"k": pcc.uniform(90, 110), "c": pcc.uniform(-0.1, 0.3)}, oscillator)
    >>> s = pcc.build(study)
    >>> abs(s.sample(100_000).stable - 0.75) < 0.01
    True
    """
    if not isinstance(study, Study):
        raise StudyError(
            f'build takes a study, not a {type(study).__name__}: pcc.Study(...), or pcc.Study.read("study.toml")'
        )
    settings = runs(jobs, journal, retry_failed=retry_failed)
    data, failed = _pcc.build(study._native, settings, _progress(progress))
    if failed:
        warnings.warn(f"{len(failed)} model runs failed and were skipped; the first at {failed[0]}", RuntimeWarning, 2)
    return Surrogate(_pcc.Surrogate(data), study)


class Builder:
    """A build whose runs are made by whatever you have: joblib, Dask, a scheduler.

    Where a model has eigenvalues that are zero, or symmetric matrices without damping, the builder calls the function
    itself at up to 16 points, to see whether its structure makes it so.

    Parameters
    ----------
    study : Study
        The study.
    journal : path, optional
        A file in which every answer is recorded; a builder with the same journal goes on from there.

    Examples
    --------
    >>> import numpy as np, pcc
    >>> def oscillator(k, c):
    ...     return np.array([[0.0, 1.0], [-k, -c]])
    >>> study = pcc.Study({"k": pcc.uniform(90, 110), "c": pcc.uniform(-0.1, 0.3)}, oscillator)
    >>> b = pcc.Builder(study)
    >>> while len(X := b.ask()):
    ...     b.tell(X, [study.answer(**dict(zip(study.names, x))) for x in X])
    >>> b.result == pcc.build(study)
    True
    """

    def __init__(self, study: Study, *, journal: str | os.PathLike | None = None) -> None:
        if not isinstance(study, Study):
            raise StudyError(f"Builder takes a study, not a {type(study).__name__}")
        self._study = study
        self._native = _pcc.Builder(study._native, None if journal is None else path_of(journal))

    @property
    def study(self) -> Study:
        """The study."""
        return self._study

    def ask(self) -> np.ndarray:
        """The points that wait for an answer, a row each, in physical units; no row if the build is complete."""
        return self._native.ask()

    def tell(self, X: Any, answers: Sequence[Any]) -> None:
        """Answer points that :meth:`ask` has given, all or some of them.

        Parameters
        ----------
        X : array, mapping or table
            The points, unchanged.
        answers : sequence
            For each point what :meth:`Study.answer` gives, or what the model's function returns: with derivatives by
            all inputs if the study fits derivatives. An exception, or a text, stands for a run that failed.
        """
        X = as_points(X, self._study.names)
        if (
            isinstance(answers, (str, bytes, Mapping, Set))
            or not hasattr(answers, "__len__")
            or not hasattr(answers, "__iter__")
        ):
            raise TellError(f"answers is a {type(answers).__name__}; give a list with an answer for each row of X")
        if len(answers) != len(X):
            raise TellError(f"there are {len(X)} points and {len(answers)} answers; give one for each")
        seen: dict[bytes, int] = {}
        for row, x in enumerate(X):
            if (first := seen.setdefault(x.tobytes(), row)) != row:
                raise TellError(f"rows {first} and {row} of X are the same point; answer it once")
        self._native.tell(X, [self._told(row, answer) for row, answer in enumerate(answers)])

    def _told(self, row: int, answer: Any) -> Any:
        if isinstance(answer, BaseException):
            return describe(answer)
        if isinstance(answer, str):
            return answer
        if isinstance(answer, tuple) and len(answer) == 3 and isinstance(answer[0], str):
            return answer
        study = self._study._native
        try:
            form, numbers, given = read(answer)
        except AnswerError as error:
            raise TellError(f"answer {row}: {error}") from None
        if form == "eigenvalues" or not study.uses_derivatives:
            return form, numbers, None
        missing = [name for name in study.names if name not in given]
        if missing:
            raise TellError(
                f"answer {row} has no derivatives by {', '.join(missing)}, which the study fits; tell what study.answer(**inputs) "
                'gives, or set fit={"derivatives": False}'
            )
        from ._model import _given

        return form, numbers, np.ascontiguousarray([_given(given[name], name, numbers.shape) for name in study.names])

    @property
    def result(self) -> Surrogate:
        """The surrogate, once :meth:`ask` gives no points: the same bytes as of :func:`build`."""
        return Surrogate(_pcc.Surrogate(self._native.result()), self._study)
