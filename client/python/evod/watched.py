"""How World.evaluate is called: a `for` or `with` statement over the call watches it; any other call waits for its end.

The call cannot know what happens to its result, so it reads the instruction after the call in the code of its caller:
GET_ITER for a loop, BEFORE_WITH for a block. With an unknown instruction the call waits, and a loop yields the same
generations after the last one has ended.
"""
from __future__ import annotations

import dis
import functools
import sys
import types
from typing import Callable, ParamSpec, Protocol, TypeVar

from evod.generations import Generation

P = ParamSpec("P")
T = TypeVar("T")


class _Evaluation(Protocol):
    def wait(self: T) -> T: ...


E = TypeVar("E", bound=_Evaluation)


def watched(method: Callable[P, E]) -> Callable[P, E]:
    """Decorator: waits for the end of the result, unless the caller watches it."""

    @functools.wraps(method)
    def call(*args: P.args, **kwargs: P.kwargs) -> E:
        is_watched = _is_watched(sys._getframe(1))
        evaluation = method(*args, **kwargs)
        return evaluation if is_watched else evaluation.wait()

    return call


def _is_watched(caller: types.FrameType) -> bool:
    after = (step for step in dis.get_instructions(caller.f_code) if step.offset > caller.f_lasti)
    return getattr(next(after, None), "opname", "") in ("GET_ITER", "BEFORE_WITH")


def call_back(function: Callable[[Generation], object], generation: Generation) -> None:
    """Calls a function. evod.aio.watched has the corresponding function for an event loop."""
    function(generation)
