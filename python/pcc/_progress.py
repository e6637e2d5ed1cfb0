"""How far long work is, in terminals and notebooks."""

from __future__ import annotations

import logging
import sys
import time
from typing import Any

_log = logging.getLogger("pcc")

#: Seconds after which work is long enough to be shown.
LONG = 0.3


class Progress:
    """Shows a line while work goes on, and writes remarks to the log ``pcc``."""

    def __init__(self, line: _Line | None, after: float = 0.0) -> None:
        self._line, self._stage, self._began, self._from = line, "", time.monotonic(), time.monotonic() + after

    def show(self, stage: str, done: int, total: int) -> None:
        """Shows how much of a stage is done."""
        now = time.monotonic()
        if stage != self._stage:
            self._stage, self._began = stage, now
        if self._line is None or now < self._from:
            return
        part = f"{done:,} of {total:,}" if total else f"{done:,}"
        self._write(f"{stage}: {part.replace(',', ' ')}, {now - self._began:.0f} s")

    def remark(self, text: str) -> None:
        """Something worth a line."""
        _log.info("%s", text)

    def close(self) -> None:
        """Takes the line away."""
        if self._line is not None and self._line.is_there:
            self._write("")

    def _write(self, text: str) -> None:
        try:
            self._line.write(text)
        except (OSError, ValueError, AttributeError):
            # It is closed, a pipe that nobody reads, or None: the work goes on unseen.
            self._line = None


class _Line:
    """A line on standard error that is written again and again."""

    def __init__(self) -> None:
        self._length = 0

    @property
    def is_there(self) -> bool:
        return self._length > 0

    def write(self, text: str) -> None:
        sys.stderr.write("\r" + text.ljust(self._length) + ("\r" if not text else ""))
        sys.stderr.flush()
        self._length = len(text)


class _Output(_Line):
    """An output of a notebook's cell that is written again: of a stream, the notebook would keep every line."""

    def __init__(self) -> None:
        super().__init__()
        self._handle: Any = None

    def write(self, text: str) -> None:
        from IPython.display import display

        shown = {"text/plain": text, "text/html": f"<pre>{text}</pre>" if text else ""}
        if self._handle is None:
            self._handle = display(shown, raw=True, display_id=True)
        else:
            self._handle.update(shown, raw=True)
        self._length = len(text)


def progress(wanted: bool | None) -> Progress:
    """A line where somebody looks: on a terminal and in a notebook, unless it is said."""
    if wanted is None:
        return Progress(_line() if _is_notebook() or _is_terminal() else None, after=LONG)
    return Progress(_line() if wanted else None)


def _line() -> _Line:
    return _Output() if _is_notebook() else _Line()


def _is_notebook() -> bool:
    if "ipykernel" not in sys.modules or "IPython" not in sys.modules:
        return False
    shell = sys.modules["IPython"].get_ipython()
    return shell is not None and hasattr(shell, "kernel")


def _is_terminal() -> bool:
    try:
        return bool(getattr(sys.stderr, "isatty", lambda: False)())
    except (OSError, ValueError):
        return False
