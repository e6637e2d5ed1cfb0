"""Values at points from NumPy beside samples of the library, in one process: points per second.

    python3 -m venv /tmp/python && /tmp/python/bin/pip install ./python
    /tmp/python/bin/python benches/python.py [ROUNDS]

`samples` is what `pcc eval` says of itself; the others include what Python does. `into` writes into an array that is
there already, so that the operating system has no memory to find.
"""

from __future__ import annotations

import sys
import time
from pathlib import Path

import numpy as np

import pcc

POINTS = 1_000_000


def main() -> None:
    surrogate = pcc.load(
        Path(__file__).resolve().parents[1] / "surrogates" / "clutch-r8.pcc"
    )
    random = np.random.default_rng(1)
    ends = [(one["lower"], one["upper"]) for one in surrogate.inspect()["inputs"]]
    points = np.column_stack(
        [random.uniform(lower, upper, POINTS) for lower, upper in ends]
    )
    found = np.empty((POINTS, len(surrogate.labels)), dtype=np.complex128)
    work = {
        "eigenvalues": lambda: surrogate.eigenvalues(points),
        "into": lambda: surrogate._native.eigenvalues(points, found, False),
        "max_re": lambda: surrogate.max_re(points),
    }
    seconds: dict[str, list[float]] = {name: [] for name in ["samples", *work]}
    for _ in range(int(sys.argv[1]) if len(sys.argv) > 1 else 30):
        seconds["samples"].append(surrogate.sample(POINTS)["elapsed_seconds"])
        for name, call in work.items():
            start = time.perf_counter()
            call()
            seconds[name].append(time.perf_counter() - start)
    print("                 best, 1/s  median, 1/s  against samples: best  median")
    of_samples = seconds["samples"]
    for name, times in seconds.items():
        best, median = POINTS / min(times), POINTS / np.median(times)
        ratios = min(of_samples) / min(times), np.median(of_samples) / np.median(times)
        print(
            f"{name:15} {best:11.3g} {median:12.3g} {ratios[0]:22.2f} {ratios[1]:7.2f}"
        )


if __name__ == "__main__":
    main()
