"""Exceptions. Every exception of this package derives from Error, and from the built-in exception that is closest to
it.

    Error
    ├── InvalidArgument      ValueError             an argument is not allowed; `violations` lists every such argument
    ├── NotFound             KeyError               no such world, island, organism, generation or planned change
    ├── AlreadyExists        ValueError             a world with this name exists
    ├── PermissionDenied     PermissionError        the role of this client does not allow the call
    ├── ResourceExhausted    RuntimeError           a limit of the server is reached
    ├── FailedPrecondition   RuntimeError           the call is not possible in the current state
    │   └── AnswerExpired    RuntimeError           the server lost the answer; the command may have been applied
    ├── Aborted              RuntimeError           another client changed the state first
    ├── Unimplemented        NotImplementedError    the server lacks the call: it may be older than this package
    ├── Unavailable          ConnectionError        the server is shutting down or cannot write to its disk
    ├── NoConnection         ConnectionError        no server answers, or the connection is closed
    │   └── Unauthenticated  PermissionError        the server requires a token, or does not know the given one
    ├── Timeout              TimeoutError           no answer arrived in time; the command may have been applied
    ├── DamagedData          ValueError             a run file or received bytes are damaged
    ├── FileNotFound         FileNotFoundError      there is no such file or program
    ├── MissingPackage       ImportError            a function needs an optional package that is not installed
    └── ProgramFailed        RuntimeError           the program evod did not start, or failed
"""
from __future__ import annotations

import re
import unicodedata
from typing import ClassVar, Iterable, NamedTuple, TypeVar

from evod.v1 import commands_pb2, stream_pb2

E = TypeVar("E", bound="Error")


class Violation(NamedTuple):
    """An argument whose value is not allowed."""

    field: str  #: name of the argument or parameter, as in the call: "mutation_chance", "generations", "of.island"
    allowed: str  #: the allowed values: "0 to 1"
    got: str  #: the given value: "1.5"


class Error(Exception):
    """This package, the server or the program evod refused a call. If no subclass states otherwise, nothing was
    changed.

    Examples
    --------
    >>> import evod
    >>> with evod.local() as lab:
    ...     try:
    ...         lab.world().set(mutation_chance=1.5, survivors=-1)
    ...     except ValueError as error:  # InvalidArgument is a ValueError
    ...         print(error)
    invalid parameter values
      mutation_chance: got 1.5, allowed 0 to 1
      survivors: got -1, allowed 0 to 1
    """

    #: ``evod.v1.Code``: sent by the server, or the code that the server would have sent; None if no server was
    #: involved.
    code: int | None
    #: ``evod.v1.Reason``: the documented reason for the code; 0 if the server gave none.
    reason: int = 0
    #: One sentence, without the violations.
    message: str
    #: All arguments whose values are not allowed.
    violations: tuple[Violation, ...]
    #: Values in the message, for programs, by the names that ``evod.v1.Argument`` lists: {"suggestion": "lesson"}.
    arguments: dict[str, str]

    _code: ClassVar[int | None] = None  # the code of a subclass

    def __init__(self, message: str, violations: Iterable[Violation] = (), code: int | None = None) -> None:
        # Messages contain texts of servers, programs and files. A traceback prints them to a terminal.
        self.message = "\n".join(map(printable, message.split("\n")))
        self.violations = tuple(Violation(*map(printable, violation)) for violation in violations)
        self.arguments = {}
        self.code = self._code if code is None else code
        super().__init__(self.message)

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
        if len(self.violations) == 1 and self.message.startswith(self.violations[0].field + ": "):
            return self.message  # it says what is allowed
        return self.message + "".join(f"\n  {v.field}: got {v.got}, allowed {v.allowed}" for v in self.violations)

    def __reduce__(self) -> tuple[object, ...]:
        return _restored, (type(self), self.message, self.violations, self.code, self.reason, self.arguments)


class InvalidArgument(Error, ValueError):
    """An argument or a parameter has a value that is not allowed. `violations` lists all of them."""

    _code = commands_pb2.CODE_INVALID_ARGUMENT


class NotFound(Error, KeyError):
    """There is no such world, island, organism, generation, planned change, …"""

    _code = commands_pb2.CODE_NOT_FOUND


class AlreadyExists(Error, ValueError):
    """A world with this name exists already."""

    _code = commands_pb2.CODE_ALREADY_EXISTS


class PermissionDenied(Error, PermissionError):
    """The role of this client (`Lab.role`) does not allow the call."""

    _code = commands_pb2.CODE_PERMISSION_DENIED


class ResourceExhausted(Error, RuntimeError):
    """A limit of the server is reached, or the server is busy."""

    _code = commands_pb2.CODE_RESOURCE_EXHAUSTED


class FailedPrecondition(Error, RuntimeError):
    """The call is not possible in the current state of the world or the server."""

    _code = commands_pb2.CODE_FAILED_PRECONDITION


class AnswerExpired(FailedPrecondition):
    """The connection was lost before the answer arrived, and now the server no longer has it. The command may have been
    applied, and is not applied again. Read the current state."""


