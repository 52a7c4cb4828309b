"""How World.evaluate is called with asyncio: `await` waits for its end; `async for` and `async with` watch it.

evod.watched is the counterpart for calls that wait.
"""
from __future__ import annotations

import functools
import inspect
from typing import Any, AsyncIterator, Callable, Coroutine, Generator, ParamSpec, Protocol, TypeVar

from evod.aio.awaitable import AwaitableStream, forget_of
from evod.generations import Generation

P = ParamSpec("P")


class _Evaluation(Protocol):
    def __aiter__(self) -> AsyncIterator[Generation]: ...
    async def wait(self: T) -> T: ...
    async def close(self) -> None: ...


T = TypeVar("T")
E = TypeVar("E", bound=_Evaluation)


class Watched(AwaitableStream[E]):
    """An AwaitableStream that `await` runs to its end."""

    async def _run(self) -> E:
        return await (await self._coroutine).wait()

    def __await__(self) -> Generator[Any, None, E]:
        self._awaited = True
        return self._run().__await__()


def watched(method: Callable[P, Coroutine[Any, Any, E]]) -> Callable[P, Watched[E]]:
    """Decorator: returns a Watched in place of the coroutine."""

    @functools.wraps(method)
    def watch(*args: P.args, **kwargs: P.kwargs) -> Watched[E]:
        return Watched(method(*args, **kwargs), method.__qualname__, forget_of(args))

    return watch


async def call_back(function: Callable[[Generation], object], generation: Generation) -> None:
    """Calls a function, or awaits a coroutine function."""
    result = function(generation)
    if inspect.isawaitable(result):
        await result
