"""UM-Bridge in both directions, with the protocol's own Python package: its client asks `pcc serve`, and models on its
servers are those of studies. The protocol's public tests of servers are no part of the package; where `.ci/python` could
get them, `PCC_UMBRIDGE_SUITE` is their folder."""

from __future__ import annotations

import contextlib
import json
import os
import socket
import subprocess
import sys
import textwrap
import time
import urllib.request
from pathlib import Path

import numpy as np
import pytest

import pcc

umbridge = pytest.importorskip("umbridge")

POINT = [0.25, 16e6]


@contextlib.contextmanager
def running(command, **options):
    process = subprocess.Popen(command, text=True, **options)
    try:
        yield process
    finally:
        process.kill()
        process.communicate()


@pytest.fixture(scope="module")
def served(shipped):
    """`pcc serve`, and what it says of itself."""
    command = [sys.executable, "-m", "pcc", "serve", str(shipped / "clutch-r2.pcc"), "--port", "0", "--json"]
    with running(command, stdout=subprocess.PIPE) as process:
        text = ""
        while not text.endswith("\n}\n"):
            line = process.stdout.readline()
            assert line, "it ended before it said where it is"
            text += line
        yield json.loads(text)


def test_the_client_of_the_package_is_answered(served, clutch, points):
    url = served["url"]
    assert umbridge.supported_models(url) == ["eigenvalues", "max_re", "verdict"]
    models = {name: umbridge.HTTPModel(url, name) for name in umbridge.supported_models(url)}
    for listed in served["models"]:
        model = models[listed["name"]]
        assert (model.get_input_sizes(), model.get_output_sizes()) == ([2], [listed["outputs"]])
        assert model.supports_evaluate() and not model.supports_gradient()
        assert not model.supports_apply_jacobian() and not model.supports_apply_hessian()
    some = points[:20]
    found = np.array([models["eigenvalues"]([list(point)])[0] for point in some])
    one_of_each_pair = found[:, 0::4] + 1j * found[:, 1::4]
    assert np.array_equal(one_of_each_pair, clutch.eigenvalues(some))
    assert np.array_equal(found[:, 2::4] + 1j * found[:, 3::4], clutch.eigenvalues(some).conj())
    assert np.array_equal([models["max_re"]([list(point)])[0][0] for point in some], clutch.max_re(some))
    verdicts = [["stable", "marginal", "flutter", "divergence"][int(models["verdict"]([list(p)])[0][0])] for p in some]
    assert verdicts == list(clutch.verdict(some))


def test_the_client_of_the_package_sees_what_is_wrong(served):
    model = umbridge.HTTPModel(served["url"], "max_re")
    for input, config, sentence in [
        ([[0.25]], {}, r"InvalidInput: .*1 number; write \[\[mu, k_p\]\]"),
        ([[0.25], [16e6]], {}, r"InvalidInput: .*\[\[mu, k_p\]\]"),
        ([[0.7, 16e6]], {}, r"InvalidInput: mu = 0.7 lies outside \[0.0, 0.5\]; move the point"),
        ([POINT], {"level": 1}, r"InvalidInput: .*unknown key .*level"),
        ([[1e300, 16e6]], {"extrapolate": True}, r"InvalidOutput: .*no finite value"),
    ]:
        with pytest.raises(Exception, match=sentence):
            model(input, config)
    assert model([[0.5000001, 16e6]], {"extrapolate": True})
    with pytest.raises(Exception, match="not supported by server"):
        umbridge.HTTPModel(served["url"], "forward")
    # Memory is not shared; the client goes on over HTTP.
    shared = umbridge.HTTPModel(served["url"], "max_re", use_shmem=True)
    assert not shared.supports_shmem() and shared([POINT]) == model([POINT])


@pytest.mark.skipif("PCC_UMBRIDGE_SUITE" not in os.environ, reason="the protocol's public tests are not here")
def test_the_public_tests_of_the_protocol_pass(served):
    suite = Path(os.environ["PCC_UMBRIDGE_SUITE"]) / "test_model_schema.py"
    asked = [f"--model_url={served['url']}", f"--input_value={json.dumps(POINT, separators=(',', ':'))}"]
    command = [sys.executable, "-m", "pytest", "-q", "-p", "no:cacheprovider", str(suite), *asked]
    found = subprocess.run(command, capture_output=True, text=True, cwd=suite.parent)
    assert found.returncode == 0, found.stdout
    assert "22 passed" in found.stdout and "skipped" not in found.stdout, found.stdout


SERVER = """
    import math, sys
    import numpy as np
    import umbridge

    class Belt(umbridge.Model):
        def __init__(self):
            super().__init__("belt")

        def get_input_sizes(self, config):
            return [1, 1]

        def get_output_sizes(self, config):
            return [2] * 4

        def supports_evaluate(self):
            return True

        def __call__(self, parameters, config):
            [mu], [k_n] = parameters
            fails_from = config.get("fails_from", math.inf)
            if mu > fails_from:
                raise ValueError("no equilibrium")
            stiffness = np.array([[3000.0, 500.0 - mu * k_n], [500.0, 1000.0 + k_n]])
            state = np.block([[np.zeros((2, 2)), np.eye(2)], [-stiffness / 2, -np.eye(2)]])
            factor = math.nan if mu > config.get("nan_from", math.inf) else 1.0
            return [[float(v.real) * factor, float(v.imag)] for v in np.linalg.eigvals(state)]

    umbridge.serve_models([Belt()], int(sys.argv[1]), max_workers=4)
"""

