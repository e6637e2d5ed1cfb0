"""Derivatives by differences of matrices, against derivatives that are known."""

from __future__ import annotations

import math

import numpy as np
import pytest
import systems
from conftest import OSCILLATOR

import pcc


def function(a, b, c):
    """Matrices whose entries differ by orders of magnitude."""
    return np.array([[1e6 * math.exp(-a), math.sin(3 * b)], [a * b, -1e6 / c]])


def derivatives(a, b, c):
    return [
        np.array([[-1e6 * math.exp(-a), 0.0], [b, 0.0]]),
        np.array([[0.0, 3 * math.cos(3 * b)], [a, 0.0]]),
        np.array([[0.0, 0.0], [0.0, 1e6 / c**2]]),
    ]


LAWS = [
    {"a": pcc.uniform(0, 2), "b": pcc.normal(1, 0.3), "c": pcc.lognormal(median=10, cv=0.5)},
    {"a": pcc.beta(2, 3), "b": pcc.uniform(0, 1e-3), "c": pcc.log_uniform(1, 1e4)},
    {"a": pcc.exponential(1.0), "b": pcc.triangular(0, 1, 3), "c": pcc.normal(10, 1, lower=8, upper=12)},
]


@pytest.mark.parametrize("laws", LAWS, ids=range(len(LAWS)))
@pytest.mark.parametrize("place", [0.0, 1e-3, 0.5, 0.999, 1.0])
def test_derivatives_have_many_digits_wherever_the_point_lies(laws, place):
    study = pcc.Study(laws, function)
    ends = {"a": (0, 1), "b": (0, 1e-3), "c": (9, 11)}
    inputs = {name: float(lower + place * (upper - lower)) for name, (lower, upper) in ends.items()}
    found = study.answer(**inputs)[2][:, 0]
    # Errors are relative to what the matrix changes by over all of the law.
    for j, (name, expected) in enumerate(zip(inputs, derivatives(**inputs))):
        middle = np.abs(derivatives(**study.medians)[j]).max()
        assert np.abs(found[j] - expected).max() < 1e-5 * max(np.abs(expected).max(), middle), name


def test_affine_matrices_keep_all_digits():
    study = pcc.Study(OSCILLATOR, systems.oscillator)
    for k, c in [(90.0, -0.1), (100.0, 0.0), (110.0, 0.3)]:
        by_k, by_c = study.answer(k=k, c=c)[2][:, 0]
        assert np.abs(by_k - [[0, 0], [-1, 0]]).max() < 1e-13 and np.abs(by_c - [[0, 0], [0, -1]]).max() < 1e-13


def test_no_more_matrices_are_made_than_two_an_input():
    calls = []

    def counted(k, c):
        calls.append((k, c))
        return systems.oscillator(k, c)

    study = pcc.Study(OSCILLATOR, counted, answers="matrices")
    study.answer(k=95.0, c=0.0)
    to_choose, before = len(calls) - 5, len(calls)
    assert to_choose <= 1 + 2 * 2 * 11
    study.answer(k=96.0, c=0.0)
    assert len(calls) - before == 5
    # Where they are given, none are made.
    given = pcc.Study(
        OSCILLATOR, lambda k, c: (counted(k, c), {name: np.zeros((2, 2)) for name in "kc"}), answers="matrices"
    )
    before = len(calls)
    given.answer(k=95.0, c=0.0)
    assert len(calls) - before <= 2


GIVEN = [
    (["k"], []),
    (["c"], ["k"]),
    (["k", "c"], []),
    ([], ["c"]),
]


@pytest.mark.parametrize("first, later", GIVEN, ids=range(len(GIVEN)))
def test_runs_may_differ_in_the_derivatives_that_they_give(first, later):
    by = {"k": np.array([[0.0, 0.0], [-1.0, 0.0]]), "c": np.array([[0.0, 0.0], [0.0, -1.0]])}
    given = [first]
    study = pcc.Study(
        OSCILLATOR,
        lambda k, c: (systems.oscillator(k, c), {name: by[name] for name in given[0]}),
        answers="matrices",
    )
    for names in (first, later):
        given[0] = names
        found = study.answer(k=95.0, c=0.0)[2][:, 0]
        assert np.abs(found - [by["k"], by["c"]]).max() < 1e-13


def second_order(k, c):
    return np.eye(2), np.eye(2) * c, np.eye(2) * k


FORMS = [
    (systems.oscillator, second_order, "has returned A at one point and M, C, K beside it"),
    (second_order, systems.oscillator, "has returned M, C, K at one point and A beside it"),
    (systems.oscillator, systems.eigenvalues_of_oscillator, "has returned eigenvalues, but the study says"),
    (second_order, systems.eigenvalues_of_oscillator, "has returned eigenvalues, but the study says"),
]


@pytest.mark.parametrize("here, beside, sentence", FORMS, ids=range(len(FORMS)))
def test_answers_have_one_form(here, beside, sentence):
    study = pcc.Study(OSCILLATOR, lambda k, c: (here if k == 100.0 else beside)(k, c), answers="matrices")
    with pytest.raises(pcc.AnswerError, match=sentence):
        study.answer(k=100.0, c=0.1)
