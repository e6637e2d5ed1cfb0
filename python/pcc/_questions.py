"""Questions about a surrogate: what samples of it say."""

from __future__ import annotations

import os
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from . import _arguments as arguments
from . import _pcc
from ._errors import QuestionError
from ._files import Kind, path_of, refuse_to_replace, save
from ._progress import progress as _progress
from ._results import Campbell, Critical, Samples, Sensitivities, Sweep

_WHERE = '{"mu": (0.1, 0.2)}'
_SWEPT = '{"mu": np.linspace(0, 0.5, 50)}'
SAMPLERS = ("monte-carlo", "sobol", "latin-hypercube")


class Questions:
    """What a surrogate answers by samples of its inputs."""

    _native: _pcc.Surrogate
    _path: str

    def sample(
        self,
        n: int = 1_000_000,
        seed: int = 1,
        *,
        where: Mapping[str, Any] | None = None,
        events: Sequence[str] = (),
        quantiles: Sequence[float] = (),
        histograms: Sequence[str] = (),
        sampler: str = "monte-carlo",
        replicates: int | None = None,
        progress: bool | None = None,
    ) -> Samples:
        """How likely the system is to be stable, by random samples of the inputs: ``pcc eval``.

        Parameters
        ----------
        n : int
            Number of samples.
        seed : int
            Seed of the samples. The same seed gives the same answer on any machine.
        where : mapping, optional
            Inputs that are confined, ``{"mu": (0.1, 0.2)}``, or fixed, ``{"mu": 0.1}``.
        events : sequence of str
            Further events that are counted, like ``"max_re<-1"``.
        quantiles : sequence of float
            Probabilities of quantiles of max Re λ and of every mode.
        histograms : sequence of str
            Quantities whose histograms are made, like ``"max_re"``.
        sampler : {"monte-carlo", "sobol", "latin-hypercube"}
            How samples are drawn.
        replicates : int, optional
            Independent randomisations that the samples of the other two are divided among.
        progress : bool, optional
            Whether progress is shown; if it is not said, in terminals and notebooks.

        Returns
        -------
        Samples
        """
        answer = self._ask(
            n, seed, where, progress, events=events, quantiles=quantiles, histograms=histograms, sampler=sampler,
            replicates=replicates,
        )  # fmt: skip
        return Samples(answer)

    def sobol(
        self,
        n: int = 1_000_000,
        seed: int = 1,
        *,
        where: Mapping[str, Any] | None = None,
        progress: bool | None = None,
    ) -> Sensitivities:
        """Which inputs decide on stability. Parameters as of :meth:`sample`."""
        return Sensitivities(self._ask(n, seed, where, progress))

    def sweep(
        self,
        ranges: Mapping[str, Any] | None = None,
        /,
        *,
        n: int = 100_000,
        seed: int = 1,
        where: Mapping[str, Any] | None = None,
        events: Sequence[str] = (),
        progress: bool | None = None,
        **inputs: Any,
    ) -> Sweep:
        """The share along one input, or as a map over two.

        Parameters
        ----------
        ranges, **inputs : mapping
            Values of inputs, equally spaced: ``mu=np.linspace(0, 0.5, 50)``.
        n : int
            Number of samples at each point.
        """
        swept = [
            arguments.sweep(name, values)
            for name, values in {**arguments.by_input(ranges, "what is swept", _SWEPT), **inputs}.items()
        ]
        if not swept:
            raise QuestionError("there is no input to sweep; write s.sweep(mu=np.linspace(0, 0.5, 50))")
        return Sweep(self._ask(n, seed, where, progress, sweeps=swept, events=events))

    def campbell(
        self,
        values: Mapping[str, Any] | None = None,
        /,
        *,
        modes: Sequence[int] | None = None,
        level: float = 0.9,
        n: int = 10_000,
        seed: int = 1,
        where: Mapping[str, Any] | None = None,
        progress: bool | None = None,
        **inputs: Any,
    ) -> Campbell:
        """Frequencies of all modes along one input, such as the speed of a rotor: a Campbell diagram with bands.

        If the unit of the input is ``"rpm"``, ``"rad/s"`` or ``"Hz"``, the picture has the line of once per revolution.

        Parameters
        ----------
        values, **inputs : mapping
            The values of the input: ``speed=np.linspace(0, 8000, 41)``.
        modes : sequence of int, optional
            Numbers of the modes; if not given, all.
        level : float
            Which part of the samples the bands hold, above 0 and below 1.
        n : int
            Number of samples at each value.
        """
        asked = {**arguments.by_input(values, "what the diagram is along", _SWEPT), **inputs}
        if len(asked) != 1:
            raise QuestionError(
                "a Campbell diagram is along one input; write s.campbell(speed=np.linspace(0, 8000, 41))"
            )
        [(name, along)] = asked.items()
        along = np.sort(arguments.values_of(name, along))
        level = arguments.number(level, "level")
        if not 0.0 < level < 1.0:
            raise QuestionError(f"level is {level!r}; give a part of the samples above 0 and below 1, like 0.9")
        where = arguments.by_input(where, "where", _WHERE)
        if name in where:
            raise QuestionError(f"where: {name} is what the diagram is along")
        known = self.inspect()["modes"] or []
        modes = known if modes is None else arguments.several(modes, "modes")
        if not modes:
            raise QuestionError("a Campbell diagram is of at least one mode")
        unknown = [mode for mode in modes if mode not in known]
        if unknown:
            raise QuestionError(
                f"there is no mode {unknown[0]!r}; the surrogate has {', '.join(map(str, known)) or 'none'}"
            )
        quantiles = [(1.0 - level) / 2.0, 0.5, (1.0 + level) / 2.0]
        found = [
            Samples(self._ask(n, seed, {**where, name: value}, progress, quantiles=quantiles))
            for value in along.tolist()
        ]
        return Campbell(name, along, level, modes, found, self._native)

    def critical(self, name: str, n: int = 1_000_000, seed: int = 1, *, progress: bool | None = None) -> Critical:
        """Where the system loses stability: the values of an input, given the other inputs.

        Parameters
        ----------
        name : str
            The input.
        n : int
            Number of samples of the other inputs.
        """
        return Critical(self._ask(n, seed, None, progress, critical=arguments.text(name, "the input")))

    def report(
        self, path: str | os.PathLike, n: int = 1_000_000, seed: int = 1, *, progress: bool | None = None
    ) -> None:
        """Put it on one page: an HTML file with its answer, pictures and tables.

        Parameters
        ----------
        path : path
            The file. A page of ``pcc report`` there is replaced.
        n, seed : int
            Number and seed of the samples.

        Raises
        ------
        FileError
            If the file cannot be written, or exists and is no page of ``pcc report``.
        """
        path = path_of(path)
        refuse_to_replace(path, Kind.PAGE)
        about = (self._path, len(self.to_bytes()))
        n, seed = arguments.count(n, "n"), arguments.count(seed, "seed", least=0)
        page = self._native.page(about, n, seed, _progress(progress))
        save(path, page.encode(), Kind.PAGE)

    def _ask(
        self,
        n: int,
        seed: int,
        where: Mapping[str, Any] | None,
        progress: bool | None,
        *,
        events: Sequence[str] = (),
        quantiles: Sequence[float] = (),
        histograms: Sequence[str] = (),
        sweeps: Sequence[tuple] = (),
        critical: str | None = None,
        sampler: str = "monte-carlo",
        replicates: int | None = None,
    ) -> tuple[str, str, list[str]]:
        if sampler not in SAMPLERS:
            raise QuestionError(f"sampler is {sampler!r}; choose one of {', '.join(map(repr, SAMPLERS))}")
        asked = {
            "samples": arguments.count(n, "n"),
            "seed": arguments.count(seed, "seed", least=0),
            "sampler": sampler,
            "replicates": replicates if replicates is None else arguments.count(replicates, "replicates", most=1000),
            "conditions": [arguments.condition(*one) for one in arguments.by_input(where, "where", _WHERE).items()],
            "sweeps": list(sweeps),
            "events": [arguments.event(text) for text in arguments.several(events, "events")],
            "histograms": [
                arguments.text(quantity, "a histogram") for quantity in arguments.several(histograms, "histograms")
            ],
            "quantiles": [
                arguments.number(level, "a quantile's probability")
                for level in arguments.several(quantiles, "quantiles")
            ],
            "critical": critical,
        }
        return self._native.ask(asked, _progress(progress))
