"""Studies: a model, its uncertain inputs, and what is asked."""

from __future__ import annotations

import os
import re
from collections.abc import Callable, Iterator, Mapping
from typing import Any

import numpy as np

from . import _pcc
from ._errors import AnswerError, QuestionError, RunError, StudyError
from ._files import path_of
from ._model import Function, describe, kind_of, read
from ._toml import study_text

_LINE = re.compile(r"(study\.toml: )?line \d+: ")
_PARSING = re.compile(
    r"TOML parse error at line \d+.*?\n\s*\d+ \| (?P<line>[^\n]*)\n[^\n]*\^[^\n]*\n(?P<why>.*)", re.DOTALL
)


class Study:
    """A model, its uncertain inputs, and what is asked.

    Parameters
    ----------
    inputs : mapping of str to law
        The uncertain inputs with their laws, such as ``pcc.uniform(0, 0.5)``, in their order.
    model : callable
        A function ``f(**inputs)`` of all inputs by name, in physical units, that returns M, C and K of
        M Ü + C U̇ + K U = 0, or A of ẋ = A x, as arrays or sparse matrices, or all eigenvalues as a vector. With matrices
        it may return a dict of their derivatives by inputs, ``return M, C, K, {"mu": (dM, dC, dK)}`` or ``return A, {"mu":
        dA}``, None for zeros; the others come from differences of the matrices.
    name : str
        Name of the study and of what is built from it.
    seed : int
        Seed of the design.
    constants : mapping of str to float, optional
        What the function is given beside the inputs.
    answers : {"matrices", "eigenvalues"}, optional
        What the function returns. If it is not said, the function is called once with all inputs at their medians.
    on_failure : {"stop", "skip"}
        Whether a run that raises ends the build, or is left out and reported.
    version : str
        To be changed when the function answers otherwise: what a journal has of earlier versions is not used.
    spectrum, design, fit, dependence : mapping, optional
        The tables of a study file with these names, such as ``fit={"max_degree": 10}``.

    Examples
    --------
    >>> import numpy as np, pcc
    >>> def oscillator(k, c):
    ...     return np.array([[0.0, 1.0], [-k, -c]])
    >>> study = pcc.Study({"k": pcc.uniform(90, 110), "c": pcc.uniform(-0.1, 0.3)}, oscillator)
    >>> study.names
    ['k', 'c']
    """

    def __init__(
        self,
        inputs: Mapping[str, Mapping[str, Any]],
        model: Callable[..., Any],
        *,
        name: str = "study",
        seed: int = 1,
        constants: Mapping[str, float] | None = None,
        answers: str | None = None,
        on_failure: str = "stop",
        version: str = "1",
        spectrum: Mapping[str, Any] | None = None,
        design: Mapping[str, Any] | None = None,
        fit: Mapping[str, Any] | None = None,
        dependence: Mapping[str, Any] | None = None,
    ) -> None:
        _check_function(model)
        if not isinstance(inputs, Mapping) or not all(isinstance(law, Mapping) for law in inputs.values()):
            raise StudyError('inputs is no dict of laws; write inputs={"mu": pcc.uniform(0, 0.5)}')

        others = {"spectrum": spectrum, "design": design, "fit": fit, "dependence": dependence}

        def text(answers: str, others: Mapping[str, Any]) -> str:
            of_model: dict[str, Any] = {"kind": "function", "answers": answers}
            of_model |= {"on_failure": on_failure, "version": version}
            tables: dict[str, Any] = {"format": 1, "name": name, "seed": seed, "model": of_model}
            if constants:
                of_model["constants"] = dict(constants)
            tables["inputs"] = dict(inputs)
            return study_text(tables | {table: keys for table, keys in others.items() if keys})

        if answers is None:
            # What is fitted may need what is not known yet.
            answers = _probe(_from_text(text("eigenvalues", {}), "."), model)
        written = text(answers, others)
        self._set(written, os.getcwd(), _from_text(written, "."), model)

    def _set(self, text: str, folder: str, native: _pcc.Study, model: Callable[..., Any] | None) -> None:
        self._text, self._folder, self._function = text, folder, None
        if model is not None:
            self._function = Function(model, native)
            native = native.with_function(self._function)
        self._native, self._model = native, model

    @classmethod
    def read(cls, path: str | os.PathLike, model: Callable[..., Any] | None = None) -> Study:
        """Read a study file.

        Parameters
        ----------
        path : path
            The file.
        model : callable, optional
            The function of a study whose ``model.kind`` is "function".

        Returns
        -------
        Study
        """
        path = path_of(path)
        native = _pcc.Study.read(path)
        study = cls.__new__(cls)
        if model is not None:
            _check_function(model)
        with open(path, encoding="utf-8") as file:
            study._set(file.read(), os.path.dirname(os.path.abspath(path)), native, model)
        return study

    @classmethod
    def from_toml(cls, text: str, model: Callable[..., Any] | None = None, folder: str | os.PathLike = ".") -> Study:
        """Read the text of a study file; files that it names lie in `folder`."""
        if model is not None:
            _check_function(model)
        if not isinstance(text, str):
            raise StudyError(f"the text of a study is a {type(text).__name__}; a file is read by pcc.Study.read(path)")
        study, folder = cls.__new__(cls), path_of(folder)
        study._set(text, os.path.abspath(folder), _pcc.Study.from_toml(text, folder), model)
        return study

    @property
    def name(self) -> str:
        """Name of the study and of what is built from it."""
        return self._native.name

    @property
    def names(self) -> list[str]:
        """Names of the inputs, in order."""
        return self._native.names

    @property
    def medians(self) -> dict[str, float]:
        """All inputs at their medians."""
        return dict(zip(self.names, self._native.medians))

    @property
    def uses_derivatives(self) -> bool:
        """Whether derivatives of the model enter the fit."""
        return self._native.uses_derivatives

    def to_toml(self) -> str:
        """The study as a file with every default filled in. The function itself is not in it."""
        return self._native.to_toml()

    def answer(self, **inputs: float) -> Any:
        """One run of the function, for :meth:`Builder.tell`: what it returns, with the derivatives that the fit takes.

        Parameters
        ----------
        **inputs : float
            The inputs, in physical units.

        Returns
        -------
        tuple
            Plain arrays, which can be pickled and sent to another process.
        """
        if self._function is None:
            raise StudyError(f"the model of this study is of kind {self._native.kind!r}, and no function of Python's")
        missing = [name for name in self.names if name not in inputs]
        if missing or len(inputs) > len(self.names):
            raise StudyError(f"answer() takes the inputs {', '.join(self.names)}, not {', '.join(inputs) or 'nothing'}")
        return self._function([_value_of(name, inputs[name]) for name in self.names], self.uses_derivatives)

    def __reduce__(self):
        return type(self).from_toml, (self._text, self._model, self._folder)

    def __repr__(self) -> str:
        return f"<pcc.Study {self.name}: {self._native.kind}, inputs {', '.join(self.names)}>"


