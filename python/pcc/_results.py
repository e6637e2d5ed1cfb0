"""Answers: the JSON of the command, with names and frames."""

from __future__ import annotations

import copy
import html
import json
import math
from collections.abc import Iterator, Mapping, Sequence
from typing import Any, NamedTuple

from . import _pcc
from ._arguments import number
from ._errors import QuestionError


class Interval(NamedTuple):
    """Between what a share lies, and how surely."""

    lower: float
    upper: float
    level: float


class Share(float):
    """A share of samples, with what the finite number of them leaves open."""

    _samples: int
    _interval: Interval
    _is_random: bool

    def __new__(cls, value: float, samples: int, interval: Mapping[str, float], is_random: bool) -> Share:
        share = super().__new__(cls, value)
        share._samples, share._interval, share._is_random = samples, Interval(**interval), is_random
        return share

    def __getnewargs__(self):
        return float(self), self._samples, self._interval._asdict(), self._is_random

    def interval(self, level: float = 0.95) -> Interval:
        """Between what the share lies if the surrogate is right.

        Parameters
        ----------
        level : float
            With what probability, above 0 and below 1. Of other samplers than ``"monte-carlo"`` 0.95 alone is known.
        """
        level = number(level, "level")
        if level == self._interval.level:
            return self._interval
        if not 0.0 < level < 1.0:
            raise QuestionError(f"level is {level!r}; give a probability above 0 and below 1, like 0.95")
        if not self._is_random:
            raise QuestionError(f"samples of this sampler give intervals of the level {self._interval.level} alone")
        return Interval(*_pcc.interval(round(float(self) * self._samples), self._samples, level), level)


class Table(Sequence):
    """Rows of an answer, each a dict."""

    def __init__(self, rows: Sequence[Mapping[str, Any]]) -> None:
        self._rows = [dict(row) for row in rows]

    def __getitem__(self, number):
        return self._rows[number]

    def __len__(self) -> int:
        return len(self._rows)

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Table) and self._rows == other._rows

    def __repr__(self) -> str:
        return f"Table({self._rows!r})"

    def to_dict(self) -> list[dict[str, Any]]:
        """The rows, as the command prints them in JSON."""
        return copy.deepcopy(self._rows)

    def to_frame(self):
        """The rows as a ``pandas.DataFrame``; parts of a cell get columns of their own, such as ``interval_lower``."""
        try:
            import pandas
        except ImportError as error:
            raise ImportError("to_frame() needs pandas; install it, or use to_dict()") from error
        return pandas.DataFrame([dict(_flat(row)) for row in self._rows])


def _flat(row: Mapping[str, Any], before: str = "") -> Iterator[tuple[str, Any]]:
    for name, value in row.items():
        if isinstance(value, Mapping):
            yield from _flat(value, f"{before}{name}_")
        else:
            yield before + name, value


#: What texts of the command say of its options.
_OF_COMMAND = "more: --details"


def as_html(text: str) -> str:
    """A text of the command for notebooks, whose columns need letters of one width."""
    text = text.rstrip().removesuffix(_OF_COMMAND).rstrip()
    return f'<pre style="font-family: monospace">{html.escape(text)}</pre>'


class Answer:
    """What the library answers: the same numbers, sentences and pictures as the command's."""

    def __init__(self, answer: tuple[str, str, list[str]], in_file: bool = True) -> None:
        said, text, self._charts = answer
        self._text = text.rstrip().removesuffix(_OF_COMMAND).rstrip()
        self._data: dict[str, Any] = json.loads(said)
        if not in_file:
            self._data.pop("file", None)

    def to_dict(self) -> dict[str, Any]:
        """What the command prints with ``--json``."""
        return copy.deepcopy(self._data)

    @property
    def verdict(self) -> str:
        """The answer in a sentence."""
        return self._data["verdict"]

    @property
    def warnings(self) -> list[str]:
        """What to know before trusting it."""
        return list(self._data.get("warnings", []))

    def __getitem__(self, key: str) -> Any:
        return copy.deepcopy(self._data[key])

    def __repr__(self) -> str:
        return self._text

    def _repr_html_(self) -> str:
        return as_html(repr(self)) + "".join(self._charts)


class _Picture:
    """Answers of which the first chart says all."""

    _charts: list[str]

    @property
    def svg(self) -> str | None:
        """The picture, as the text of an SVG file; None if there is none."""
        return self._charts[0] if self._charts else None

    def _repr_svg_(self) -> str | None:
        return self.svg


