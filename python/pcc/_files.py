"""Files that are written: whole or not at all, and in the place of their like alone."""

from __future__ import annotations

import enum
import json
import os
from collections.abc import Mapping
from typing import Any

from . import _pcc
from ._errors import FileError

#: Bytes of a file that tell what it is, as for the command.
START = 1 << 16


class Kind(enum.Enum):
    """What a file is, which says what it may take the place of."""

    SURROGATE = "is not a surrogate"
    PAGE = "was not made by pcc report"

    def begins_like(self, start: bytes) -> bool:
        """Whether a file that starts so is of this kind."""
        if self is Kind.PAGE:
            return b'<meta name="generator" content="pcc report ' in start
        return _pcc.looks_like_a_surrogate(start)


def path_of(value: Any) -> str:
    """A path as text."""
    try:
        path = os.fsdecode(value)
    except TypeError:
        raise FileError(f"a {type(value).__name__} is no path of a file; give a text or a pathlib.Path") from None
    if "\0" in path:
        raise FileError(f"{path!r} is no path of a file: it holds a null character")
    return path


def refuse_to_replace(path: str, kind: Kind) -> None:
    """Refuses a file of another kind: a study or data named by mistake. An empty one may be replaced."""
    if not os.path.isfile(path):
        return
    try:
        with open(path, "rb") as file:
            start = file.read(START)
    except OSError as error:
        raise FileError(f"{path}: exists and cannot be read: {error.strerror or error}") from error
    if start and not kind.begins_like(start):
        raise FileError(f"{path}: exists and {kind.value}; name another file, or remove it first")


def keep_certificates(path: str, own: Mapping[str, Any]) -> None:
    """Refuses a surrogate with certificates that the one with this `inspect()` has not: each has cost model runs."""
    if not os.path.isfile(path):
        return
    try:
        with open(path, "rb") as file:
            data = file.read()
        there = json.loads(_pcc.Surrogate(data).inspect(path, len(data))[0])
    except (OSError, FileError):
        return  # what cannot be read has none that could be used
    kept = own["certificates"] if there["content_id"] == own["content_id"] else []
    lost = sum(certificate not in kept for certificate in there["certificates"])
    if lost:
        raise FileError(
            f"{path}: has {lost} certificate{'s' if lost > 1 else ''}, which would be lost; name another file, or pass "
            "overwrite=True"
        )


def save(path: str, data: bytes, kind: Kind) -> None:
    """Writes a file whole or not at all, in the place of its like alone."""
    refuse_to_replace(path, kind)
    _pcc.save(path, data)
