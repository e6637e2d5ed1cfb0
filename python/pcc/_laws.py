"""Laws of uncertain inputs. Each is a table of a study file, with the same names of parameters."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

__all__ = [
    "Law", "uniform", "log_uniform", "normal", "lognormal", "gamma", "beta", "weibull", "gumbel", "exponential",
    "triangular", "discrete", "data",
]  # fmt: skip


class Law(Mapping[str, Any]):
    """How an input is distributed: ``Law("uniform", lower=0, upper=0.5)`` is ``pcc.uniform(0, 0.5)``.

    Parameters
    ----------
    distribution : str
        Name of the law, as in a study file.
    **parameters
        Its parameters, and ``unit`` and ``label``, which are shown; those that are None are left out.
    """

    def __init__(self, distribution: str, /, **parameters: Any) -> None:
        given = {name: value for name, value in parameters.items() if value is not None}
        self._keys = {"distribution": distribution, **given}

    def __getitem__(self, key: str) -> Any:
        return self._keys[key]

    def __iter__(self):
        return iter(self._keys)

    def __len__(self) -> int:
        return len(self._keys)

    def __repr__(self) -> str:
        parameters = ", ".join(f"{name}={value!r}" for name, value in self._keys.items() if name != "distribution")
        return f"pcc.{self._keys['distribution'].replace('-', '_')}({parameters})"


def uniform(lower: float | None = None, upper: float | None = None, **further: Any) -> Law:
    """All values from `lower` to `upper` are equally likely; or ``nominal=16e6, spread="5%"``."""
    return Law("uniform", lower=lower, upper=upper, **further)


def log_uniform(lower: float, upper: float, **further: Any) -> Law:
    """All orders of magnitude from `lower` to `upper` are equally likely."""
    return Law("log-uniform", lower=lower, upper=upper, **further)


def normal(mean: float | None = None, std: float | None = None, **further: Any) -> Law:
    """Normal with mean and standard deviation, or ``cv``; ``lower`` and ``upper`` cut it off."""
    return Law("normal", mean=mean, std=std, **further)


def lognormal(mean: float | None = None, std: float | None = None, **further: Any) -> Law:
    """Lognormal by mean and standard deviation of the variable itself, or ``median`` and ``cv``."""
    return Law("lognormal", mean=mean, std=std, **further)


def gamma(mean: float | None = None, std: float | None = None, **further: Any) -> Law:
    """Gamma by mean and standard deviation, or ``shape`` and ``scale``."""
    return Law("gamma", mean=mean, std=std, **further)


def beta(alpha: float | None = None, beta: float | None = None, **further: Any) -> Law:
    """Beta between ``lower`` (0) and ``upper`` (1) by its exponents, or ``mean`` and ``std``."""
    return Law("beta", alpha=alpha, beta=beta, **further)


def weibull(shape: float, scale: float, **further: Any) -> Law:
    """Weibull."""
    return Law("weibull", shape=shape, scale=scale, **further)


def gumbel(location: float | None = None, scale: float | None = None, **further: Any) -> Law:
    """Gumbel by location and scale, or ``mean`` and ``std``."""
    return Law("gumbel", location=location, scale=scale, **further)


def exponential(mean: float, **further: Any) -> Law:
    """Exponential."""
    return Law("exponential", mean=mean, **further)


def triangular(lower: float, mode: float, upper: float, **further: Any) -> Law:
    """Triangular with its most likely value between its ends."""
    return Law("triangular", lower=lower, mode=mode, upper=upper, **further)


def discrete(values: Any, weights: Any = None, **further: Any) -> Law:
    """Some values, each as often as its weight says."""
    return Law("discrete", values=values, weights=weights, **further)


def data(file: str, column: str | None = None, **further: Any) -> Law:
    """The values of a column of a CSV file."""
    return Law("data", file=file, column=column, **further)