class Aborted(Error, RuntimeError):
    """Another client changed the state first. Read the state again and repeat the call."""

    _code = commands_pb2.CODE_ABORTED


class Unimplemented(Error, NotImplementedError):
    """The server does not support the call. It may be older than this package."""

    _code = commands_pb2.CODE_UNIMPLEMENTED


class Unavailable(Error, ConnectionError):
    """The server is shutting down, or cannot write to its disk. Try again later."""

    _code = commands_pb2.CODE_UNAVAILABLE


class NoConnection(Error, ConnectionError):
    """No server answers, the server refuses this client, or a lost connection was not restored within the timeout."""


class Unauthenticated(NoConnection, PermissionError):
    """The server requires a token, or does not know the given one."""

    _code = commands_pb2.CODE_UNAUTHENTICATED


class Timeout(Error, TimeoutError):
    """No answer arrived within the timeout. The server may have applied the command nevertheless."""


class DamagedData(Error, ValueError):
    """Bytes from a connection, or a run file, are damaged or are not in evod's format."""

    _code = commands_pb2.CODE_DATA_LOSS


class FileNotFound(Error, FileNotFoundError):
    """There is no such file or program."""


class MissingPackage(Error, ImportError):
    """A function needs an optional package that is not installed."""


class ProgramFailed(Error, RuntimeError):
    """The program evod did not start, or failed. The message contains its own message."""


_OF_CODE: dict[int | None, type[Error]] = {
    kind._code: kind
    for kind in (InvalidArgument, NotFound, AlreadyExists, PermissionDenied, ResourceExhausted, FailedPrecondition,
                 Aborted,
                 Unimplemented, Unavailable, Unauthenticated, DamagedData)
}  # fmt: skip

#: Arguments whose names differ from the names of the protocol's fields.
_ARGUMENTS = {
    "first_generation": "first",
    "get_history.first_generation": "first",
    "get_history.last_generation": "last",
    "cancel_change.id": "change",
    "set_speed.speed.real_time_factor": "speed",
    "set_speed.speed.max": "speed",
}
_KINDS = frozenset(field.name for field in commands_pb2.Request.DESCRIPTOR.oneofs_by_name["kind"].fields)
_PATH = re.compile(rf"\bfirst_generation\b|\b({'|'.join(sorted(_KINDS))})\.[a-z_]+(\.[a-z_]+)*")


def argument_of(field: str) -> str:
    """Returns the name of the argument of a function for the path of a field in a request.

    >>> argument_of("set_parameters.mutation_chance"), argument_of("open_replay.at.generation")
    ('mutation_chance', 'generation')
    """
    if field in _ARGUMENTS:
        return _ARGUMENTS[field]
    kind, dot, rest = field.partition(".")
    if not dot or kind not in _KINDS:
        return field
    return re.sub(r"^(view|at|to)\.", "", rest)


def _with_arguments(text: str) -> str:
    """Replaces the paths of fields in a sentence of the server."""
    return _PATH.sub(lambda path: argument_of(path[0]), text)


def printable(text: str) -> str:
    """Returns the text of a peer with '?' for characters that control a terminal or change the direction of text."""
    return "".join("?" if unicodedata.category(character) in ("Cc", "Cf", "Zl", "Zp", "Cs") else character
                   for character in text)


def refusal(status: commands_pb2.Status) -> Error:
    """Returns the error for a response whose status is not OK."""
    violations = (Violation(argument_of(v.field), _with_arguments(v.allowed), v.got) for v in status.violations)
    # The lines after the sentence are those that str() makes of the violations.
    message = _with_arguments(printable(status.message.partition("\n  ")[0]))
    kind: type[Error] = _OF_CODE.get(status.code, Error)
    if status.reason == commands_pb2.REASON_REQUEST_TOO_OLD:
        kind = AnswerExpired
    error = kind(message, violations, status.code)
    error.reason = status.reason
    error.arguments = {printable(argument.name): printable(argument.value) for argument in status.arguments}
    return error


def damaged_world(event: stream_pb2.Event) -> Error:
    """Returns the error for a world that has stopped: the server's answer to every request that names the world."""
    return refusal(commands_pb2.Status(code=commands_pb2.CODE_FAILED_PRECONDITION,
                                       reason=commands_pb2.REASON_WORLD_DAMAGED,
                                       message="the world does not run: " + event.world_damaged.reason))


def copy_of(error: E) -> E:
    """Returns a new exception with the same content.

    Every caller raises its own copy. The traceback of the original refers to the stack frames of the connection task. A
    caller that clears the frames of a traceback, as unittest does, would end this task.
    """
    return _restored(type(error), error.message, error.violations, error.code, error.reason, error.arguments)


def _restored(kind: type[E], message: str, violations: Iterable[Violation], code: int | None, reason: int,
              arguments: dict[str, str]) -> E:
    error = kind(message, violations, code)
    error.reason = reason
    error.arguments = dict(arguments)
    return error


def wrong_argument(field: str, allowed: str, got: object,
                   message: str = "an argument is not allowed") -> InvalidArgument:
    """Returns the error for one invalid argument."""
    return InvalidArgument(message, [Violation(field, allowed, str(got))])
