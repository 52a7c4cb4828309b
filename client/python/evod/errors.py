"""Exceptions: a message for people, a code for programs, and every field with a wrong value."""
from __future__ import annotations

from typing import Iterable, NamedTuple, TypeVar

from evod.v1 import commands_pb2


E = TypeVar("E", bound="Error")


class Violation(NamedTuple):
    """A field of a request whose value is not allowed."""

    field: str  #: path in the request: "set_parameters.mutation_chance"
    allowed: str  #: "0 to 1"
    got: str  #: "1.5"


class Error(Exception):
    """A call was refused, here or by the server; nothing was changed.

    Examples
    --------
    >>> import evod
    >>> with evod.local() as lab:
    ...     try:
    ...         lab.world().set(mutation_chance=1.5, survivors=-1)
    ...     except evod.Error as error:
    ...         print(error)
    INVALID_ARGUMENT: invalid parameter values
      set_parameters.mutation_chance: got 1.5, allowed 0 to 1
      set_parameters.survivors: got -1, allowed 0 to 1
    """

    #: ``evod.v1.Code``, of the server or as the server would have answered; None if no server was involved.
    code: int | None
    #: ``evod.v1.Reason``: which documented case of the code it is; 0 if none was given.
    reason: int = 0
    #: One sentence, without code and violations.
    message: str
    #: Every field whose value is not allowed, not only the first.
    violations: tuple[Violation, ...]

    def __init__(self, message: str, code: int | None = None, violations: Iterable[Violation] = ()) -> None:
        self.message, self.code, self.violations = message, code, tuple(violations)
        super().__init__(message)

    @property
    def code_name(self) -> str:
        """The name of `code`: "INVALID_ARGUMENT", "NOT_FOUND", …; "" if there is none."""
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
    """There is no server, it refuses this client, or the connection was lost and not restored within the timeout."""


class Timeout(Error):
    """No answer came within the timeout. A command may have been applied all the same."""


class DamagedData(Error):
    """The data is not evod's, or was damaged: bytes from a connection, or a run file."""


def refusal(status: commands_pb2.Status) -> Error:
    """The error for a response whose status is not OK."""
    error = Error(status.message, status.code, (Violation(v.field, v.allowed, v.got) for v in status.violations))
    error.reason = status.reason
    return error


def copy_of(error: E) -> E:
    """A new exception with the same content.

    Every caller raises its own copy. The traceback of the original refers to the frames of the connection task, and a caller
    that clears the frames of a traceback, as unittest does, would end that task.
    """
    copy = type(error)(error.message, error.code, error.violations)
    copy.reason = error.reason
    return copy


def wrong_argument(field: str, allowed: str, got: object, message: str = "the request is wrong") -> Error:
    """The error for a wrong argument, with the code that the server would answer."""
    return Error(message, commands_pb2.CODE_INVALID_ARGUMENT, [Violation(field, allowed, str(got))])
