"""What can go wrong, with the sentences of the command line."""

from __future__ import annotations

from collections.abc import Iterable


class Error(Exception):
    """Whatever can go wrong in pcc. Ctrl-C is ``KeyboardInterrupt``, as everywhere in Python."""


class StudyError(Error, ValueError):
    """A study is wrong: the sentence names the key."""


class FileError(Error, OSError):
    """A file cannot be read or written, or is none of pcc's."""

    def __str__(self) -> str:
        return str(self.args[0]) if self.args else ""


class JournalError(Error):
    """Model runs cannot be recorded, or the journal cannot be used."""


class PointsError(Error, ValueError):
    """Points are not what the inputs need, or the surrogate has no value there."""


class QuestionError(Error, ValueError):
    """A question does not fit the surrogate."""


class AnswerError(Error, ValueError):
    """A function has not answered what a model answers."""


class RunError(Error):
    """A model run failed.

    Attributes
    ----------
    inputs : dict of str to float
        The inputs of the run, in physical units; empty if they are in the sentence alone. The exception that the
        function raised, with its traceback, is ``__cause__``.
    """

    def __init__(self, sentence: str, inputs: Iterable[tuple[str, float]] = ()) -> None:
        super().__init__(sentence)
        self.inputs = dict(inputs)

    def __reduce__(self):
        return type(self), (str(self), tuple(self.inputs.items()))


class BuildError(Error):
    """A build gave no surrogate."""


class TellError(Error, ValueError):
    """Answers were not taken."""
