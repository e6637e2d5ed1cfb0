"""The examples of the documents run as they stand there."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

REPOSITORY = Path(__file__).resolve().parents[2]
BLOCK = re.compile(r"(<!-- not run -->\n)?```python\n(.*?)```", re.DOTALL)


PAGES = [
    "README.md",
    "docs/how-to/python.md",
    "docs/tutorials/clutch-from-python.md",
    "docs/tutorials/brake-from-python.md",
]


@pytest.mark.parametrize("page", PAGES)
def test_examples_run(page, tmp_path, monkeypatch):
    pytest.importorskip("pandas")
    monkeypatch.chdir(tmp_path)
    blocks = [
        text for is_not_run, text in BLOCK.findall((REPOSITORY / page).read_text(encoding="utf-8")) if not is_not_run
    ]
    assert blocks
    names: dict = {}
    for text in blocks:
        exec(compile(text, page, "exec"), names)


def test_nobody_is_told_to_install_the_other_project():
    pages = [REPOSITORY / "README.md", REPOSITORY / "python" / "README.md", *(REPOSITORY / "docs").rglob("*.md")]
    for page in pages:
        assert not re.search(r"pip install pcc\b(?!-)", page.read_text(encoding="utf-8")), page
