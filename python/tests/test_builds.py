"""Functions as models."""

from __future__ import annotations

import io
import logging
import pickle
import sys

import numpy as np
import pytest
import systems
from conftest import OSCILLATOR

import pcc
from pcc._toml import study_text


def runs(surrogate: pcc.Surrogate) -> int:
    return surrogate.inspect()["direct_computations"]


@pytest.mark.parametrize(
    "name, function", [("clutch-r3", systems.clutch), ("flutter", systems.flutter), ("rotor", systems.rotor)]
)
def test_functions_of_matrices_build_what_studies_build(name, function, shipped):
    written = pcc.Study.read(shipped / f"{name}.toml")
    text = (shipped / f"{name}.toml").read_text()
    inputs = text[text.index("[inputs]") :]
    study = pcc.Study.from_toml(f'format = 1\nname = "{name}"\n[model]\nkind = "function"\n{inputs}', function)
    assert study.uses_derivatives and study.names == written.names
    by_study, by_function = pcc.build(written), pcc.build(study)
    assert runs(by_function) == runs(by_study)
    wrong = by_function.compare(n=3000).misclassified
    assert wrong <= max(2 * by_study.compare(written, n=3000).misclassified, 1 / 3000)
    assert abs(by_function.sample(100_000).stable - by_study.sample(100_000).stable) < 0.002


def test_derivatives_may_be_given_and_matrices_sparse(built):
    sparse = pytest.importorskip("scipy.sparse")

    def second_order(k, c):
        one = sparse.csr_matrix([[1.0]])
        return one, sparse.coo_array([[c]]), k * one, {"k": (None, None, one), "c": (None, one, np.zeros((1, 1)))}

    def first_order(k, c):
        return systems.oscillator(k, c), {"c": np.array([[0.0, 0.0], [0.0, -1.0]])}

    for function in (second_order, first_order):
        found = pcc.build(pcc.Study(OSCILLATOR, function))
        assert runs(found) == runs(built)
        assert abs(found.sample(100_000).stable - 0.75) < 0.005


def test_functions_of_eigenvalues_are_called_once_a_run():
    calls = []

    def eigenvalues(k, c):
        calls.append((k, c))
        return systems.eigenvalues_of_oscillator(k, c)

    study = pcc.Study(OSCILLATOR, eigenvalues)
    assert calls == [(100.0, 0.1)] and not study.uses_derivatives
    found = pcc.build(study)
    assert len(calls) == 1 + runs(found)
    assert abs(found.sample(100_000).stable - 0.75) < 0.005
    assert pcc.Study(OSCILLATOR, eigenvalues, answers="eigenvalues") and len(calls) == 1 + runs(found)


@pytest.mark.parametrize("jobs", [1, 3])
def test_builds_have_the_same_bytes_however_they_are_called(jobs, built):
    assert pcc.build(pcc.Study(OSCILLATOR, systems.oscillator), jobs=jobs).to_bytes() == built.to_bytes()


def test_laws_and_settings_are_those_of_study_files():
    laws = {
        "a": pcc.normal(2100, cv=0.05), "b": pcc.lognormal(median=1.0, cv=0.2, unit="N/m"), "c": pcc.beta(2, 3, lower=0.0, upper=2.0),
        "d": pcc.uniform(nominal=16e6, spread="5%"), "e": pcc.gumbel(1.0, 0.1), "f": pcc.weibull(2.0, 1.0),
        "g": pcc.log_uniform(1, 10), "h": pcc.exponential(2.0), "i": pcc.triangular(0, 1, 3), "j": pcc.gamma(3.0, 1.0),
        "k": pcc.discrete([1, 2, 4]), "l": {"distribution": "uniform", "lower": 0, "upper": 1},
    }  # fmt: skip
    study = pcc.Study(
        laws, lambda **x: np.diag([-v - 1 for v in x.values()]), name="all-laws", seed=7, answers="matrices",
        dependence={"kind": "gaussian-copula", "spearman": [["a", "b", 0.5]]}, fit={"max_degree": 4},
        spectrum={"margin": {"damping_ratio": 0.01}}, design={"maximum": 200},
    )  # fmt: skip
    text = study.to_toml()
    assert study.names == list(laws) and 'name = "all-laws"' in text and "max_degree = 4" in text
    assert pcc.Study.from_toml(text, study._model).to_toml() == text
    assert repr(pcc.uniform(0, 0.5)) == "pcc.uniform(lower=0, upper=0.5)"
    assert pickle.loads(pickle.dumps(pcc.Study(OSCILLATOR, systems.oscillator))).to_toml()


