"""Tables as aligned text and as Markdown, and the names of machine and versions above them."""

from __future__ import annotations

import math
import os
import platform
import textwrap
from dataclasses import dataclass
from importlib.metadata import version
from pathlib import Path

# Columns of text on a terminal.
WIDTH = 100


@dataclass(frozen=True)
class Table:
    """Cells below a header; the first column is text, all others are numbers."""

    caption: str
    header: list[str]
    rows: list[list[str]]

    def text(self) -> str:
        """Columns aligned by spaces, the caption below."""
        lines = [self.header, *self.rows]
        widths = [max(map(len, column)) for column in zip(*lines, strict=True)]
        return "\n".join([*(_aligned(cells, widths) for cells in lines), "", textwrap.fill(self.caption, WIDTH)])

    def markdown(self) -> str:
        """A Markdown table, the caption below."""
        rule = ["---"] + ["--:"] * (len(self.header) - 1)
        lines = ["| " + " | ".join(cells) + " |" for cells in (self.header, rule, *self.rows)]
        return "\n".join([*lines, "", self.caption])


def _aligned(cells: list[str], widths: list[int]) -> str:
    """Text to the left, numbers to the right."""
    numbers = (cell.rjust(width) for cell, width in zip(cells[1:], widths[1:], strict=True))
    return "  ".join([cells[0].ljust(widths[0]), *numbers])


def significant(number: float, digits: int = 3) -> str:
    """A positive number with so many significant digits, never with an exponent."""
    rounded = float(f"{number:.{digits - 1}e}")
    decimals = digits - 1 - math.floor(math.log10(rounded))
    return f"{rounded:.{max(decimals, 0)}f}"


def grouped(number: int) -> str:
    """A whole number with spaces between thousands."""
    return f"{number:,}".replace(",", " ")


def machine(pcc_version: str) -> str:
    """Processor and versions, in one line."""
    versions = f"Python {platform.python_version()}, NumPy {version('numpy')}, OpenTURNS {version('openturns')}"
    return f"{_processor()}, {os.cpu_count()} logical processors; {versions}; {pcc_version}"


def _processor() -> str:
    cpuinfo = Path("/proc/cpuinfo")
    lines = cpuinfo.read_text(encoding="utf-8").splitlines() if cpuinfo.exists() else []
    names = [line.split(":", 1)[1].strip() for line in lines if line.startswith("model name")]
    return names[0] if names else platform.processor() or platform.machine()