STUDY = """
    format = 1
    name = "belt"
    [model]
    kind = "um-bridge"
    url = "{url}"
    name = "belt"
    eigenvalues = 4
    jobs = 4
    {keys}
    [inputs]
    mu = {{ distribution = "uniform", lower = 0.0, upper = 0.5 }}
    k_n = {{ distribution = "uniform", lower = 1800.0, upper = 2400.0 }}
"""


@pytest.fixture(scope="module")
def url():
    """A server of the package, with the belt."""
    with socket.socket() as free:
        free.bind(("127.0.0.1", 0))
        port = free.getsockname()[1]
    quiet = {"stdout": subprocess.DEVNULL, "stderr": subprocess.DEVNULL}
    with running([sys.executable, "-c", textwrap.dedent(SERVER), str(port)], **quiet):
        address = f"http://127.0.0.1:{port}"
        for _ in range(300):
            with contextlib.suppress(OSError):
                urllib.request.urlopen(f"{address}/Info")
                break
            time.sleep(0.1)
        yield address


def study(folder, url, keys=""):
    path = folder / "belt.toml"
    path.write_text(textwrap.dedent(STUDY.format(url=url, keys=keys)))
    return path


def belt(mu, k_n):
    stiffness = np.array([[3000.0, 500.0 - mu * k_n], [500.0, 1000.0 + k_n]])
    return 2.0 * np.eye(2), 2.0 * np.eye(2), stiffness


def test_a_model_on_a_server_of_the_package_is_built_from(url, tmp_path):
    found = pcc.build(pcc.Study.read(study(tmp_path, url)), journal=str(tmp_path / "belt.journal"))
    inputs = {"mu": pcc.uniform(0, 0.5), "k_n": pcc.uniform(1800, 2400)}
    expected = pcc.build(pcc.Study(inputs, belt))
    random = np.random.default_rng(1)
    some = np.column_stack([random.uniform(0.0, 0.5, 500), random.uniform(1800.0, 2400.0, 500)])
    assert np.mean(found.verdict(some) != expected.verdict(some)) < 0.01
    assert np.max(np.abs(found.max_re(some) - expected.max_re(some))) < 0.05


def test_the_command_compares_with_the_server(url, tmp_path):
    study(tmp_path, url)
    run = lambda *arguments: subprocess.run(  # noqa: E731
        [sys.executable, "-m", "pcc", *arguments, "--json"], capture_output=True, text=True, cwd=tmp_path
    )
    built = run("build", "belt.toml")
    assert built.returncode == 0, built.stderr
    compared = run("compare", "belt.pcc", "-n", "200")
    assert compared.returncode == 0, compared.stderr
    assert json.loads(compared.stdout)["misclassified_percent"] < 1.0


@pytest.mark.parametrize(
    "key, cause",
    [("fails_from", "HTTP status 500"), ("nan_from", "holds nan, which is not a number")],
)
def test_models_that_fail_stop_the_build_or_are_skipped(url, tmp_path, key, cause):
    keys = f"config = {{ {key} = 0.45 }}"
    here = {"capture_output": True, "text": True, "cwd": tmp_path}
    study(tmp_path, url, keys)
    stopped = subprocess.run([sys.executable, "-m", "pcc", "build", "belt.toml", "--no-journal"], **here)
    assert stopped.returncode == 2 and cause in " ".join(stopped.stderr.split()), stopped.stderr
    study(tmp_path, url, keys + '\n    on_failure = "skip"')
    skipped = subprocess.run([sys.executable, "-m", "pcc", "build", "belt.toml", "--no-journal", "--json"], **here)
    assert skipped.returncode == 0, skipped.stderr
    failed = json.loads(skipped.stdout)["failed_runs"]
    assert failed and all(cause in run["cause"] for run in failed)


def test_a_model_that_does_not_fit_is_refused(url, tmp_path):
    for change, sentence in [
        (("name = \"belt\"\neigen", "name = \"brake\"\neigen"), 'has no model "brake"; it has "belt"'),
        (("eigenvalues = 4", "eigenvalues = 2"), "answers 8 numbers, in lists of [2, 2, 2, 2], but 2 eigenvalues are 4"),
        (("k_n = {", "k_n = { distribution = \"uniform\", lower = 1.0, upper = 2.0 }\nk = {"), "takes 2 numbers"),
    ]:
        path = study(tmp_path, url)
        text = path.read_text()
        assert change[0] in text
        path.write_text(text.replace(*change))
        with pytest.raises(pcc.Error) as error:
            pcc.build(pcc.Study.read(path))
        assert sentence in str(error.value)