def test_what_is_fitted_may_need_what_the_function_returns():
    assert pcc.Study(OSCILLATOR, systems.oscillator, fit={"derivatives": True}).uses_derivatives
    assert not pcc.Study(OSCILLATOR, systems.oscillator, fit={"derivatives": False}).uses_derivatives
    with pytest.raises(pcc.StudyError, match="fit.derivatives"):
        pcc.Study(OSCILLATOR, systems.eigenvalues_of_oscillator, fit={"derivatives": True})


def test_constants_are_handed_over():
    study = pcc.Study({"k": pcc.uniform(90, 110)}, systems.oscillator, constants={"c": 0.1})
    assert study.answer(k=100.0)[1][0].tolist() == [[0.0, 1.0], [-100.0, -0.1]]


def test_runs_that_raise_carry_inputs_and_traceback():
    def fails(k, c):
        if c < 0.0:
            raise ZeroDivisionError("no such damper")
        return systems.oscillator(k, c)

    sentence = (
        r"the model run at k = .*, c = -.* failed: ZeroDivisionError: no such damper \(test_builds.py, line \d+\)"
    )
    with pytest.raises(pcc.RunError, match=sentence) as caught:
        pcc.build(pcc.Study(OSCILLATOR, fails))
    assert caught.value.inputs["c"] < 0.0 and isinstance(caught.value.__cause__, ZeroDivisionError)
    assert caught.value.__cause__.__traceback__.tb_next is not None
    assert pickle.loads(pickle.dumps(caught.value)).inputs == caught.value.inputs


def test_runs_that_raise_may_be_skipped(tmp_path):
    def fails(k, c):
        if k > 108.0:
            raise RuntimeError("too stiff")
        return systems.eigenvalues_of_oscillator(k, c)

    study = pcc.Study(OSCILLATOR, fails, on_failure="skip")
    with pytest.warns(RuntimeWarning, match="model runs? failed and .* skipped; the first at k = 10.*too stiff"):
        found = pcc.build(study, journal=tmp_path / "runs.journal")
    assert any("did not answer" in text or "answer" in text for text in found.sample(10_000).warnings)


def test_a_journal_keeps_runs(tmp_path, caplog):
    calls = []

    def counted(k, c):
        calls.append(k)
        if len(calls) == 30:
            raise OSError("the licence server is gone")
        return systems.eigenvalues_of_oscillator(k, c)

    study = pcc.Study(OSCILLATOR, counted, answers="eigenvalues", version="2")
    with pytest.raises(pcc.RunError, match="licence server"):
        pcc.build(study, journal=tmp_path / "j")
    before = len(calls)
    with caplog.at_level(logging.INFO, "pcc"):
        found = pcc.build(study, journal=tmp_path / "j")
    assert runs(found) <= len(calls) < runs(found) + before
    assert any("recorded" in record.message for record in caplog.records)
    assert found == pcc.build(study)


def test_surrogates_are_certified_and_compared(built):
    found = pcc.Surrogate.from_bytes(built.to_bytes())
    with pytest.raises(pcc.QuestionError, match=r"give the function, s.certify\(f\), or the study"):
        found.certify(runs=50)
    study = pcc.Study(OSCILLATOR, systems.oscillator)
    certificate = found.certify(study, runs=50)
    assert certificate.lower < 0.75 < certificate.upper and certificate.level == pytest.approx(0.9)
    assert found != built and "written to" not in repr(certificate) and len(found.inspect()["certificates"]) == 1
    with pytest.raises(pcc.QuestionError, match="seed 1 already"):
        found.certify(study, runs=50)
    compared = pcc.build(study).compare(systems.oscillator, 500)
    assert compared.misclassified < 0.01 and compared.to_dict()["samples"] == 500
    other = pcc.Study(OSCILLATOR | {"c": pcc.uniform(0, 1)}, systems.oscillator)
    with pytest.raises(pcc.Error, match="another"):
        built.compare(other, 10)


LAWS = [
    OSCILLATOR,
    {"k": pcc.normal(100, cv=0.05, unit="N/m"), "c": pcc.lognormal(median=1.0, cv=0.2)},
    {"k": pcc.uniform(nominal=100.0, spread="5%"), "c": pcc.beta(mean=0.1, std=0.1, lower=-0.1, upper=0.5)},
    {"k": pcc.weibull(2.0, 100.0), "c": pcc.discrete([-0.1, 0.1, 0.4])},
]


@pytest.mark.parametrize("laws", LAWS, ids=range(len(LAWS)))
@pytest.mark.parametrize("margin", [None, 0.1, {"damping_ratio": 0.005}], ids=["no", "rate", "ratio"])
def test_a_loaded_surrogate_takes_the_function_alone(laws, margin):
    spectrum = None if margin is None else {"margin": margin}
    study = pcc.Study(laws, systems.oscillator, name="named", spectrum=spectrum, design={"maximum": 20})
    loaded = pcc.Surrogate.from_bytes(pcc.build(study).to_bytes())
    by_function, by_study = loaded.compare(systems.oscillator, 50).to_dict(), loaded.compare(study, 50).to_dict()
    for found in (by_function, by_study):
        del found["elapsed_seconds"]
    assert by_function == by_study


