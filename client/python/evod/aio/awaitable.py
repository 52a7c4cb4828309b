"""Results that work with `await`, `async with` and `async for`.

`await world.run()`, `async with world.run() as run` and `async for generation in world.run()` all work: World.run() is
a coroutine function with the decorator `opens_stream`. generate_sync.py removes the decorators from the synchronous
modules.
"""
from __future__ import annotations

import functools
import warnings
from typing import Any, AsyncIterator, Callable, Coroutine, Generator, Generic, ParamSpec, Protocol, TypeVar

T = TypeVar("T")
T_co = TypeVar("T_co", covariant=True)
P = ParamSpec("P")


class _Closable(Protocol):
    async def close(self) -> None: ...


class _Stream(_Closable, Protocol[T_co]):
    def __aiter__(self) -> AsyncIterator[T_co]: ...


S = TypeVar("S", bound=_Closable, covariant=True)
R = TypeVar("R", bound=_Stream[Any], covariant=True)


class AwaitableContext(Generic[S]):
    """A result that `await` opens. `async with` opens it, too, and closes it at the end of the block."""

    def __init__(self, coroutine: Coroutine[Any, Any, S], call: str, forget: Callable[[str], None] | None) -> None:
        self._coroutine = coroutine
        self._opened: S | None = None
        self._awaited = False
        self._call, self._forget = call, forget  # its name, and what to do if it was not awaited

    def __del__(self) -> None:
        if self._awaited:
            return
        self._coroutine.close()
        message = f"{self._call}() was called without await, so it did nothing: write `await {self._call}(…)`"
        warnings.warn(message, RuntimeWarning, stacklevel=2)
        if self._forget is not None:
            self._forget(message)

    def __await__(self) -> Generator[Any, None, S]:
        self._awaited = True
        return self._coroutine.__await__()

    async def __aenter__(self) -> S:
        self._awaited = True
        self._opened = await self._coroutine
        return self._opened

    async def __aexit__(self, *_: object) -> None:
        assert self._opened is not None
        await self._opened.close()


class AwaitableStream(AwaitableContext[R]):
    """An AwaitableContext for a stream. In addition, `async for` opens the stream, iterates over it and closes it."""

    async def __aiter__(self: AwaitableStream[_Stream[T]]) -> AsyncIterator[T]:
        self._awaited = True
        stream = await self._coroutine
        try:
            async for item in stream:
                yield item
        finally:
            await stream.close()


def forget_of(args: tuple[Any, ...]) -> Callable[[str], None] | None:
    """What a forgotten await does to the connection of the object whose method was called."""
    link = getattr(args[0], "_link", None) if args else None
    return getattr(link, "forget", None)


def opens(method: Callable[P, Coroutine[Any, Any, S]]) -> Callable[P, AwaitableContext[S]]:
    """Decorator: lets callers use the result of a coroutine function with `async with`."""

    @functools.wraps(method)
    def open_later(*args: P.args, **kwargs: P.kwargs) -> AwaitableContext[S]:
        return AwaitableContext(method(*args, **kwargs), method.__qualname__, forget_of(args))

    return open_later


def opens_stream(method: Callable[P, Coroutine[Any, Any, R]]) -> Callable[P, AwaitableStream[R]]:
    """Decorator: lets callers use the result of a coroutine function with `async with` and `async for`."""

    @functools.wraps(method)
    def open_later(*args: P.args, **kwargs: P.kwargs) -> AwaitableStream[R]:
        return AwaitableStream(method(*args, **kwargs), method.__qualname__, forget_of(args))

    return open_later
