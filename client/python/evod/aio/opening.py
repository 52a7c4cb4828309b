"""What has to be awaited before it is there."""
from __future__ import annotations

from typing import Any, AsyncIterator, Coroutine, Generator, Generic, Protocol, TypeVar

T = TypeVar("T")


class _Closable(Protocol):
    async def close(self) -> None: ...


S = TypeVar("S", bound=_Closable)


class Opening(Generic[S]):
    """With `await`; or at the beginning of an `async with`, which closes it at its end."""

    def __init__(self, coroutine: Coroutine[Any, Any, S]) -> None:
        self._coroutine = coroutine
        self._opened: S | None = None

    def __await__(self) -> Generator[Any, None, S]:
        return self._coroutine.__await__()

    async def __aenter__(self) -> S:
        self._opened = await self._coroutine
        return self._opened

    async def __aexit__(self, *_: object) -> None:
        assert self._opened is not None
        await self._opened.close()


class OpeningStream(Opening[S], Generic[S, T]):
    """The same, or by the `async for` that goes through it."""

    async def __aiter__(self) -> AsyncIterator[T]:
        stream: Any = await self._coroutine
        try:
            async for item in stream:
                yield item
        finally:
            await stream.close()
