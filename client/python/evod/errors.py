"""Exceptions. Each has a message for the user, a code for programs, and a list of all fields with invalid values."""
from __future__ import annotations

from typing import Iterable, NamedTuple, TypeVar

from evod.v1 import commands_pb2


E = TypeVar("E", bound="Error")


class Violation(NamedTuple):
    """A field of a request whose value is not allowed."""

    field: str  #: path of the field in the request: "set_parameters.mutation_chance"
    allowed: str  #: the allowed values: "0 to 1"
    got: str  #: the given value: "1.5"


class Error(Exception):
    """This package or the server refused a call. Nothing was changed.

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

    #: ``evod.v1.Code``: sent by the server, or the code that the server would have sent; None if no server was involved.
    code: int | None
    #: ``evod.v1.Reason``: the documented reason for the code; 0 if the server gave none.
    reason: int = 0
    #: One sentence, without the code and the violations.
    message: str
    #: All fields whose values are not allowed.
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
    """No server answers, the server refuses this client, or a lost connection was not restored within the timeout."""


class Timeout(Error):
    """No answer arrived within the timeout. The server may have applied the command nevertheless."""


class DamagedData(Error):
    """Bytes from a connection, or a run file, are damaged or are not in evod's format."""


def refusal(status: commands_pb2.Status) -> Error:
    """Returns the error for a response whose status is not OK."""
    error = Error(status.message, status.code, (Violation(v.field, v.allowed, v.got) for v in status.violations))
    error.reason = status.reason
    return error


def copy_of(error: E) -> E:
    """Returns a new exception with the same content.

    Every caller raises its own copy. The traceback of the original refers to the stack frames of the connection task. A
    caller that clears the frames of a traceback, as unittest does, would end this task.
    """
    copy = type(error)(error.message, error.code, error.violations)
    copy.reason = error.reason
    return copy


def wrong_argument(field: str, allowed: str, got: object, message: str = "the request is wrong") -> Error:
    """Returns the error for an invalid argument. It has the code with which the server would have answered."""
    return Error(message, commands_pb2.CODE_INVALID_ARGUMENT, [Violation(field, allowed, str(got))])
