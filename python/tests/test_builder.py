"""Builds whose runs somebody else makes."""

from __future__ import annotations

import threading
from concurrent.futures import ProcessPoolExecutor, ThreadPoolExecutor
from multiprocessing import get_context

import numpy as np
import pytest
import systems
from conftest import OSCILLATOR

import pcc


def answers(study: pcc.Study, X: np.ndarray) -> list:
    return [study.answer(**dict(zip(study.names, x))) for x in X]


def run(task):
    study, x = task
    return study.answer(**dict(zip(study.names, x)))


def test_told_answers_make_the_bytes_of_a_direct_build(built, oscillator):
    builder, steps = pcc.Builder(oscillator), 0
    while len(X := builder.ask()):
        half, steps = len(X) // 2, steps + 1
        builder.tell(X[half:], answers(oscillator, X[half:]))
        assert builder.ask().tolist() == X[:half].tolist()
        if half:
            builder.tell(X[:half], answers(oscillator, X[:half]))
    assert steps > 1 and builder.result.to_bytes() == built.to_bytes()


def test_processes_answer_with_joblib(built, oscillator):
    joblib = pytest.importorskip("joblib")
    builder = pcc.Builder(oscillator)
    with joblib.Parallel(n_jobs=2) as parallel:
        while len(X := builder.ask()):
            builder.tell(X, parallel(joblib.delayed(run)((oscillator, x)) for x in X))
    assert builder.result == built


@pytest.mark.parametrize("scheduler", ["threads", "processes"])
def test_dask_answers(scheduler, built, oscillator):
    dask = pytest.importorskip("dask")
    builder = pcc.Builder(oscillator)
    while len(X := builder.ask()):
        tasks = [dask.delayed(run)((oscillator, x)) for x in X]
        builder.tell(X, dask.compute(*tasks, scheduler=scheduler, num_workers=2))
    assert builder.result.to_bytes() == built.to_bytes()


def test_a_dask_cluster_answers_in_any_order(built, oscillator):
    distributed = pytest.importorskip("distributed")
    builder = pcc.Builder(oscillator)
    cluster = distributed.LocalCluster(n_workers=2, threads_per_worker=1, processes=False, dashboard_address=None)
    with cluster, distributed.Client(cluster) as client:
        while len(X := builder.ask()):
            rows = {client.submit(run, (oscillator, x)): row for row, x in enumerate(X)}
            for future in distributed.as_completed(rows):
                builder.tell(X[rows[future]][np.newaxis], [future.result()])
    assert builder.result.to_bytes() == built.to_bytes()


def test_processes_answer_with_futures(oscillator):
    study = pcc.Study(OSCILLATOR, systems.eigenvalues_of_oscillator)
    builder = pcc.Builder(study)
    with ProcessPoolExecutor(2, mp_context=get_context("spawn")) as executor:
        while len(X := builder.ask()):
            builder.tell(X, list(executor.map(run, [(study, x) for x in X])))
    assert builder.result == pcc.build(study)


def test_a_journal_keeps_answers(tmp_path, built, oscillator):
    builder = pcc.Builder(oscillator, journal=tmp_path / "j")
    X = builder.ask()
    builder.tell(X, answers(oscillator, X))
    del builder
    builder = pcc.Builder(oscillator, journal=tmp_path / "j")
    assert builder.ask().tolist() != X.tolist()
    assert pcc.build(oscillator) == built


def test_answers_that_cannot_be_taken_are_refused(oscillator):
    builder = pcc.Builder(oscillator)
    X = builder.ask()
    with pytest.raises(pcc.TellError, match="2 points and 1 answers"):
        builder.tell(X[:2], answers(oscillator, X[:1]))
    with pytest.raises(pcc.TellError, match="no point that the design has asked for"):
        builder.tell(X[:1] * (1 + 1e-12), answers(oscillator, X[:1]))
    with pytest.raises(pcc.TellError, match="answer 0 has no derivatives by k, c"):
        builder.tell(X[:1], [systems.oscillator(*X[0])])
    with pytest.raises(pcc.TellError, match="rows 0 and 1 of X are the same point; answer it once"):
        builder.tell(X[[0, 0]], answers(oscillator, X[:1]) * 2)
    for not_a_list in ({0: 1.0}, {1.0}, map(float, "1"), "no"):
        with pytest.raises(pcc.TellError, match="give a list with an answer for each row"):
            builder.tell(X[:1], not_a_list)
    with pytest.raises(pcc.TellError, match="answer 0: the function has returned None"):
        builder.tell(X[:1], [None])
    with pytest.raises(pcc.BuildError, match="not answered yet"):
        _ = builder.result
    assert builder.ask().tolist() == X.tolist()


def test_failures_are_told_and_skipped():
    study = pcc.Study(OSCILLATOR, systems.eigenvalues_of_oscillator, on_failure="skip")
    builder = pcc.Builder(study)
    while len(X := builder.ask()):
        builder.tell(X, [ValueError("no") if k > 109 else run((study, (k, c))) for k, c in X])
    assert abs(builder.result.sample(10_000).stable - 0.75) < 0.05


def test_threads_may_tell_at_once(tmp_path, built, oscillator):
    builder = pcc.Builder(oscillator, journal=tmp_path / "j")
    while len(X := builder.ask()):
        known, barrier = answers(oscillator, X), threading.Barrier(len(X))

        def tell(row, X=X, known=known, barrier=barrier):
            barrier.wait(30)
            builder.tell(X[row : row + 1], known[row : row + 1])

        with ThreadPoolExecutor(len(X)) as executor:
            list(executor.map(tell, range(len(X))))
        assert not set(map(tuple, X)) & set(map(tuple, builder.ask()))
    assert builder.result == built
    del builder, tell
    assert not len(pcc.Builder(oscillator, journal=tmp_path / "j").ask())


A, M, BY = np.eye(2)[None], np.array([np.eye(2)] * 3), np.zeros((2, 1, 2, 2))
SHAPES = [
    ("first order", np.zeros((1, 2, 3)), BY),
    ("first order", np.zeros((1, 0, 0)), np.zeros((2, 1, 0, 0))),
    ("first order", np.zeros((0, 2, 2)), BY),
    ("first order", M, BY),
    ("first order", A, BY[:1]),
    ("first order", A, np.zeros((2, 1, 4, 1))),
    ("first order", A, BY[0]),
    ("first order", A.astype(np.float32), BY),
    ("second order", A, BY),
    ("second order", M, BY),
    ("third order", A, BY),
    ("eigenvalues", np.empty(0, complex), None),
    ("eigenvalues", np.zeros((2, 2), complex), None),
    ("eigenvalues", [1.0, 2.0], None),
]


@pytest.mark.parametrize("answer", SHAPES, ids=range(len(SHAPES)))
def test_tuples_that_are_no_answers_are_refused(oscillator, answer):
    builder = pcc.Builder(oscillator)
    X = builder.ask()
    with pytest.raises(pcc.TellError, match=r"^answer 1: .*(answer|eigenvalues)"):
        builder.tell(X[:2], [*answers(oscillator, X[:1]), answer])
    assert builder.ask().tolist() == X.tolist()


def test_answers_are_read_whatever_their_order_in_memory(built, oscillator):
    builder = pcc.Builder(oscillator)
    while len(X := builder.ask()):
        told = [(form, np.asfortranarray(A), by.copy().T.copy().T) for form, A, by in answers(oscillator, X)]
        builder.tell(X, told)
    assert builder.result == built
