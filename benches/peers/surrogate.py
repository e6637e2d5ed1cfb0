"""The JSON form of a surrogate: what is needed to evaluate it, and how its components become eigenvalues."""

from __future__ import annotations

import json
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

MultiIndex = tuple[int, ...]

# Frequencies closer than this, relative to their size, are equal: growth rates decide the order.
EQUAL_FREQUENCY = 1e-12


class UnsupportedSurrogate(Exception):
    """The file is not something these scripts can evaluate."""


@dataclass(frozen=True)
class Output:
    """Components, by position, that form the eigenvalues of some modes."""

    kind: str
    modes: list[int]
    components: list[int]


@dataclass(frozen=True)
class Surrogate:
    """One global expansion per component: value = center + scale * sum of coefficient * product of polynomials."""

    study: str
    inputs: list[str]
    lower: np.ndarray
    upper: np.ndarray
    # Per input b_1, b_2, ... of the recurrence b_(k+1) p_(k+1) = z p_k - b_k p_(k-1).
    off_diagonal: list[np.ndarray]
    components: list[str]
    outputs: list[Output]
    # The multi-indices of all components, the constant first; per multi-index (row) and component the coefficient.
    indices: list[MultiIndex]
    coefficients: np.ndarray
    center: np.ndarray
    scale: np.ndarray

    @property
    def modes(self) -> list[int]:
        """The modes in the order in which `eigenvalues` has them."""
        return [mode for output in self.outputs for mode in output.modes]

    def physical_coefficients(self) -> np.ndarray:
        """Coefficients of the values themselves: with the scales, and the centers in the constant's row."""
        coefficients: np.ndarray = self.coefficients * self.scale
        coefficients[0] += self.center
        return coefficients

    def eigenvalues(self, values: np.ndarray) -> np.ndarray:
        """Eigenvalues, one column per mode, from the values of the components, one column each."""
        return np.column_stack([column for output in self.outputs for column in _recombine(output, values)])


def load(path: Path) -> Surrogate:
    """Reads a surrogate; raises `UnsupportedSurrogate` if it is anything but global Legendre expansions."""
    try:
        document = json.loads(path.read_text(encoding="utf-8"))
    except ValueError as error:
        raise UnsupportedSurrogate(f"not JSON ({error}); `pcc convert` makes JSON of a .pcc file") from error
    try:
        return _from_document(document)
    except (KeyError, TypeError) as error:
        raise UnsupportedSurrogate(f"not a surrogate: {type(error).__name__} {error}") from error


def _from_document(document: dict[str, Any]) -> Surrogate:
    _require_one_element(document)
    inputs = document["inputs"]["inputs"]
    components = sorted(
        (component for output in document["outputs"]["outputs"] for component in output["components"]),
        key=lambda component: component["id"],
    )
    indices, coefficients = _expansions(document["expansions"], len(inputs), len(components))
    return Surrogate(
        study=document["meta"]["study_name"],
        inputs=[known["name"] for known in inputs],
        lower=np.array([known["distribution"]["uniform"]["lower"] for known in inputs]),
        upper=np.array([known["distribution"]["uniform"]["upper"] for known in inputs]),
        off_diagonal=[_off_diagonal(known) for known in inputs],
        components=[component["name"] for component in components],
        outputs=[_output(output) for output in document["outputs"]["outputs"]],
        indices=indices,
        coefficients=coefficients,
        center=np.array([component["center"] for component in components]),
        scale=np.array([component["scale"] for component in components]),
    )


def _require_one_element(document: dict[str, Any]) -> None:
    number = len(document["elements"]["elements"])
    if number != 1:
        raise UnsupportedSurrogate(f"it has {number} elements; only global expansions, of one element, are compared")


def _off_diagonal(known: dict[str, Any]) -> np.ndarray:
    """The recurrence of an input, after a check that it is the one of orthonormal Legendre polynomials."""
    off_diagonal = np.array(known["recurrence"]["off_diagonal"])
    degrees = np.arange(1, len(off_diagonal) + 1)
    legendre = degrees / np.sqrt(4.0 * degrees**2 - 1.0)
    if known["family"] != "legendre" or not np.allclose(off_diagonal, legendre, rtol=1e-14, atol=0.0):
        raise UnsupportedSurrogate(f"the polynomials of {known['name']} are not orthonormal Legendre polynomials")
    return off_diagonal


def _output(output: dict[str, Any]) -> Output:
    kind, modes = output["kind"], output["modes"]
    if (kind, len(modes)) not in (("eigenvalue", 1), ("cluster", 2)):
        raise UnsupportedSurrogate(
            f"output {output['name']!r} is of kind {kind!r} with {len(modes)} modes; "
            "only single eigenvalues and clusters of two modes are compared"
        )
    return Output(kind, modes, [component["id"] for component in output["components"]])


def _expansions(section: dict[str, Any], inputs: int, components: int) -> tuple[list[MultiIndex], np.ndarray]:
    """The union of all multi-indices, the constant first, and the coefficients over it."""
    sets = [[tuple(index) for index in indices] for indices in section["index_sets"]]
    union = {index for indices in sets for index in indices} | {(0,) * inputs}
    indices = sorted(union, key=lambda index: (sum(index), index))
    row = {index: position for position, index in enumerate(indices)}
    coefficients = np.zeros((len(indices), components))
    for expansion in section["expansions"]:
        rows = [row[index] for index in sets[expansion["index_set"]]]
        coefficients[rows, expansion["component"]] = expansion["coefficients"]
    return indices, coefficients


def _recombine(output: Output, values: np.ndarray) -> list[np.ndarray]:
    """The eigenvalues of an output's modes, by frequency, equal frequencies by growth rate."""
    parts = values[:, output.components]
    if output.kind == "eigenvalue":
        return [parts[:, 0] + 1j * parts[:, 1]]
    mean = parts[:, 0] + 1j * parts[:, 1]
    root = np.sqrt(-(parts[:, 2] + 1j * parts[:, 3]))
    first, second = mean - root, mean + root
    gap = first.imag - second.imag
    equal = np.abs(gap) <= EQUAL_FREQUENCY * np.abs(first.imag)
    swapped = np.where(equal, first.real > second.real, gap > 0.0)
    return [np.where(swapped, second, first), np.where(swapped, first, second)]
