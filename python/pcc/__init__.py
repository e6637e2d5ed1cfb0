"""How likely is a vibrating system to be stable, given what is not known about it?

A :class:`Study` names a model, its uncertain inputs and a method. :func:`build` runs the model at a few dozen points
and fits a sparse polynomial chaos expansion; the :class:`Surrogate` answers for millions of samples without the model.

>>> import numpy as np, pcc
>>> def oscillator(k, c):
...     return np.array([[0.0, 1.0], [-k, -c]])
>>> study = pcc.Study({"k": pcc.uniform(90, 110), "c": pcc.uniform(-0.1, 0.3)}, oscillator)
>>> s = pcc.build(study)
>>> s.verdict({"k": 100.0, "c": [-0.05, 0.1]}).tolist()
['flutter', 'stable']
"""

from ._build import Builder, build
from ._errors import (
    AnswerError,
    BuildError,
    Error,
    FileError,
    JournalError,
    PointsError,
    QuestionError,
    RunError,
    StudyError,
    TellError,
)
from ._laws import (
    Law,
    beta,
    data,
    discrete,
    exponential,
    gamma,
    gumbel,
    log_uniform,
    lognormal,
    normal,
    triangular,
    uniform,
    weibull,
)
from ._pcc import __version__
from ._study import Study
from ._surrogate import Surrogate, load

__all__ = [
    "AnswerError",
    "BuildError",
    "Builder",
    "Error",
    "FileError",
    "JournalError",
    "Law",
    "PointsError",
    "QuestionError",
    "RunError",
    "Study",
    "StudyError",
    "Surrogate",
    "TellError",
    "__version__",
    "beta",
    "build",
    "data",
    "discrete",
    "exponential",
    "gamma",
    "gumbel",
    "load",
    "log_uniform",
    "lognormal",
    "normal",
    "triangular",
    "uniform",
    "weibull",
]