def _value_of(name: str, value: Any) -> float:
    try:
        if np.ndim(value) == 0:
            return float(value)
    except (TypeError, ValueError, OverflowError):
        pass
    raise StudyError(f"answer() takes a number for {name}, not {value!r}")


def _check_function(model: Any) -> None:
    if isinstance(model, Iterator):
        raise StudyError("the model is a generator; give a function that returns M, C, K")
    if not callable(model):
        raise StudyError(f"the model is a {type(model).__name__}; give a function f(**inputs) that returns M, C, K")


def _from_text(text: str, folder: str) -> _pcc.Study:
    """The study of a text that nobody wrote, so that its lines mean nothing."""
    try:
        return _pcc.Study.from_toml(text, folder)
    except StudyError as error:
        said = _LINE.sub("", str(error))
        parsing = _PARSING.search(said)
        raise StudyError(f"{parsing['line']}: {parsing['why'].strip()}" if parsing else said) from None


def _probe(study: _pcc.Study, model: Callable[..., Any]) -> str:
    """What a function answers, seen once with all inputs at their medians."""
    point = study.medians
    inputs = dict(zip(study.names, point))
    try:
        form, _, _ = read(model(**inputs, **dict(study.constants)))
    except Exception as error:
        is_ours = isinstance(error, AnswerError)
        sentence = f"the model failed with all inputs at their medians, {study.describe(point)}: {describe(error)}"
        raise RunError(sentence, inputs.items()) from (None if is_ours else error)
    return kind_of(form)


def study_of(found: Mapping[str, Any], model: Callable[..., Any]) -> Study:
    """The study of a function that a surrogate was built from, made of what its file says: its inspection."""
    _check_function(model)
    spectrum: dict[str, Any] = {}
    if found["margin"]:
        spectrum["margin"] = found["margin"].get("growth_rate", found["margin"])
    dependence = found.get("dependence")
    try:
        study = Study(
            {known["name"]: _law_of(known) for known in found["inputs"]},
            model,
            name=found["study"],
            spectrum=spectrum,
            dependence=dependence and _dependence_of(dependence),
        )
        problem = study._native.problem_hash
    except StudyError:
        problem = None
    if problem != found["problem_hash"]:
        raise QuestionError(
            "this function, with the inputs and the margin that the file of the surrogate has, is not the problem that it was "
            "built for: further settings, such as version, constants or spectrum, are not in the file; give the study, "
            "s.certify(pcc.Study(...))"
        )
    return study


def _law_of(known: Mapping[str, Any]) -> dict[str, Any]:
    law = {"distribution": known["distribution"], **known["parameters"]}
    if known.get("levels"):
        law["values"] = [level["value"] for level in known["levels"]]
        law["weights"] = [level["proportion"] for level in known["levels"]]
    return law


def _dependence_of(dependence: Mapping[str, Any]) -> dict[str, Any]:
    pairs = [[pair["first"], pair["second"], pair["spearman"]] for pair in dependence["correlations"]]
    return {"kind": dependence["kind"], "spearman": pairs}
