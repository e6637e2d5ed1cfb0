"""Compares the evaluation of a surrogate by pcc with OpenTURNS and NumPy: first the values, then the speed."""

from __future__ import annotations

import single_thread  # noqa: F401  before NumPy and OpenTURNS

import argparse
import statistics
import sys
import tempfile
import time
import tomllib
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
import openturns as ot

from numpy_peer import NumpyEvaluator
from openturns_peer import OpenTurnsExpansion, in_blocks
from pcc import Pcc, PccFailed
from surrogate import Surrogate, UnsupportedSurrogate, load
from table import Table, grouped, machine, significant

TOLERANCE = 1e-10
LEAST_SECONDS = 1.0
REFERENCE_SAMPLES = 200_000
ROOT = Path(__file__).resolve().parents[2]

CAPTION = (
    "One thread each; best and median of {repetitions} repetitions, in turn. pcc: all that `pcc eval -n` does up to "
    "its statistics, that is random numbers, polynomials, eigenvalues from components, moments. The others: the "
    "polynomials alone, at {points} points that are in memory already. Ratio: best time over best time of pcc."
)
MODEL_CAPTION = (
    "All processors; best and median of {repetitions} repetitions, in turn; both with random numbers and statistics. "
    "Ratio: best time over best time of `pcc eval`."
)


@dataclass
class Contender:
    """Something that is timed; `measure` gives seconds per point."""

    name: str
    points: int
    measure: Callable[[], float]
    seconds: list[float] = field(default_factory=list)

    @property
    def best(self) -> float:
        """The least seconds per point: what the machine does when nothing disturbs it."""
        return min(self.seconds)


def main() -> int:
    """Returns the exit code: 0 done, 1 values disagree, 2 bad input."""
    options = arguments()
    try:
        with tempfile.TemporaryDirectory() as folder:
            return compare(options, Pcc(options.pcc, Path(folder)))
    except (UnsupportedSurrogate, PccFailed, OSError) as error:
        print(f"{options.surrogate}: {error}" if isinstance(error, UnsupportedSurrogate) else error, file=sys.stderr)
        return 2


