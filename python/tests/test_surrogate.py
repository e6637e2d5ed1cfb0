"""Files and values at points."""

from __future__ import annotations

import copy
import csv
import json
import pickle
import subprocess
import sys

import numpy as np
import pytest
from conftest import SHIPPED

import pcc


def test_a_surrogate_is_the_bytes_of_its_file(clutch, shipped, tmp_path):
    assert clutch.to_bytes() == (shipped / "clutch-r2.pcc").read_bytes()
    assert clutch.to_bytes("json") == (shipped / "clutch-r2.json").read_bytes()
    for name in ["a.pcc", "b.json"]:
        clutch.save(tmp_path / name)
        again = pcc.load(tmp_path / name)
        assert again == clutch
        assert pickle.loads(pickle.dumps(again)).to_bytes() == clutch.to_bytes()
    assert copy.deepcopy(clutch) == clutch
    assert clutch != pcc.load(shipped / "clutch-r1.pcc")
    assert sorted(path.name for path in tmp_path.iterdir()) == ["a.pcc", "b.json"]


def test_values_at_points_are_those_of_the_command(clutch, points, shipped, tmp_path):
    (tmp_path / "in.csv").write_text("mu,k_p\n" + "".join(f"{mu!r},{k_p!r}\n" for mu, k_p in points.tolist()))
    command = [sys.executable, "-m", "pcc", "eval", str(shipped / "clutch-r2.pcc")]
    subprocess.run([*command, "--points", "in.csv", "--out", "out.csv"], cwd=tmp_path, check=True, capture_output=True)
    rows = list(csv.DictReader((tmp_path / "out.csv").open()))
    eigenvalues = clutch.eigenvalues(points)
    assert eigenvalues.dtype == np.complex128 and eigenvalues.shape == (1000, len(clutch.labels))
    for column, label in enumerate(clutch.labels):
        assert [float(row[f"re_{label}"]) for row in rows] == eigenvalues[:, column].real.tolist()
    assert [float(row["max_re"]) for row in rows] == clutch.max_re(points).tolist()
    assert [row["verdict"] for row in rows] == clutch.verdict(points).tolist()


def test_points_come_in_many_forms(clutch, points):
    pandas = pytest.importorskip("pandas")
    expected = clutch.max_re(points)
    mu, k_p = points.T
    records = np.array(list(zip(k_p, mu)), dtype=[("k_p", float), ("mu", float)])
    forms = [
        np.asfortranarray(points), points[::1], np.repeat(points, 2, axis=0)[::2], points.tolist(), points.astype(object),
        {"k_p": k_p, "mu": mu}, {"mu": mu.tolist(), "k_p": k_p, "more": "text"}, records,
        pandas.DataFrame({"colour": "red", "k_p": k_p, "mu": mu}),
    ]  # fmt: skip
    for form in forms:
        assert clutch.max_re(form).tolist() == expected.tolist()
    # A number stands for a whole column, and whole numbers are numbers.
    assert (
        clutch.max_re({"mu": [0.1, 0.2], "k_p": 16_000_000}).tolist()
        == clutch.max_re([[0.1, 16e6], [0.2, 16e6]]).tolist()
    )
    assert clutch.max_re(points.astype(np.float32).astype(float)).shape == (1000,)
    assert clutch.eigenvalues(np.empty((0, 2))).shape == (0, len(clutch.labels))
    assert not np.shares_memory(clutch.eigenvalues(points), points)


def test_one_input_needs_no_second_dimension(shipped):
    one = pcc.load(shipped / "clutch-r1.pcc")
    assert one.max_re([0.1, 0.2]).tolist() == one.max_re([[0.1], [0.2]]).tolist()


def test_points_outside_are_refused_unless_they_are_asked_for(clutch):
    with pytest.raises(pcc.PointsError, match=r"row 1: mu = 0.7 lies outside \[0.0, 0.5\]"):
        clutch.max_re([[0.1, 16e6], [0.7, 16e6]])
    assert np.isfinite(clutch.max_re([[0.7, 16e6]], extrapolate=True)).all()


