"""Values at points from NumPy beside the command, OpenTURNS and NumPy, in one run, on one thread each.

    python3 -m venv /tmp/python && /tmp/python/bin/pip install ./python -r benches/peers/requirements.txt
    /tmp/python/bin/python benches/python.py [ROUNDS]

`pcc eval` is the command of the same wheel, by the time that it reports: it draws its own samples and makes statistics
of them. The others take points that are in memory. `into` writes into an array that is there already, so that the
operating system has no memory to find. OpenTURNS and NumPy give components, of which no eigenvalues are made; they are
left out if OpenTURNS is not installed.
"""

from __future__ import annotations

import json
import os
import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
# Last, since a file there has the name of the module.
sys.path.append(str(ROOT / "benches" / "peers"))
os.environ["RAYON_NUM_THREADS"] = "1"
import single_thread  # noqa: E402, F401  before NumPy and OpenTURNS

import numpy as np  # noqa: E402
import pcc  # noqa: E402

POINTS = 1_000_000
#: Enough for peers, whose time per point hardly depends on their number.
POINTS_OF_PEERS = 5_000
ROUNDS = 15


def command(path: Path) -> float:
    """Seconds that `pcc eval` says it took for as many samples."""
    line = [sys.executable, "-m", "pcc", "--json", "eval", str(path), "-n", str(POINTS), "--threads", "1"]
    said = subprocess.run(line, check=True, capture_output=True, text=True).stdout
    return json.loads(said)["elapsed_seconds"]


def seconds(call: Callable[[], object]) -> float:
    """How long a call takes."""
    start = time.perf_counter()
    call()
    return time.perf_counter() - start


def peers(path: Path, points: np.ndarray) -> dict[str, Callable[[], object]]:
    """What OpenTURNS and NumPy do at these points, once it is seen that they find what pcc finds."""
    try:
        import openturns
        from numpy_peer import NumpyEvaluator
        from openturns_peer import OpenTurnsExpansion, in_blocks
        from surrogate import load
    except ImportError as error:
        print(f"without peers: {error}")
        return {}
    surrogate = load(path.with_suffix(".json"))
    by_numpy, expansion = NumpyEvaluator(surrogate), OpenTurnsExpansion(surrogate)
    metamodel, sample, blocks = expansion.metamodel(), openturns.Sample(points), in_blocks(points)
    found = pcc.load(path).max_re(points)
    same = surrogate.eigenvalues(by_numpy(points)).real.max(axis=1)
    print(f"max Re by NumPy and by pcc differ by at most {np.abs(same - found).max():.1e} 1/s")
    return {
        "NumPy, vectorised": lambda: by_numpy(points),
        "OpenTURNS, basis matrix": lambda: expansion.by_basis_matrix(blocks),
        "OpenTURNS, metamodel": lambda: metamodel(sample),
    }


def main() -> None:
    path = ROOT / "surrogates" / "clutch-r8.pcc"
    surrogate, random = pcc.load(path), np.random.default_rng(1)
    ends = np.array([(one["lower"], one["upper"]) for one in surrogate.inspect()["inputs"]])
    points = random.uniform(*ends.T, (POINTS, len(ends)))
    found = np.empty((POINTS, len(surrogate.labels)), dtype=np.complex128)
    work = {
        "s.eigenvalues": lambda: surrogate.eigenvalues(points),
        "s.eigenvalues, into": lambda: surrogate._native.eigenvalues(points, found, False),
        "s.max_re": lambda: surrogate.max_re(points),
    }
    others = peers(path, points[:POINTS_OF_PEERS])
    measured: dict[str, list[float]] = {name: [] for name in ["pcc eval", *work, *others]}
    for _ in range(int(sys.argv[1]) if len(sys.argv) > 1 else ROUNDS):
        measured["pcc eval"].append(command(path) / POINTS)
        for name, call in work.items():
            measured[name].append(seconds(call) / POINTS)
        for name, call in others.items():
            measured[name].append(seconds(call) / POINTS_OF_PEERS)
    best = {name: min(times) for name, times in measured.items()}
    print(f"{'':24}  best, 1/s  median, 1/s  of pcc eval: best  median  s.eigenvalues is faster by")
    for name, times in measured.items():
        median, of_command = np.median(times), measured["pcc eval"]
        ratios = f"{best['pcc eval'] / best[name]:18.3f}  {np.median(of_command) / median:6.3f}"
        print(
            f"{name:24} {1 / best[name]:10.3g} {1 / median:12.3g} {ratios} {best[name] / best['s.eigenvalues']:26.2f}"
        )
    load = ", ".join(f"{value:.1f}" for value in os.getloadavg())
    print(f"one thread each; load of the machine over 1, 5 and 15 minutes: {load}")


if __name__ == "__main__":
    main()