def arguments() -> argparse.Namespace:
    """The command line."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("surrogate", type=Path, metavar="SURROGATE.json", help="JSON form of a surrogate")
    parser.add_argument("--points", type=count, default=20_000, metavar="N", help="points for the others [20000]")
    parser.add_argument("--samples", type=count, default=20_000_000, metavar="N", help="least samples for pcc [2e7]")
    parser.add_argument("--repetitions", type=count, default=5, metavar="N", help="repetitions of each timing [5]")
    parser.add_argument("--seed", type=int, default=1, help="seed of the points [1]")
    parser.add_argument("--study", type=Path, metavar="STUDY.toml", help="also time the model itself")
    parser.add_argument("--pcc", default=str(ROOT / "target/release/pcc"), metavar="PATH", help="the program")
    parser.add_argument("--markdown", type=Path, metavar="FILE", help="write the tables to FILE, too")
    return parser.parse_args()


def count(text: str) -> int:
    """A positive whole number, also as 2e7."""
    number = float(text)
    if not (number >= 1 and number.is_integer()):
        raise argparse.ArgumentTypeError(f"{text} is not a positive whole number")
    return int(number)


def compare(options: argparse.Namespace, pcc: Pcc) -> int:
    """Checks the values, times everything and prints the tables."""
    surrogate = load(options.surrogate)
    if options.study:
        require_same_study(options.study, surrogate)
    file = pcc.binary_form(options.surrogate)
    points = np.random.default_rng(options.seed).uniform(
        surrogate.lower, surrogate.upper, (options.points, len(surrogate.inputs))
    )
    about = [describe(surrogate), machine(pcc.version())]
    print("\n".join(about), end="\n\n")
    if not values_agree(surrogate, points, pcc, file):
        return 1
    tables = speed(options, surrogate, points, pcc, file)
    print("", *[table.text() + "\n" for table in tables], sep="\n", end="")
    if options.markdown:
        options.markdown.write_text(
            "\n\n".join(["  \n".join(about), *[table.markdown() for table in tables]]) + "\n", encoding="utf-8"
        )
    return 0


def require_same_study(study: Path, surrogate: Surrogate) -> None:
    """The model that is timed shall be the one the surrogate stands for; their studies have one name."""
    try:
        name = tomllib.loads(study.read_text(encoding="utf-8")).get("name")
    except tomllib.TOMLDecodeError as error:
        raise UnsupportedSurrogate(f"its study {study} is not TOML: {error}") from error
    if name != surrogate.study:
        raise UnsupportedSurrogate(f"it is of the study {surrogate.study}, not of {name} in {study}")


def describe(surrogate: Surrogate) -> str:
    """The surrogate in a line."""
    coefficients = grouped(int(np.count_nonzero(surrogate.coefficients)))
    return (
        f"{surrogate.study}: {len(surrogate.inputs)} inputs, {len(surrogate.components)} components with "
        f"{coefficients} coefficients of {len(surrogate.indices)} different terms"
    )


def values_agree(surrogate: Surrogate, points: np.ndarray, pcc: Pcc, file: Path) -> bool:
    """Prints the largest differences of values at the same points; whether all are small enough."""
    expansion = OpenTurnsExpansion(surrogate)
    by_numpy = NumpyEvaluator(surrogate)(points)
    by_metamodel = np.asarray(expansion.metamodel()(ot.Sample(points)))
    by_matrix = expansion.by_basis_matrix(in_blocks(points))
    eigenvalues, max_re = pcc.at_points(file, surrogate, points)
    largest = np.abs(eigenvalues).max()
    differences = {
        "components, OpenTURNS metamodel and NumPy": relative_difference(by_metamodel, by_numpy),
        "components, OpenTURNS basis matrix and NumPy": relative_difference(by_matrix, by_numpy),
    }
    for peer, values in (("NumPy", by_numpy), ("OpenTURNS metamodel", by_metamodel)):
        found = surrogate.eigenvalues(values)
        differences[f"eigenvalues, pcc and {peer}"] = relative_difference(eigenvalues, found)
        differences[f"max Re, pcc and {peer}"] = np.abs(max_re - found.real.max(axis=1)).max() / largest
    print(f"largest relative differences at {grouped(len(points))} points, at most {TOLERANCE:g} allowed")
    for what, difference in differences.items():
        print(f"  {what:<46}{difference:.1e}{'' if difference <= TOLERANCE else '  too large'}")
    return all(difference <= TOLERANCE for difference in differences.values())


def relative_difference(first: np.ndarray, second: np.ndarray) -> float:
    """The largest difference in any column, relative to the largest modulus in that column."""
    largest = np.abs(second).max(axis=0)
    difference = np.abs(first - second).max(axis=0)
    return float((difference / np.where(largest > 0.0, largest, 1.0)).max())


def speed(options: argparse.Namespace, surrogate: Surrogate, points: np.ndarray, pcc: Pcc, file: Path) -> list[Table]:
    """Times all contenders in turn; one table for one thread and, with a study, one for all processors."""
    alone = one_thread(surrogate, points, pcc, file, options.samples)
    together = all_processors(options.study, pcc, file, options.samples) if options.study else []
    for _ in range(options.repetitions):
        for contender in alone + together:
            contender.seconds.append(contender.measure())
    caption = CAPTION.format(repetitions=options.repetitions, points=grouped(len(points)))
    tables = [table_of(alone, caption)]
    if together:
        tables.append(table_of(together, MODEL_CAPTION.format(repetitions=options.repetitions)))
    return tables


def one_thread(surrogate: Surrogate, points: np.ndarray, pcc: Pcc, file: Path, samples: int) -> list[Contender]:
    """pcc and the others on one thread."""
    expansion, by_numpy = OpenTurnsExpansion(surrogate), NumpyEvaluator(surrogate)
    metamodel, sample, blocks = expansion.metamodel(), ot.Sample(points), in_blocks(points)
    n = len(points)
    return [
        sampled("pcc eval", lambda samples: pcc.sample_seconds(file, samples, threads=1), samples),
        Contender("NumPy, vectorised", n, lambda: seconds_per_call(lambda: by_numpy(points)) / n),
        Contender(
            "OpenTURNS, basis matrix × coefficients",
            n,
            lambda: seconds_per_call(lambda: expansion.by_basis_matrix(blocks)) / n,
        ),
        Contender("OpenTURNS, metamodel", n, lambda: seconds_per_call(lambda: metamodel(sample)) / n),
    ]


def all_processors(study: Path, pcc: Pcc, file: Path, samples: int) -> list[Contender]:
    """The surrogate and the model itself on all processors."""
    return [
        sampled("pcc eval", lambda samples: pcc.sample_seconds(file, samples, threads=None), samples),
        Contender(
            "pcc reference, the model itself",
            REFERENCE_SAMPLES,
            lambda: pcc.reference_seconds(study, REFERENCE_SAMPLES) / REFERENCE_SAMPLES,
        ),
    ]


def sampled(name: str, seconds: Callable[[int], float], samples: int) -> Contender:
    """A contender with as many samples as take long enough to be timed, found by doubling."""
    while seconds(samples) < LEAST_SECONDS:
        samples *= 2
    return Contender(name, samples, lambda: seconds(samples) / samples)


def seconds_per_call(call: Callable[[], object]) -> float:
    """Mean time of calls, repeated until they took long enough to be timed."""
    calls, start = 0, time.perf_counter()
    while (elapsed := time.perf_counter() - start) < LEAST_SECONDS or calls == 0:
        call()
        calls += 1
    return elapsed / calls


def table_of(contenders: list[Contender], caption: str) -> Table:
    """Times per point beside each other; ratios to the first contender."""
    rows = [
        [
            contender.name,
            grouped(contender.points),
            significant(1e6 * contender.best),
            significant(1e6 * statistics.median(contender.seconds)),
            grouped(int(significant(1.0 / contender.best))),
            significant(contender.best / contenders[0].best),
        ]
        for contender in contenders
    ]
    return Table(caption, ["", "points", "µs/point", "median", "points/s", "ratio"], rows)


if __name__ == "__main__":
    sys.exit(main())