OTHERS = [
    {"version": "2"},
    {"constants": {"l": 1.0}},
    {"spectrum": {"modes": [1]}},
    {"model": systems.eigenvalues_of_oscillator},
]


@pytest.mark.parametrize("others", OTHERS, ids=range(len(OTHERS)))
def test_a_function_alone_is_refused_where_the_file_does_not_say_all(others):
    model = others.get("model", lambda k, c, l=0.0: systems.oscillator(k, c))  # noqa: E741
    study = pcc.Study(OSCILLATOR, **({"model": model, "answers": None, "design": {"maximum": 60}} | others))
    loaded = pcc.Surrogate.from_bytes(pcc.build(study).to_bytes())
    with pytest.raises(pcc.QuestionError, match=r"not the problem that it was built for: .* give the study"):
        loaded.certify(systems.oscillator, runs=50)
    with pytest.raises(pcc.StudyError, match="the model is a ndarray; give a function"):
        loaded.certify(np.eye(2))


class Broken(io.StringIO):
    """A pipe that nobody reads, seen at once or once it is flushed."""

    def __init__(self, method: str) -> None:
        super().__init__()
        setattr(self, method, self._break)

    def _break(self, *_):
        raise BrokenPipeError(32, "Broken pipe")


def closed() -> io.StringIO:
    stream = io.StringIO()
    stream.close()
    return stream


STREAMS = [closed, lambda: Broken("write"), lambda: Broken("flush"), lambda: None]


@pytest.mark.parametrize("stream", STREAMS, ids=range(len(STREAMS)))
@pytest.mark.parametrize("wanted", [True, None])
def test_builds_go_on_where_progress_cannot_be_shown(monkeypatch, built, stream, wanted):
    study = pcc.Study(OSCILLATOR, systems.oscillator)
    monkeypatch.setattr(sys, "stderr", stream())
    found = pcc.build(study, progress=wanted)
    monkeypatch.undo()
    assert found == built


def test_a_notebook_keeps_one_output_of_progress():
    pytest.importorskip("IPython")
    from unittest import mock

    from pcc import _progress

    handle = mock.Mock()
    with mock.patch("IPython.display.display", return_value=handle) as display:
        progress = _progress.Progress(_progress._Output())
        for done in range(3):
            progress.show("model runs", done, 12345)
        progress.close()
    (first,), _ = display.call_args
    assert display.call_count == 1 and first["text/plain"] == "model runs: 0 of 12 345, 0 s"
    assert [call.args[0]["text/plain"] for call in handle.update.call_args_list][1:] == [
        "model runs: 2 of 12 345, 0 s",
        "",
    ]


def test_short_work_shows_no_progress(capsys, monkeypatch, built):
    monkeypatch.setattr("pcc._progress._is_terminal", lambda: True)
    assert built.sample(1000).stable > 0.5
    assert capsys.readouterr().err == ""
    built.sample(1000, progress=True)
    assert "samples: " in capsys.readouterr().err


TEXTS = ["𝜇", "🙂 on a plane of its own", "a\x7fb", 'µ "quoted" \\ \t\n\x00\x1f', "\u2028\x85\ufffe"]


@pytest.mark.parametrize("text", TEXTS, ids=range(len(TEXTS)))
def test_texts_keep_every_character(text):
    tomllib = pytest.importorskip("tomllib")
    tables = {"version": text, "inputs": {text: 1, "k": {text: text}}}
    assert tomllib.loads(study_text(tables)) == tables


def test_studies_have_characters_of_all_planes():
    study = pcc.Study(OSCILLATOR | {"k": pcc.uniform(90, 110, unit="🙂")}, systems.oscillator, version="𝜇")
    again = pcc.Study.from_toml(study.to_toml(), systems.oscillator)
    assert "🙂" in study.to_toml() and again._native.problem_hash == study._native.problem_hash


@pytest.mark.parametrize("name", ["k\n", "k.c", "", "ä"])
def test_names_that_are_not_bare_are_quoted(name):
    tomllib = pytest.importorskip("tomllib")
    assert tomllib.loads(study_text({"inputs": {name: 1}})) == {"inputs": {name: 1}}


def test_half_a_character_is_none():
    with pytest.raises(pcc.StudyError, match="half of a surrogate pair"):
        pcc.Study(OSCILLATOR, systems.oscillator, version="\ud83d")
