"""Arguments of questions: what users write, checked and in the form that the library takes."""

from __future__ import annotations

import os
import re
from collections.abc import Mapping
from typing import Any

import numpy as np

from ._errors import QuestionError
from ._files import path_of

_EVENT = re.compile(r"^\s*([^<>\s]+)\s*([<>])\s*(\S+)\s*$")
_KINDS = ("flutter", "divergence", "marginal")


def runs(
    jobs: int, journal: str | os.PathLike | None, *, retry_failed: bool = False, counts_failures: bool = False
) -> dict[str, Any]:
    """Who runs the model, and where it is recorded."""
    journal = None if journal is None else path_of(journal)
    jobs = count(jobs, "jobs", most=10_000)
    return {"jobs": jobs, "journal": journal, "retry_failed": bool(retry_failed), "counts_failures": counts_failures}


def counts_failures(word: str) -> bool:
    """Whether a run that fails counts as disagreement."""
    if word not in ("stop", "count"):
        raise QuestionError(f'failures is {word!r}; choose "stop" or "count"')
    return word == "count"


def count(value: Any, name: str, least: int = 1, most: int = 2**63 - 1) -> int:
    """A whole number, of any type that has them."""
    try:
        is_one = np.ndim(value) == 0 and not isinstance(value, (str, bytes))
        whole = int(value) if is_one and value == int(value) else None
    except (TypeError, ValueError, OverflowError):
        whole = None
    if whole is None or isinstance(value, (bool, np.bool_)) or not least <= whole <= most:
        raise QuestionError(f"{name} is {value!r}; give a whole number from {least} to {most}")
    return whole


def number(value: Any, what: str) -> float:
    """A number."""
    try:
        if np.ndim(value) == 0:
            return float(value)
    except (TypeError, ValueError, OverflowError):
        pass
    raise QuestionError(f"{what} is {value!r}; give a number")


def text(value: Any, what: str) -> str:
    """The name of something."""
    if not isinstance(value, str):
        raise QuestionError(f"{what} is {value!r}; give its name")
    return value


def several(values: Any, name: str) -> list:
    """A list of things, and not one alone."""
    if isinstance(values, (str, bytes)) or not hasattr(values, "__iter__"):
        raise QuestionError(f"{name} is {values!r}; give a list")
    return list(values)


def by_input(values: Any, name: str, example: str) -> dict[str, Any]:
    """A dict by inputs."""
    if values is None:
        return {}
    if not isinstance(values, Mapping):
        raise QuestionError(f"{name} is a {type(values).__name__}; give a dict by inputs, {example}")
    return dict(values)


def condition(name: Any, value: Any) -> tuple[str, float, float]:
    """An input with both ends of the interval that it is confined to."""
    try:
        ends = [value, value] if isinstance(value, (str, bytes)) else list(value)
    except TypeError:
        ends = [value, value]
    if len(ends) != 2:
        raise QuestionError(f"where: {name} is {value!r}; give a value, or the lower and the upper end of an interval")
    lower, upper = (number(end, f"where: {name}") for end in ends)
    return text(name, "where: an input"), lower, upper


def event(words: Any) -> tuple[str, bool, float]:
    """A quantity, whether it is to lie below, and the threshold."""
    words = text(words, "an event")
    if words.strip() in _KINDS:
        return words.strip(), False, 0.0
    match = _EVENT.match(words)
    if not match:
        raise QuestionError(f'the event {words!r} is not understood; write "max_re<-1", or one of {", ".join(_KINDS)}')
    return match[1], match[2] == "<", number(match[3], f"the threshold of the event {words!r}")


def values_of(name: str, values: Any) -> np.ndarray:
    """The values of an input along which something is asked, at least two."""
    text(name, "an input")
    if hasattr(values, "__next__"):
        raise QuestionError(f"the values of {name} are a generator; give an array, np.linspace(0, 0.5, 50)")
    try:
        found = np.asarray(values, dtype=float)
    except (TypeError, ValueError):
        raise QuestionError(f"the values of {name} are no numbers") from None
    if found.ndim != 1 or found.size < 2 or not np.isfinite(found).all():
        raise QuestionError(f"the values of {name} are to be at least two finite numbers, np.linspace(0, 0.5, 50)")
    return found


def sweep(name: str, values: Any) -> tuple[str, float, float, int]:
    """An input with its first and last value, and how many there are."""
    found = values_of(name, values)
    spaced = np.linspace(found[0], found[-1], found.size)
    if np.abs(found - spaced).max() > 1e-9 * np.abs(found[-1] - found[0]) or found[0] == found[-1]:
        raise QuestionError(f"the values of {name} are not equally spaced; a sweep is np.linspace(first, last, points)")
    return name, float(found[0]), float(found[-1]), int(found.size)
