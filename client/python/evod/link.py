"""The synchronous connection: runs the asyncio connection on a separate thread and waits for its results.

Threads      any number of threads may use one Link. Only the connection thread accesses the Core and the plans. This
             thread ends on close(), when the Link is garbage collected, or when the program ends.
Processes    a forked process does not have the connection thread, so its calls raise NoConnection.
"""
from __future__ import annotations

import asyncio
import concurrent.futures
import ssl
import threading
import weakref
from typing import Any, Callable, Coroutine, Generic, ParamSpec, TypeVar

from evod.aio import link as aio_link
from evod.core import Core
from evod.endpoint import Endpoint
from evod.errors import NoConnection
from evod.plans import Plan

T = TypeVar("T")
P = ParamSpec("P")


def blocking_call(function: Callable[P, T], /, *args: P.args, **kwargs: P.kwargs) -> T:
    """Calls a blocking function. evod.aio.link has the corresponding function for an event loop."""
    return function(*args, **kwargs)


def call_back(function: Callable[P, object], /, *args: P.args, **kwargs: P.kwargs) -> None:
    """Calls a function. evod.aio.link has the corresponding function for an event loop."""
    function(*args, **kwargs)


class Link:
    """The synchronous version of evod.aio.link.Link. Every method blocks until it has a result."""

    def __init__(
        self, server: Endpoint, core: Core, tls: ssl.SSLContext | None, *, timeout_s: float, reconnect: bool
    ) -> None:
        self.server, self.core = server, core
        self._inner = aio_link.Link(server, core, tls, timeout_s=timeout_s, reconnect=reconnect)
        self._loop = asyncio.new_event_loop()
        self._thread = threading.Thread(target=_serve, args=(self._loop,), name="evod connection", daemon=True)
        self._thread.start()
        self._lock = threading.Lock()  # guards `end`, after which no coroutine is started
        self._end = weakref.finalize(self, _end, self._inner, self._loop, self._thread)

    @property
    def tls(self) -> bool:
        """Whether the connection uses TLS."""
        return self._inner.tls

    def perform(self, plan: Plan[T]) -> T:
        """Executes a plan. An exception in the calling thread, such as KeyboardInterrupt, cancels the plan."""
        return self._run(self._inner.perform(plan))

    def apply(self, change: Callable[[], None]) -> None:
        """Calls a function that changes the core, and sends the resulting bytes. Does nothing in a forked process."""
        if not self._inner.is_of_this_process:
            return
        try:
            self._run(self._inner.apply(change))
        except NoConnection:  # the connection thread has ended, so this thread may use the core
            self._thread.join()
            change()

    def open(self) -> None:
        """Connects for the first time. Raises NoConnection, or DamagedData if the peer is not an evod server."""
        try:
            self._run(self._inner.open())
        except BaseException:
            self.close()
            raise

    def close(self) -> None:
        """Closes the connection and ends its thread. Waiting calls in other threads raise NoConnection.

        Does nothing in a forked process.
        """
        if not self._inner.is_of_this_process:
            return  # another thread of the parent may have held the lock when this process was forked
        with self._lock:
            self._end()

    def _run(self, coroutine: Coroutine[Any, Any, T]) -> T:
        try:
            self._inner.require_own_process()
        except NoConnection:
            coroutine.close()
            raise
        call = _Call(coroutine)
        try:
            with self._lock:
                if not self._end.alive:
                    coroutine.close()
                    raise NoConnection("the connection was closed here")
                self._loop.call_soon_threadsafe(call.start)
            return call.result.result()
        except BaseException:
            if self._end.alive and not call.result.done():
                self._loop.call_soon_threadsafe(call.cancel)
            raise


class _Call(Generic[T]):
    """A coroutine that the connection thread runs for another thread. start() and cancel() run on the connection
    thread.

    The calling thread may be interrupted at any moment, even before it knows whether start() was scheduled.
    """

    def __init__(self, coroutine: Coroutine[Any, Any, T]) -> None:
        self.result: concurrent.futures.Future[T] = concurrent.futures.Future()
        self._coroutine = coroutine
        self._task: asyncio.Task[T] | None = None

    def start(self) -> None:
        self._task = asyncio.get_running_loop().create_task(self._coroutine)
        self._task.add_done_callback(self._finish)

    def cancel(self) -> None:
        if self._task is None:
            self._coroutine.close()
        else:
            self._task.cancel()

    def _finish(self, task: asyncio.Task[T]) -> None:
        if task.cancelled():
            self.result.cancel()
        elif (error := task.exception()) is not None:
            self.result.set_exception(error)
        else:
            self.result.set_result(task.result())


def _serve(loop: asyncio.AbstractEventLoop) -> None:
    try:
        loop.run_forever()
    finally:
        loop.close()


def _end(link: aio_link.Link, loop: asyncio.AbstractEventLoop, thread: threading.Thread) -> None:
    if not link.is_of_this_process:
        return

    async def end() -> None:
        await link.close()
        others = asyncio.all_tasks() - {asyncio.current_task()}
        if others:  # the callers of these tasks wait for an error
            await asyncio.wait(others)
        loop.stop()

    asyncio.run_coroutine_threadsafe(end(), loop)
    if thread is not threading.current_thread():  # the garbage collector may run on the connection thread
        thread.join()
