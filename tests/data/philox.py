#!/usr/bin/env python3
"""Uniform numbers of evaluation streams by an independent Philox 4x32-10: reference data.

    python3 philox.py          writes philox.csv beside this file
    python3 philox.py check    writes nothing, compares with it

Needs the package randomgen (written with Python 3.11.7, randomgen 2.5.1), whose bit
generators are those that NumPy's came from; NumPy itself has the 64-bit variant alone.

Stream (seed, purpose 2, index) takes its words from the counters (block, 2, index low,
index high), block = 0, 1, ..., under the key (seed low, seed high); two words, low word
first, make the 64 bits of which the upper 52 are a cell of the unit interval.  randomgen
steps the counter before it generates, so it is set to one less.
"""

import sys
from pathlib import Path

from randomgen import Philox

FILE = Path(__file__).with_name("philox.csv")
PURPOSE = 2
NUMBERS = 9
SEEDS = [0, 1, 7, 2**32, 0x0123456789ABCDEF, 2**63 - 1, 2**64 - 1]
INDICES = [0, 1, 2, 63, 64, 4095, 10**9, 2**32 - 1, 2**32, 2**40 + 12345, 2**64 - 1]


def cells(seed: int, index: int) -> list[int]:
    """The first cells of a stream."""
    counter = (PURPOSE << 32) | (index << 64)
    generator = Philox(counter=(counter - 1) % 2**128, key=seed, number=4, width=32)
    words = [int(word) for word in generator.random_raw(2 * NUMBERS)]
    return [(low | high << 32) >> 12 for low, high in zip(words[::2], words[1::2])]


def table() -> str:
    """All streams, one per line: seed, index, cells."""
    rows = ((seed, index, *cells(seed, index)) for seed in SEEDS for index in INDICES)
    header = "seed,index," + ",".join(f"cell_{k}" for k in range(NUMBERS))
    return "\n".join([header, *(",".join(map(str, row)) for row in rows)]) + "\n"


if __name__ == "__main__":
    if sys.argv[1:] == ["check"]:
        sys.exit(0 if FILE.read_text() == table() else "philox.csv differs")
    FILE.write_text(table())
