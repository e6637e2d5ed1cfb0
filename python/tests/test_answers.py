"""What samples say: the numbers of the command."""

from __future__ import annotations

import json
import pickle
import subprocess
import sys

import numpy as np
import pytest

import pcc

#: What differs from run to run.
CLOCK = "elapsed_seconds"


def command(shipped, *arguments: str) -> dict:
    line = [sys.executable, "-m", "pcc", "--json", "eval", str(shipped / "clutch-r2.pcc"), *arguments]
    found = json.loads(subprocess.run(line, check=True, capture_output=True).stdout)
    del found[CLOCK]
    return found


def said(answer) -> dict:
    found = answer.to_dict()
    del found[CLOCK]
    return found


def test_samples_are_those_of_the_command(clutch, shipped):
    assert said(clutch.sample(20_000, seed=3)) == command(shipped, "-n", "20000", "--seed", "3")
    asked = {"where": {"mu": (0.1, 0.2), "k_p": 16e6}, "events": ["max_re<-1", "flutter"], "quantiles": [0.5, 0.9]}
    typed = ["--where", "mu=0.1..0.2,k_p=16e6", "--events", "max_re<-1,flutter", "--quantiles", "0.5,0.9"]
    assert said(clutch.sample(20_000, **asked)) == command(shipped, "-n", "20000", *typed)
    sobol = clutch.sample(2**14, sampler="sobol", replicates=8)
    assert said(sobol) == command(shipped, "-n", "16384", "--sampler", "sobol", "--replicates", "8")


def test_sweeps_and_critical_values_are_those_of_the_command(clutch, shipped):
    swept = clutch.sweep(mu=np.linspace(0, 0.5, 6), n=2000)
    assert said(swept) == command(shipped, "-n", "2000", "--sweep", "mu=0..0.5:6")
    assert swept._repr_svg_().lstrip().startswith("<svg") or "<svg" in swept._repr_svg_()
    both = clutch.sweep({"mu": [0.0, 0.25, 0.5]}, k_p=(15.2e6, 16.8e6), n=100)
    assert len(both.points) == 6 and {"mu", "k_p", "stable_proportion"} <= set(both.points[0])
    critical = clutch.critical("mu", n=2000)
    assert critical.to_dict()["critical"] == command(shipped, "-n", "2000", "--critical", "mu")["critical"]
    assert critical.crossings[0]["stability"] == "lost"


def test_shares_are_numbers_with_intervals(clutch):
    found = clutch.sample(10_000)
    share = found.stable
    assert float(share) == found["stable_proportion"] == round(share * 10_000) / 10_000
    assert (
        share.interval() == share.interval(0.95) == tuple(found["interval"][key] for key in ("lower", "upper", "level"))
    )
    wide, narrow = share.interval(0.99), share.interval(0.5)
    assert wide.lower < share.interval().lower < narrow.lower < share < narrow.upper < wide.upper
    assert abs(found.stable + found.marginal + found.unstable - 1) < 1e-12
    assert found.flutter + found.divergence == pytest.approx(found.unstable)
    assert pickle.loads(pickle.dumps(share)).interval(0.99) == wide
    with pytest.raises(pcc.QuestionError, match="above 0 and below 1"):
        share.interval(1.0)
    with pytest.raises(pcc.QuestionError, match="0.95 alone"):
        clutch.sample(1024, sampler="sobol").stable.interval(0.9)


def test_answers_have_frames_text_and_pictures(clutch):
    pandas = pytest.importorskip("pandas")
    found = clutch.sample(10_000)
    frame = found.modes.to_frame()
    assert isinstance(frame, pandas.DataFrame) and frame["mode"].tolist() == [row["mode"] for row in found.modes]
    assert frame["frequency_hz_mean"].tolist() == [row["frequency_hz"]["mean"] for row in found.modes]
    indices = clutch.sobol(10_000)
    assert indices.to_frame()["input"].tolist() == ["mu", "k_p"] and "<svg" in indices._repr_svg_()
    assert found.verdict in repr(found) and found.verdict.split(":")[0] in found._repr_html_()
    assert isinstance(found.warnings, list) and "--details" not in repr(found) + found._repr_html_()
    found.to_dict()["modes"].clear()
    assert len(found.modes) > 0


def test_the_page_is_that_of_the_command(clutch, tmp_path):
    clutch.report(tmp_path / "page.html", n=10_000)
    page = (tmp_path / "page.html").read_text()
    assert page.lstrip().lower().startswith("<!doctype html>") and "clutch-r2" in page and "<svg" in page


def test_campbell_diagrams_have_the_quantiles_of_samples(clutch):
    values = [0.4, 0.1, 0.25]
    found = clutch.campbell(mu=values, n=2000, level=0.8)
    assert [row["mu"] for row in found.points[::4]] == sorted(values) and len(found.points) == 3 * 4
    samples = clutch.sample(2000, where={"mu": 0.25}, quantiles=[0.1, 0.5, 0.9])
    quantiles = {row["quantity"]: [one["value"] for one in row["quantiles"]] for row in samples["quantiles"]}
    for row, mode in zip(found.points[4:8], samples.modes):
        assert [row[key] for key in ("lower_hz", "median_hz", "upper_hz")] == quantiles[f"frequency_{row['mode']}"]
        assert row["unstable_share"] == mode["unstable_share"] and row["mode"] == mode["mode"]
    assert "mode 4" in found.svg and "mostly unstable" in found.svg and "bands of 80 %" in repr(found)
    assert "once per revolution" not in found.svg
    some = clutch.campbell(mu=values, n=100, modes=[4, 2])
    assert sorted({row["mode"] for row in some.points}) == [2, 4] and "mode 3" not in some.svg


@pytest.mark.parametrize("unit", ["rpm", "rad/s", "Hz"])
def test_campbell_diagrams_over_speeds_have_the_line_of_rotation(unit):
    study = pcc.Study({"n": pcc.uniform(100, 200, unit=unit), "k": pcc.uniform(90, 110)}, _whirls)
    # An input may be called as an argument is.
    found = pcc.build(study).campbell({"n": [100, 200]}, n=100)
    assert "once per revolution" in found.svg and "<svg" in found._repr_svg_()


def _whirls(n, k):
    return np.eye(2), np.array([[1.0, n / 100], [-n / 100, 1.0]]), k * np.eye(2)
