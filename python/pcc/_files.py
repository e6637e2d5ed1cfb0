"""Files that are written: whole or not at all, and in the place of their like alone."""

from __future__ import annotations

import contextlib
import enum
import os
import secrets

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
        return start.startswith(b"\x89PCC\r\n\x1a\n") or b"".join(start.split()).startswith(b'{"format":{')


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


def save(path: str, data: bytes, kind: Kind) -> None:
    """Writes a file whole or not at all, in the place of its like alone."""
    refuse_to_replace(path, kind)
    beside = os.path.join(os.path.dirname(path), f".pcc-{secrets.token_hex(8)}")
    try:
        try:
            with open(beside, "xb") as file:
                file.write(data)
                file.flush()
                os.fsync(file.fileno())
            os.replace(beside, path)
        except BaseException:
            with contextlib.suppress(OSError):
                os.unlink(beside)
            raise
    except OSError as error:
        raise FileError(f"{path}: cannot be written: {error.strerror or error}") from error
