"""What goes wrong: one sentence, and every field that is at fault."""
from __future__ import annotations

from typing import Iterable, NamedTuple

from evod.v1 import commands_pb2


class Violation(NamedTuple):
    """What is wrong with one field of a request."""

    field: str  #: path in the request: "set_parameters.mutation_chance"
    allowed: str  #: "0 to 1"
    got: str  #: "1.5"


class Error(Exception):
    """Something was refused, here or by the server; nothing has been changed.

    >>> import evod
    >>> with evod.local() as lab:
    ...     try:
    ...         lab.world().set(mutation_chance=1.5, survivors=-1)
    ...     except evod.Error as error:
    ...         print(error)
    INVALID_ARGUMENT: some parameters cannot have these values
      set_parameters.mutation_chance: got 1.5, allowed 0 to 1
      set_parameters.survivors: got -1, allowed 0 to 1
    """

    #: The server's ``evod.v1`` Code, or what it would have said; None where no server was heard.
    code: int | None
    #: The server's ``evod.v1`` Reason: which documented situation it was; 0 where none was given.
    reason: int = 0
    #: One sentence.
    message: str
    #: Every field that is at fault, not only the first.
    violations: tuple[Violation, ...]

    def __init__(self, message: str, code: int | None = None, violations: Iterable[Violation] = ()) -> None:
        self.message, self.code, self.violations = message, code, tuple(violations)
        super().__init__(message)

    @property
    def code_name(self) -> str:
        """ "INVALID_ARGUMENT", "NOT_FOUND", …; empty where no server was heard."""
        if self.code is None:
            return ""
        try:
            return str(commands_pb2.Code.Name(self.code)).removeprefix("CODE_")
        except ValueError:
            return f"code {self.code}"

    def __str__(self) -> str:
        text = ": ".join(part for part in (self.code_name, self.message) if part)
        return text + "".join(f"\n  {v.field}: got {v.got}, allowed {v.allowed}" for v in self.violations)


class NoConnection(Error):
    """There is no server there, it does not want us, or the line broke and did not come back in time."""


class Timeout(Error):
    """No answer came in time. A command may have been done all the same."""


class DamagedData(Error):
    """What came is no evod's, or was damaged on the way."""


def refusal(status: commands_pb2.Status) -> Error:
    """The error that a status which is not OK tells of."""
    error = Error(status.message, status.code, (Violation(v.field, v.allowed, v.got) for v in status.violations))
    error.reason = status.reason
    return error


def wrong_argument(field: str, allowed: str, got: object, message: str = "the request is wrong") -> Error:
    """An error that the server would tell, too."""
    return Error(message, commands_pb2.CODE_INVALID_ARGUMENT, [Violation(field, allowed, str(got))])
