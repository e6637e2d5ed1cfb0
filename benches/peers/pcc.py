"""pcc as a program: values at points, and the time it says it took."""

from __future__ import annotations

import json
import subprocess
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from surrogate import Surrogate


class PccFailed(Exception):
    """pcc could not be run, or ended with an error."""


@dataclass(frozen=True)
class Pcc:
    """The program at `path`; it writes to `folder`."""

    path: str
    folder: Path

    def version(self) -> str:
        """What `pcc --version` says."""
        return self._run("--version").strip()

    def binary_form(self, surrogate: Path) -> Path:
        """The binary form of a surrogate in JSON: what is timed is the same surrogate that the others evaluate."""
        converted = self.folder / "surrogate.pcc"
        self._run("convert", surrogate, converted)
        return converted

    def at_points(self, file: Path, surrogate: Surrogate, points: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Eigenvalues, one column per mode, and max Re of them, at physical points."""
        given, found = self.folder / "points.csv", self.folder / "values.csv"
        np.savetxt(given, points, fmt="%.17g", delimiter=",", header=",".join(surrogate.inputs), comments="")
        self._run("eval", file, "--points", given, "--out", found, "--quiet")
        names = [f"{part}_{mode}" for part in ("re", "im") for mode in surrogate.modes] + ["max_re"]
        columns = _read_columns(found, names)
        modes = len(surrogate.modes)
        return columns[:, :modes] + 1j * columns[:, modes : 2 * modes], columns[:, -1]

    def sample_seconds(self, file: Path, samples: int, threads: int | None) -> float:
        """Seconds that pcc took for samples of a surrogate; all processors if `threads` is None."""
        return self._elapsed("eval", file, "-n", samples, *_threads(threads))

    def reference_seconds(self, study: Path, samples: int) -> float:
        """Seconds that pcc took for samples of the model itself, on all processors."""
        return self._elapsed("reference", study, "-n", samples)

    def _elapsed(self, *arguments: object) -> float:
        report: dict[str, Any] = json.loads(self._run(*arguments, "--json", "--quiet"))
        return float(report["elapsed_seconds"])

    def _run(self, *arguments: object) -> str:
        command = [self.path, *map(str, arguments)]
        try:
            return subprocess.run(command, check=True, capture_output=True, text=True).stdout
        except OSError as error:
            raise PccFailed(f"{self.path} cannot be run: {error}; build it, or name it with --pcc") from error
        except subprocess.CalledProcessError as error:
            raise PccFailed(f"{' '.join(command)} ended with {error.returncode}:\n{error.stderr.strip()}") from error


def _threads(threads: int | None) -> list[object]:
    return [] if threads is None else ["--threads", threads]


def _read_columns(path: Path, names: list[str]) -> np.ndarray:
    """The named columns of a CSV file, in this order."""
    with path.open(encoding="utf-8") as file:
        header = file.readline().strip().split(",")
        missing = [name for name in names if name not in header]
        if missing:
            raise PccFailed(f"pcc wrote no column {', '.join(missing)}; it wrote {', '.join(header)}")
        return np.loadtxt(file, delimiter=",", usecols=[header.index(name) for name in names], ndmin=2)
