"""Objects that are closed after their use, and the streams of a world: generations, snapshots, events. evod.streams is
generated from this file.

Threads      call everything on the event loop on which connect() or local() ran.
"""
from __future__ import annotations

from typing import Any, TypeVar

from evod import plans
from evod.aio.link import Link
from evod.conversion import result
from evod.generations import Generation
from evod.progress import ProgressLine
from evod.results import WorldInfo
from evod.snapshots import Snapshot
from evod.tables import html_table
from evod.v1 import commands_pb2 as c, stream_pb2

T = TypeVar("T")


class Closing:
    """Base class of objects that are closed at the end of an `async with` block."""

    async def close(self) -> None:
        raise NotImplementedError

    async def __aenter__(self: T) -> T:
        return self

    async def __aexit__(self, *_: object) -> None:
        await self.close()


class _Stream(Closing):
    def __init__(self, link: Link, stream: Any) -> None:
        self._link, self._stream = link, stream

    async def close(self) -> None:
        """Ends the subscription."""
        await self._link.apply(self._stream.close)


class Run(_Stream):
    """The generations of a run, returned by `World.run`. Iterating it yields each generation when it ends.

    Each generation is returned once, even if it ends during a reconnect. The iteration ends if any client pauses the
    world. Closing a Run does not stop the world.
    """

    _stream: plans.GenerationStream

    def __init__(self, link: Link, stream: plans.GenerationStream, progress: bool) -> None:
        super().__init__(link, stream)
        self._line = ProgressLine(stream.goal) if progress else None

    def __repr__(self) -> str:
        info = self._stream.info
        end = f"to {info.run_until_generation - 1}" if info.HasField("run_until_generation") else "until it is paused"
        return f"<run of {info.name}: generations {info.generation} {end}>"

    def _repr_html_(self) -> str:
        return html_table((), (("world", self.info.name), ("began", f"generation {self.info.generation}")),
                          repr(self)[1:-1])

    @property
    def reason(self) -> str:
        """Why the run has ended: "generations", "pause", or a termination criterion of the world, such as "stagnation";
        "" while it runs."""
        return self._stream.reason

    @property
    def info(self) -> WorldInfo:
        """The state of the world when the run began."""
        info: WorldInfo = result(self._stream.info)
        return info

    def __aiter__(self) -> Run:
        return self

    async def __anext__(self) -> Generation:
        generation = await self._link.perform(self._stream.next())
        if generation is None:
            if self._line is not None:
                self._line.end()
            raise StopAsyncIteration
        if self._line is not None:
            self._line.show(generation)
        return generation

    async def wait(self) -> Generation | None:
        """Waits for the end of the run and returns the last generation; None if it was already returned before."""
        last = None
        async for last in self:
            pass
        return last


class Snapshots(_Stream):
    """A subscription to snapshots, returned by `World.snapshots`. Iterating it yields the snapshots.

    Each step of the iteration acknowledges the previous snapshot, so that the server can send another one.
    """

    _stream: plans.SnapshotStream

    def __aiter__(self) -> Snapshots:
        return self

    async def __anext__(self) -> Snapshot:
        return await self._link.perform(self._stream.next())

    @property
    def rate_hz(self) -> float:
        """The largest number of snapshots per second for each island: the requested rate, or the server's lower
        limit."""
        return self._stream.rate_hz

    async def set_view(
        self,
        region: tuple[float, float, float, float] | None = None,
        detail: str | None = None,
        bytes_per_s_max: int | None = None,
    ) -> None:
        """Changes the view. The subscription must have been created with one. The arguments are as for
        `World.snapshots`."""
        view = plans.view_message(region, detail, bytes_per_s_max) or c.View()
        await self._link.perform(self._stream.set_view(view))

    async def request_keyframe(self) -> None:
        """Requests a keyframe of each island: a snapshot encoded without a baseline. Works even if the world is
        paused."""
        await self._link.perform(self._stream.request_keyframe())


class Events(_Stream):
    """A subscription to events, returned by `World.events` and `Lab.events`. Iterating it yields the events.

    `event.text` is the event in one English sentence; it is empty in an `events_dropped` that this package itself
    creates.

    After a reconnect the first event is an `events_dropped` with the count 0, because the number of missed events is
    unknown.
    """

    _stream: plans.EventStream

    def __aiter__(self) -> Events:
        return self

    async def __anext__(self) -> stream_pb2.Event:
        return await self._link.perform(self._stream.next())

