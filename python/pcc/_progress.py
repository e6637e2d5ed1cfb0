"""How far long work is, in terminals and notebooks."""

from __future__ import annotations

import logging
import sys
import time

_log = logging.getLogger("pcc")


class Progress:
    """Shows a line on standard error, and writes remarks to the log ``pcc``."""

    def __init__(self, shows: bool) -> None:
        self._shows, self._length, self._stage, self._began = shows, 0, "", time.monotonic()

    def show(self, stage: str, done: int, total: int) -> None:
        """Shows how much of a stage is done."""
        if not self._shows:
            return
        if stage != self._stage:
            self._stage, self._began = stage, time.monotonic()
        part = f"{done:,} of {total:,}".replace(",", " ") if total else f"{done:,}".replace(",", " ")
        self._write(f"{stage}: {part}, {time.monotonic() - self._began:.0f} s")

    def remark(self, text: str) -> None:
        """Something worth a line."""
        _log.info("%s", text)

    def close(self) -> None:
        """Takes the line away."""
        if self._length:
            self._write("")
            self._length = 0

    def _write(self, line: str) -> None:
        try:
            sys.stderr.write("\r" + line.ljust(self._length) + ("\r" if not line else ""))
            sys.stderr.flush()
            self._length = len(line)
        except (OSError, ValueError, AttributeError):
            # It is closed, a pipe that nobody reads, or None: the work goes on unseen.
            self._shows, self._length = False, 0


def progress(wanted: bool | None) -> Progress:
    """A line where somebody looks: on a terminal and in a notebook, unless it is said."""
    return Progress(_somebody_looks() if wanted is None else bool(wanted))


def _somebody_looks() -> bool:
    if sys.stderr is None:
        return False
    is_notebook = "ipykernel" in sys.modules and "IPython" in sys.modules
    try:
        return is_notebook or bool(getattr(sys.stderr, "isatty", lambda: False)())
    except (OSError, ValueError):
        return False