def test_inspect_is_that_of_the_command(clutch, shipped):
    command = [sys.executable, "-m", "pcc", "--json", "inspect", str(shipped / "clutch-r2.pcc")]
    said = json.loads(subprocess.run(command, check=True, capture_output=True).stdout)
    found = pcc.load(shipped / "clutch-r2.pcc").inspect()
    assert found == said
    assert clutch.names == [one["name"] for one in found["inputs"]]
    assert "clutch-r2" in repr(clutch) and "<pre" in clutch._repr_html_()
    assert ">this is a surrogate of clutch-r2" in pcc.Surrogate.from_bytes(clutch.to_bytes())._repr_html_()


OTHERS = {
    "study.toml": b'format = 1\nname = "belt"\n',
    "points.csv": b"mu,k_p\n0.1,16e6\n",
    "settings.json": b'{"colour": {"format": 1}}',
    "notes.txt": b"\x89PC",
}


@pytest.mark.parametrize("name", OTHERS)
def test_files_of_another_kind_are_not_replaced(clutch, tmp_path, name):
    path = tmp_path / name
    path.write_bytes(OTHERS[name])
    before = clutch._path
    with pytest.raises(pcc.FileError, match=f"{name}: exists and is not a surrogate"):
        clutch.save(path)
    with pytest.raises(pcc.FileError, match=f"{name}: exists and was not made by pcc report"):
        clutch.report(path, n=1000)
    assert path.read_bytes() == OTHERS[name] and clutch._path == before


def test_files_are_replaced_by_their_like(clutch, shipped, tmp_path):
    page, file, empty = tmp_path / "page.html", tmp_path / "clutch.pcc", tmp_path / "empty"
    empty.touch()
    surrogate = pcc.load(shipped / "clutch-r1.pcc")
    for start in ["clutch-r2.pcc", "clutch-r2.json", "clutch-r1.json"]:
        file.write_bytes((shipped / start).read_bytes())
        surrogate.save(file)
        assert pcc.load(file) == surrogate
    surrogate.save(empty)
    for n in (1000, 2000):
        surrogate.report(page, n=n)
    for path, write in [(page, surrogate.save), (file, surrogate.report)]:
        before = path.read_bytes()
        with pytest.raises(pcc.FileError, match="exists and "):
            write(path)
        assert path.read_bytes() == before


def test_certificates_are_not_lost_without_a_word(built, oscillator, tmp_path):
    path = tmp_path / "oscillator.pcc"
    certified = pcc.Surrogate.from_bytes(built.to_bytes())
    certified.certify(oscillator, runs=50)
    certified.save(path)
    certified.save(path)
    bytes_of_certified = path.read_bytes()
    with pytest.raises(
        pcc.FileError, match=r"oscillator.pcc: has 1 certificate, which would be lost; .* overwrite=True"
    ):
        built.save(path)
    # A certificate more loses none.
    more = pcc.load(path)
    more.certify(oscillator, runs=50, seed=2)
    more.save(path)
    for other in (certified, built, pcc.load(SHIPPED / "clutch-r1.pcc")):
        with pytest.raises(pcc.FileError, match="has [12] certificates?, which would be lost"):
            other.save(path)
    assert pcc.load(path) == more and bytes_of_certified != path.read_bytes()
    built.save(path, overwrite=True)
    assert pcc.load(path) == built
    # What is no surrogate is not replaced all the same.
    (tmp_path / "study.toml").write_text("format = 1")
    with pytest.raises(pcc.FileError, match="is not a surrogate"):
        built.save(tmp_path / "study.toml", overwrite=True)


def test_surrogates_have_no_hash(clutch):
    with pytest.raises(TypeError, match="unhashable"):
        hash(clutch)
