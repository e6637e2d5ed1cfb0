"""Surrogates: values at points, and answers of samples."""

from __future__ import annotations

import html
import json
import os
import re
from collections.abc import Callable, Mapping, Sequence
from typing import Any

import numpy as np

from . import _pcc
from ._errors import FileError, QuestionError
from ._files import Kind, refuse_to_replace, save
from ._points import as_points
from ._progress import progress as _progress
from ._results import Answer, Certificate, Comparison, Critical, Samples, Sensitivities, Sweep
from ._study import Study

VERDICTS = np.array(["stable", "marginal", "flutter", "divergence"])
SAMPLERS = ("monte-carlo", "sobol", "latin-hypercube")
_EVENT = re.compile(r"^\s*([^<>\s]+)\s*([<>])\s*(\S+)\s*$")
_KINDS = ("flutter", "divergence", "marginal")


class Surrogate:
    """What a build makes: the eigenvalues of a model as polynomials of its inputs. See :func:`load` and :func:`build`.

    A surrogate is pickled as the bytes of its file, and equal to others with the same bytes. It has no hash: a
    certificate changes its bytes.
    """

    def __init__(self, native: _pcc.Surrogate, study: Study | None = None, path: str = "") -> None:
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
        return cls(_pcc.Surrogate(data))

    def save(self, path: str | os.PathLike) -> None:
        """Write it to a file: JSON if its name ends in ``.json``, else binary. The file appears whole or not at all.

        Parameters
        ----------
        path : path
            The file. A surrogate there is replaced.

        Raises
        ------
        FileError
            If the file cannot be written, or exists and is no surrogate.
        """
        path = os.fsdecode(path)
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
        return f"<pre>{html.escape(self._native.inspect(self._path, len(self.to_bytes()))[1])}</pre>"

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

    # What samples say.

    def sample(
        self,
        n: int = 1_000_000,
        seed: int = 1,
        *,
        where: Mapping[str, Any] | None = None,
        events: Sequence[str] = (),
        quantiles: Sequence[float] = (),
        histograms: Sequence[str] = (),
        sampler: str = "monte-carlo",
        replicates: int | None = None,
        progress: bool | None = None,
    ) -> Samples:
        """How likely the system is to be stable, by random samples of the inputs: ``pcc eval``.

        Parameters
        ----------
        n : int
            Number of samples.
        seed : int
            Seed of the samples. The same seed gives the same answer on any machine.
        where : mapping, optional
            Inputs that are confined, ``{"mu": (0.1, 0.2)}``, or fixed, ``{"mu": 0.1}``.
        events : sequence of str
            Further events that are counted, like ``"max_re<-1"``.
        quantiles : sequence of float
            Probabilities of quantiles of max Re λ and of every mode.
        histograms : sequence of str
            Quantities whose histograms are made, like ``"max_re"``.
        sampler : {"monte-carlo", "sobol", "latin-hypercube"}
            How samples are drawn.
        replicates : int, optional
            Independent randomisations that the samples of the other two are divided among.
        progress : bool, optional
            Whether progress is shown; if it is not said, in terminals and notebooks.

        Returns
        -------
        Samples
        """
        answer = self._ask(
            n, seed, where, progress, events=events, quantiles=quantiles, histograms=histograms, sampler=sampler,
            replicates=replicates,
        )  # fmt: skip
        return Samples(answer)

    def sobol(
        self,
        n: int = 1_000_000,
        seed: int = 1,
        *,
        where: Mapping[str, Any] | None = None,
        progress: bool | None = None,
    ) -> Sensitivities:
        """Which inputs decide on stability. Parameters as of :meth:`sample`."""
        return Sensitivities(self._ask(n, seed, where, progress))

    def sweep(
        self,
        ranges: Mapping[str, Any] | None = None,
        /,
        *,
        n: int = 100_000,
        seed: int = 1,
        where: Mapping[str, Any] | None = None,
        events: Sequence[str] = (),
        progress: bool | None = None,
        **inputs: Any,
    ) -> Sweep:
        """The share along one input, or as a map over two.

        Parameters
        ----------
        ranges, **inputs : mapping
            Values of inputs, equally spaced: ``mu=np.linspace(0, 0.5, 50)``.
        n : int
            Number of samples at each point.
        """
        swept = [_sweep(name, values) for name, values in {**(ranges or {}), **inputs}.items()]
        if not swept:
            raise QuestionError("there is no input to sweep; write s.sweep(mu=np.linspace(0, 0.5, 50))")
        return Sweep(self._ask(n, seed, where, progress, sweeps=swept, events=events))

    def critical(self, name: str, n: int = 1_000_000, seed: int = 1, *, progress: bool | None = None) -> Critical:
        """Where the system loses stability: the values of an input, given the other inputs.

        Parameters
        ----------
        name : str
            The input.
        n : int
            Number of samples of the other inputs.
        """
        return Critical(self._ask(n, seed, None, progress, critical=_text(name, "the input")))

    def report(
        self, path: str | os.PathLike, n: int = 1_000_000, seed: int = 1, *, progress: bool | None = None
    ) -> None:
        """Put it on one page: an HTML file with its answer, pictures and tables.

        Parameters
        ----------
        path : path
            The file. A page of ``pcc report`` there is replaced.
        n, seed : int
            Number and seed of the samples.

        Raises
        ------
        FileError
            If the file cannot be written, or exists and is no page of ``pcc report``.
        """
        path = os.fsdecode(path)
        refuse_to_replace(path, Kind.PAGE)
        about = (self._path, len(self.to_bytes()))
        n, seed = _count(n, "n"), _count(seed, "seed", least=0)
        page = self._native.page(about, n, seed, _progress(progress))
        save(path, page.encode(), Kind.PAGE)

    def _ask(
        self,
        n: int,
        seed: int,
        where: Mapping[str, Any] | None,
        progress: bool | None,
        *,
        events: Sequence[str] = (),
        quantiles: Sequence[float] = (),
        histograms: Sequence[str] = (),
        sweeps: Sequence[tuple] = (),
        critical: str | None = None,
        sampler: str = "monte-carlo",
        replicates: int | None = None,
    ) -> tuple[str, str, list[str]]:
        if sampler not in SAMPLERS:
            raise QuestionError(f"sampler is {sampler!r}; choose one of {', '.join(map(repr, SAMPLERS))}")
        asked = {
            "samples": _count(n, "n"),
            "seed": _count(seed, "seed", least=0),
            "sampler": sampler,
            "replicates": replicates if replicates is None else _count(replicates, "replicates", most=1000),
            "conditions": [_condition(name, value) for name, value in (where or {}).items()],
            "sweeps": list(sweeps),
            "events": [_event(text) for text in _several(events, "events")],
            "histograms": [_text(quantity, "a histogram") for quantity in _several(histograms, "histograms")],
            "quantiles": [_number(level, "a quantile's probability") for level in _several(quantiles, "quantiles")],
            "critical": critical,
        }
        return self._native.ask(asked, _progress(progress))

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
            The study it was built from, or its function where that study is known; if not given, that study.
        runs : int
            Number of runs at random points; others are added where they say more.
        seed : int
            Seed of the points; a second certificate needs another.
        failures : {"stop", "count"}
            Whether a run that fails ends it, or counts as disagreement.
        """
        study = self._study_with(model)
        settings = _runs(jobs, journal, counts_failures=_failures(failures))
        runs, seed = _count(runs, "runs"), _count(seed, "seed", least=0)
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
        settings = _runs(jobs, journal, counts_failures=_failures(failures))
        n, seed = _count(n, "n"), _count(seed, "seed", least=0)
        said, text = _pcc.compare(self._native, study._native, n, seed, settings, _progress(progress))
        return Comparison((said, text, []))

    def _study_with(self, model: Any) -> Study:
        if isinstance(model, Study):
            return model
        if self._study is None:
            raise QuestionError(
                "the file of a surrogate does not say what computes its model; give the study: s.certify(pcc.Study(...)) or "
                's.compare(pcc.Study.read("study.toml"))'
            )
        if model is None:
            return self._study
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
    path = os.fspath(path)
    try:
        with open(path, "rb") as file:
            data = file.read()
    except OSError as error:
        raise FileError(f"{path}: cannot be read: {error.strerror or error}") from error
    try:
        return Surrogate(_pcc.Surrogate(data), path=path)
    except FileError as error:
        raise FileError(f"{path}: {error}") from None


def _runs(
    jobs: int, journal: str | os.PathLike | None, *, retry_failed: bool = False, counts_failures: bool = False
) -> dict[str, Any]:
    journal = None if journal is None else os.fspath(journal)
    jobs = _count(jobs, "jobs", most=10_000)
    return {"jobs": jobs, "journal": journal, "retry_failed": bool(retry_failed), "counts_failures": counts_failures}


def _failures(word: str) -> bool:
    if word not in ("stop", "count"):
        raise QuestionError(f'failures is {word!r}; choose "stop" or "count"')
    return word == "count"


def _count(value: Any, name: str, least: int = 1, most: int = 2**63 - 1) -> int:
    try:
        number = int(value) if not isinstance(value, (str, bytes)) and value == int(value) else None
    except (TypeError, ValueError, OverflowError):
        number = None
    if number is None or isinstance(value, bool) or not least <= number <= most:
        raise QuestionError(f"{name} is {value!r}; give a whole number from {least} to {most}")
    return number


def _number(value: Any, what: str) -> float:
    try:
        return float(value)
    except (TypeError, ValueError):
        raise QuestionError(f"{what} is {value!r}; give a number") from None


def _text(value: Any, what: str) -> str:
    if not isinstance(value, str):
        raise QuestionError(f"{what} is {value!r}; give its name")
    return value


def _several(values: Any, name: str) -> list:
    if isinstance(values, (str, bytes)) or not hasattr(values, "__iter__"):
        raise QuestionError(f"{name} is {values!r}; give a list")
    return list(values)


def _condition(name: Any, value: Any) -> tuple[str, float, float]:
    ends = np.ravel(value) if np.ndim(value) else [value, value]
    if len(ends) != 2:
        raise QuestionError(f"where: {name} is {value!r}; give a value, or the lower and the upper end of an interval")
    lower, upper = (_number(end, f"where: {name}") for end in ends)
    return _text(name, "where: an input"), lower, upper


def _event(text: Any) -> tuple[str, bool, float]:
    text = _text(text, "an event")
    if text.strip() in _KINDS:
        return text.strip(), False, 0.0
    match = _EVENT.match(text)
    if not match:
        raise QuestionError(f'the event {text!r} is not understood; write "max_re<-1", or one of {", ".join(_KINDS)}')
    return match[1], match[2] == "<", _number(match[3], f"the threshold of the event {text!r}")


def _sweep(name: str, values: Any) -> tuple[str, float, float, int]:
    if hasattr(values, "__next__"):
        raise QuestionError(f"the values of {name} are a generator; give an array, np.linspace(0, 0.5, 50)")
    try:
        found = np.asarray(values, dtype=float)
    except (TypeError, ValueError):
        raise QuestionError(f"the values of {name} are no numbers") from None
    if found.ndim != 1 or found.size < 2 or not np.isfinite(found).all():
        raise QuestionError(f"a sweep of {name} takes at least two finite values, np.linspace(0, 0.5, 50)")
    spaced = np.linspace(found[0], found[-1], found.size)
    if np.abs(found - spaced).max() > 1e-9 * np.abs(found[-1] - found[0]) or found[0] == found[-1]:
        raise QuestionError(f"the values of {name} are not equally spaced; a sweep is np.linspace(first, last, points)")
    return name, float(found[0]), float(found[-1]), int(found.size)


__all__ = ["Answer", "Surrogate", "load"]