class Samples(Answer):
    """What samples of a surrogate say."""

    def _share(self, name: str) -> Share:
        data, is_random = self._data, self._data["sampler"] == "monte-carlo"
        return Share(data[f"{name}_proportion"], data["samples"], data["intervals"][name], is_random)

    @property
    def stable(self) -> Share:
        """Share of stable samples."""
        return self._share("stable")

    @property
    def marginal(self) -> Share:
        """Share of samples that are neither stable nor unstable as far as can be told."""
        return self._share("marginal")

    @property
    def unstable(self) -> Share:
        """Share of unstable samples."""
        return self._share("unstable")

    @property
    def flutter(self) -> Share:
        """Share of samples that are unstable and oscillate."""
        return self._share("flutter")

    @property
    def divergence(self) -> Share:
        """Share of samples that are unstable and do not oscillate."""
        return self._share("divergence")

    @property
    def samples(self) -> int:
        """Number of samples."""
        return self._data["samples"]

    @property
    def modes(self) -> Table:
        """What engineers read, per mode."""
        return Table(self._data["modes"])

    @property
    def components(self) -> Table:
        """Every component."""
        return Table([{k: v for k, v in row.items() if k != "sobol"} for row in self._data["components"]])

    @property
    def events(self) -> Table:
        """Other events that were counted."""
        return Table(self._data["events"])

    @property
    def quantiles(self) -> Table:
        """Quantiles that were asked for."""
        return Table(self._data["quantiles"])


class Sensitivities(_Picture, Answer):
    """Which inputs decide on stability: Sobol' indices, or Shapley effects where inputs depend on each other."""

    @property
    def inputs(self) -> Table:
        """What is known of each input."""
        found = self._data.get("sensitivity") or self._data.get("shapley") or {"inputs": []}
        return Table(found["inputs"])

    def to_frame(self):
        """A row for each input, as a ``pandas.DataFrame``."""
        return self.inputs.to_frame()


class Sweep(_Picture, Answer):
    """The share along inputs."""

    @property
    def points(self) -> Table:
        """A row for each point, the last input varying fastest."""
        names = [sweep["input"] for sweep in self._data["sweeps"]]
        points = copy.deepcopy(self._data["points"])
        return Table([dict(zip(names, point.pop("values"))) | point for point in points])

    def to_frame(self):
        """A row for each point, as a ``pandas.DataFrame``."""
        return self.points.to_frame()


_BAND = ("lower_hz", "median_hz", "upper_hz")


class Campbell(_Picture):
    """Frequencies of modes along an input, with the bands that the other inputs leave open."""

    def __init__(
        self,
        name: str,
        values: Sequence[float],
        level: float,
        modes: Sequence[int],
        found: Sequence[Samples],
        surrogate: _pcc.Surrogate,
    ) -> None:
        self._name, self._level, self._rows = name, level, []
        points: dict[int, list] = {mode: [] for mode in modes}
        for value, samples in zip(values, found):
            quantiles = {row["quantity"]: [one["value"] for one in row["quantiles"]] for row in samples["quantiles"]}
            for mode in [mode for mode in samples["modes"] if mode["mode"] in points]:
                # Where a mode never oscillates, it has no frequency.
                frequency = quantiles.get(f"frequency_{mode['mode']}", [None] * 3)
                row = {name: float(value), "mode": mode["mode"], **dict(zip(_BAND, frequency))}
                self._rows.append(row | {"unstable_share": mode["unstable_share"]})
                drawn = [math.nan if hertz is None else hertz for hertz in frequency]
                points[mode["mode"]].append((drawn, mode["unstable_share"]))
        self._charts = [surrogate.campbell(name, [float(value) for value in values], list(points.items()))]

    @property
    def points(self) -> Table:
        """A row for each value of the input and each mode."""
        return Table(self._rows)

    def to_frame(self):
        """A row for each value of the input and each mode, as a ``pandas.DataFrame``."""
        return self.points.to_frame()

    def __repr__(self) -> str:
        modes = len({row["mode"] for row in self._rows})
        return f"<Campbell diagram of {modes} modes over {self._name}, bands of {100 * self._level:g} %>"


class Critical(Answer):
    """Where the system loses stability along an input."""

    @property
    def crossings(self) -> Table:
        """The values of the input where stability changes, with their quantiles, in their order."""
        return Table(self._data["critical"]["crossings"])

    def to_frame(self):
        """A row for each crossing, as a ``pandas.DataFrame``."""
        return self.crossings.to_frame()


class Comparison(Answer):
    """Surrogate and model on the same points."""

    @property
    def misclassified(self) -> float:
        """Share of points on whose stability they disagree."""
        return self._data["misclassified_percent"] / 100.0

    @property
    def components(self) -> Table:
        """Errors of every component."""
        return Table(self._data["components"])


class Certificate(Answer):
    """Bounds of the true share of stable systems."""

    @property
    def lower(self) -> float:
        """The lower end."""
        return self._data["certificates"][-1]["lower"]

    @property
    def upper(self) -> float:
        """The upper end."""
        return self._data["certificates"][-1]["upper"]

    @property
    def level(self) -> float:
        """With what probability both hold."""
        return self._data["certificates"][-1]["level"]
