"""Surrogates: their files, values at points, and the model's word."""

from __future__ import annotations

import json
import os
from collections.abc import Callable
from typing import Any

import numpy as np

from . import _arguments as arguments
from . import _pcc
from ._errors import FileError, QuestionError
from ._files import Kind, keep_certificates, path_of, save
from ._points import as_points
from ._progress import progress as _progress
from ._questions import Questions
from ._results import Certificate, Comparison, as_html
from ._study import Study, study_of

VERDICTS = np.array(["stable", "marginal", "flutter", "divergence"])


class Surrogate(Questions):
    """What a build makes: the eigenvalues of a model as polynomials of its inputs. See :func:`load` and :func:`build`.

    A surrogate is pickled as the bytes of its file, and equal to others with the same bytes. It has no hash: a
    certificate changes its bytes.
    """

    def __init__(self, native: _pcc.Surrogate, study: Study | None = None, path: str = "") -> None:
        if not isinstance(native, _pcc.Surrogate):
            raise TypeError("surrogates come from files, pcc.load(path), and from builds, pcc.build(study)")
        self._native, self._study, self._path = native, study, path

    # Its file.

    def to_bytes(self, format: str = "binary") -> bytes:
        """The bytes of its file, ``"binary"`` or ``"json"``."""
        if format not in ("binary", "json"):
            raise QuestionError(f'format is {format!r}; choose "binary" or "json"')
        return self._native.to_bytes(format == "json")

    @classmethod
    def from_bytes(cls, data: bytes) -> Surrogate:
        """The surrogate in the bytes of a file."""
        if not isinstance(data, (bytes, bytearray, memoryview)):
            raise FileError(f"a {type(data).__name__} is not the bytes of a surrogate; of a file it is pcc.load(path)")
        return cls(_pcc.Surrogate(bytes(data)))

    def save(self, path: str | os.PathLike, *, overwrite: bool = False) -> None:
        """Write it to a file: JSON if its name ends in ``.json``, else binary. The file appears whole or not at all.

        Parameters
        ----------
        path : path
            The file. A surrogate there is replaced.
        overwrite : bool
            Whether certificates of a surrogate there may be lost. Each has cost model runs.

        Raises
        ------
        FileError
            If the file cannot be written, exists and is no surrogate, or has certificates that this one has not.
        """
        path = path_of(path)
        if not overwrite:
            keep_certificates(path, self.inspect())
        data = self.to_bytes("json" if path.lower().endswith(".json") else "binary")
        save(path, data, Kind.SURROGATE)
        self._path = path

    def __reduce__(self):
        return type(self).from_bytes, (self.to_bytes("json" if self._native.is_json else "binary"),)

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Surrogate) and self.to_bytes() == other.to_bytes()

    __hash__ = None  # type: ignore[assignment]

    # What is in it.

    @property
    def names(self) -> list[str]:
        """Names of the inputs, in order: the columns of points."""
        return self._native.names

    @property
    def labels(self) -> list[str]:
        """Names of the eigenvalues, in the order of the columns of :meth:`eigenvalues`: ``"3"`` is mode 3, ``"3_b"``
        its second eigenvalue, ``"real_1"`` one that belongs to no mode."""
        return self._native.labels

    @property
    def study(self) -> Study | None:
        """The study it was built from, if it was built here."""
        return self._study

    def inspect(self) -> dict[str, Any]:
        """What is inside: inputs, components, degrees, errors, provenance. The JSON of ``pcc inspect``."""
        return json.loads(self._native.inspect(self._path, len(self.to_bytes()))[0])

    def __repr__(self) -> str:
        return f"<pcc.Surrogate {self._native.study_name}: inputs {', '.join(self.names)}>"

    def _repr_html_(self) -> str:
        return as_html(self._native.inspect(self._path or "this", len(self.to_bytes()))[1])

    # Values at points.

    def eigenvalues(self, X: Any, *, extrapolate: bool = False) -> np.ndarray:
        """Every eigenvalue at every point.

        Parameters
        ----------
        X : array, mapping or table
            Points in physical units: an array with a row for each and a column for each input in the order of
            :attr:`names`, or a dict or table of columns with these names, whose other columns are ignored.
        extrapolate : bool
            Whether points outside the domain are evaluated all the same.

        Returns
        -------
        ndarray of complex128
            A row for each point and a column for each of :attr:`labels`, in 1/s.
        """
        points = as_points(X, self.names)
        found = np.empty((len(points), len(self.labels)), dtype=np.complex128)
        self._native.eigenvalues(points, found, bool(extrapolate))
        return found

    def max_re(self, X: Any, *, extrapolate: bool = False) -> np.ndarray:
        """The spectral abscissa max Re λ at every point, in 1/s. Parameters as of :meth:`eigenvalues`."""
        points = as_points(X, self.names)
        found = np.empty(len(points))
        self._native.max_re(points, found, bool(extrapolate))
        return found

    def verdict(self, X: Any, *, extrapolate: bool = False) -> np.ndarray:
        """``"stable"``, ``"marginal"``, ``"flutter"`` or ``"divergence"`` at every point. Parameters as of
        :meth:`eigenvalues`."""
        return VERDICTS[self._native.verdict(as_points(X, self.names), bool(extrapolate))]

    # The model's word.

    def certify(
        self,
        model: Study | Callable[..., Any] | None = None,
        runs: int = 300,
        seed: int = 1,
        *,
        jobs: int = 1,
        journal: str | os.PathLike | None = None,
        failures: str = "stop",
        progress: bool | None = None,
    ) -> Certificate:
        """Bound the true share of stable systems by fresh runs of the model. The surrogate keeps the certificate.

        Parameters
        ----------
        model : Study or callable, optional
            The study it was built from, or its function; if not given, the study, where it was built here. A loaded
            surrogate makes the study of what its file has, and takes it if it is the one that it was built from.
        runs : int
            Number of runs at random points; others are added where they say more.
        seed : int
            Seed of the points; a second certificate needs another.
        failures : {"stop", "count"}
            Whether a run that fails ends it, or counts as disagreement.
        """
        study = self._study_with(model)
        settings = arguments.runs(jobs, journal, counts_failures=arguments.counts_failures(failures))
        runs, seed = arguments.count(runs, "runs"), arguments.count(seed, "seed", least=0)
        native, said, text = _pcc.certify(self._native, study._native, runs, seed, settings, _progress(progress))
        self._native = native
        return Certificate((said, text, []), in_file=False)

    def compare(
        self,
        model: Study | Callable[..., Any] | None = None,
        n: int = 1000,
        seed: int = 1,
        *,
        jobs: int = 1,
        journal: str | os.PathLike | None = None,
        failures: str = "stop",
        progress: bool | None = None,
    ) -> Comparison:
        """Compare it with its model at the same `n` random points. Parameters as of :meth:`certify`."""
        study = self._study_with(model)
        settings = arguments.runs(jobs, journal, counts_failures=arguments.counts_failures(failures))
        n, seed = arguments.count(n, "n"), arguments.count(seed, "seed", least=0)
        said, text = _pcc.compare(self._native, study._native, n, seed, settings, _progress(progress))
        return Comparison((said, text, []))

    def _study_with(self, model: Any) -> Study:
        if isinstance(model, Study):
            return model
        if model is None:
            if self._study is None:
                raise QuestionError(
                    "the file of a surrogate does not hold its model; give the function, s.certify(f), or the study: "
                    's.certify(pcc.Study(...)), s.compare(pcc.Study.read("study.toml"))'
                )
            return self._study
        if self._study is None:
            return study_of(self.inspect(), model)
        return Study.from_toml(self._study._text, model, self._study._folder)


def load(path: str | os.PathLike) -> Surrogate:
    """Read a surrogate from its file, binary or JSON.

    Parameters
    ----------
    path : path
        The file.

    Returns
    -------
    Surrogate

    Examples
    --------
    >>> import pcc
    >>> s = pcc.load("clutch.pcc")  # doctest: +SKIP
    """
    path = path_of(path)
    try:
        with open(path, "rb") as file:
            data = file.read()
    except OSError as error:
        raise FileError(f"{path}: cannot be read: {error.strerror or error}") from error
    try:
        return Surrogate(_pcc.Surrogate(data), path=path)
    except FileError as error:
        raise FileError(f"{path}: {error}") from None
