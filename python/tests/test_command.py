"""The command in the wheel is the library's own command line."""

from __future__ import annotations

import os
import subprocess
import sys
import sysconfig
from pathlib import Path

import pytest

import pcc

SCRIPT = Path(sysconfig.get_path("scripts")) / "pcc"


@pytest.mark.parametrize("command", [[str(SCRIPT)], [sys.executable, "-m", "pcc"]], ids=["pcc", "python -m pcc"])
def test_the_command_is_there(command, shipped):
    run = lambda *arguments: subprocess.run([*command, *arguments], capture_output=True, text=True)  # noqa: E731
    assert pcc.__version__ in run("--version").stdout
    assert run("--help").stdout.split("Usage: ")[1].startswith("pcc ")
    found = run("eval", str(shipped / "clutch-r1.pcc"), "-n", "1000")
    assert (found.returncode, found.stderr) == (0, "") or found.returncode == 0
    assert "stable" in found.stdout
    wrong = run("eval", "missing.pcc")
    assert wrong.returncode == 2 and "missing.pcc" in wrong.stderr
    assert run("inspect", str(shipped / "clutch-r1.pcc"), "--check").returncode == 0


@pytest.mark.skipif(os.name != "posix", reason="file names are text")
@pytest.mark.parametrize("name", [b"\xff.pcc", b"a\xe9b.pcc", b"\xed\xa0\x80", "\U0001d707.pcc".encode()])
def test_file_names_need_not_be_text(name, shipped, tmp_path):
    path = os.path.join(os.fsencode(tmp_path), name)
    try:
        Path(os.fsdecode(path)).write_bytes((shipped / "clutch-r1.pcc").read_bytes())
    except OSError:
        pytest.skip("the file system has no such names")
    found = subprocess.run([sys.executable, "-m", "pcc", "inspect", path], capture_output=True)
    assert found.returncode == 0 and b"Traceback" not in found.stderr


def test_there_is_no_second_program():
    assert SCRIPT.read_bytes().startswith(b"#!") and os.path.getsize(SCRIPT) < 1000


def test_the_module_is_typed():
    folder = Path(pcc.__file__).parent
    assert (folder / "py.typed").exists() and (folder / "_pcc.pyi").exists()
    assert pcc.__doc__ and all(getattr(pcc, name).__doc__ for name in pcc.__all__ if name != "__version__")


def test_examples_run():
    """Those of the module and of docs/how-to/python.md."""
    import doctest

    from pcc import _build, _study, _surrogate

    for module in (pcc, _build, _study, _surrogate):
        assert doctest.testmod(module).failed == 0
