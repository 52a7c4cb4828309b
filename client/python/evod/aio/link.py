"""Executes plans over a connection that one asyncio task keeps open.

Threads      all methods must be called on the event loop on which open() ran.
"""
from __future__ import annotations

import asyncio
import contextlib
import inspect
import os
import socket
import ssl
import time
from typing import Callable, ParamSpec, TypeVar

from evod import plans, transport
from evod.core import Core
from evod.endpoint import Endpoint
from evod.errors import DamagedData, Error, FailedPrecondition, NoConnection, Timeout, copy_of
from evod.plans import Plan
from evod.v1 import commands_pb2 as c

T = TypeVar("T")
P = ParamSpec("P")


async def blocking_call(function: Callable[P, T], /, *args: P.args, **kwargs: P.kwargs) -> T:
    """Calls a blocking function on a separate thread, so that the event loop continues to run."""
    return await asyncio.to_thread(function, *args, **kwargs)


async def call_back(function: Callable[P, object], /, *args: P.args, **kwargs: P.kwargs) -> None:
    """Calls a function on the event loop, or awaits a coroutine function."""
    result = function(*args, **kwargs)
    if inspect.isawaitable(result):
        await result


class Link:
    """A connection to one server, and the Core that implements the protocol. Reconnects after the connection was lost.

    timeout_s    the longest time in seconds to wait for an answer, and for a server that cannot be reached.
    reconnect    whether to reconnect after the connection was lost; if not, all waiting calls fail.
    """

    def __init__(
        self, server: Endpoint, core: Core, tls: ssl.SSLContext | None, *, timeout_s: float, reconnect: bool
    ) -> None:
        self.server, self.core, self.timeout_s = server, core, timeout_s
        self._tls, self._reconnect = tls, reconnect
        self._transport = transport.Transport(server, None)
        self._writer: asyncio.StreamWriter | None = None
        self._backoff = transport.Backoff()
        self._waiters: set[asyncio.Future[None]] = set()  # completed after each change of the core
        self._connection_task: asyncio.Task[None] | None = None
        self._process = os.getpid()
        self._forgotten = ""  # a call without await, which the next call reports

    @property
    def is_of_this_process(self) -> bool:
        """Whether this process has created the connection. A forked process has neither its event loop nor its thread,
        and must not write to the socket of its parent."""
        return os.getpid() == self._process

    def require_own_process(self) -> None:
        """Raises NoConnection in a forked process."""
        if not self.is_of_this_process:
            raise NoConnection(
                "another process has created this Lab, and a forked process cannot use it: call connect() in each "
                "process"
            )

    @property
    def tls(self) -> bool:
        """Whether the connection uses TLS."""
        return self._tls is not None

    def forget(self, message: str) -> None:
        """Makes the next call raise FailedPrecondition, because a call before was not awaited and so did nothing."""
        self._forgotten = message

    def _require_awaited(self) -> None:
        message, self._forgotten = self._forgotten, ""
        if message:
            raise FailedPrecondition(message)

    # ---- plans ----------------------------------------------------------------------------------------------------

    async def perform(self, plan: Plan[T]) -> T:
        """Executes a plan and returns its result.

        Raises every exception that the plan raises. Raises Timeout if an answer does not arrive within the timeout, and
        NoConnection if the server cannot be reached within it, and in a forked process.
        """
        try:
            self.require_own_process()
            self._require_awaited()
            step = next(plan)
            while True:
                try:
                    result = await self._do(step)
                except Error as error:
                    step = plan.throw(error)
                else:
                    step = plan.send(result)
        except StopIteration as done:
            value: T = done.value
            return value
        finally:
            plan.close()
            if self.is_of_this_process:
                self._flush()

    async def apply(self, change: Callable[[], None]) -> None:
        """Calls a function that changes the core, and sends the resulting bytes. Does not wait for an answer."""
        if self.is_of_this_process:
            change()
            self._flush()

    async def _do(self, step: plans.Step) -> c.Response | None:
        if isinstance(step, plans.Until):
            await self._wait(step.condition, self.timeout_s if step.within_timeout else None)
            return None
        pending = self.core.request(step)
        try:
            await self._wait(lambda: pending.done, pending.timeout_s(self.timeout_s))
        finally:
            self.core.forget(pending)
        if pending.error is not None:
            raise pending.error
        return pending.response

    async def _wait(self, condition: Callable[[], object], timeout_s: float | None) -> None:
        deadline = None if timeout_s is None else time.monotonic() + timeout_s
        self._flush()
        while not condition():
            if self.core.failed is not None:
                raise copy_of(self.core.failed)
            now = time.monotonic()
            end = deadline
            if self._backoff.down_since is not None:
                back_by = self._backoff.down_since + self.timeout_s
                if now >= back_by or not self._reconnect and self.core.loss:
                    raise copy_of(self.core.loss or NoConnection(f"no Welcome arrived from {self.server}"))
                end = back_by if end is None else min(end, back_by)
            if deadline is not None and now >= deadline:
                if self._backoff.down_since is not None and self.core.loss:
                    raise copy_of(self.core.loss)
                raise Timeout(f"no answer within {timeout_s:g} s")
            await self._next_change(None if end is None else end - now)

    async def _next_change(self, timeout_s: float | None) -> None:
        loop = asyncio.get_running_loop()
        changed: asyncio.Future[None] = loop.create_future()
        timer = None if timeout_s is None else loop.call_later(timeout_s, _wake, changed)
        self._waiters.add(changed)
        try:
            await changed
        finally:
            self._waiters.discard(changed)
            if timer is not None:
                timer.cancel()

    def _wake_waiters(self) -> None:
        for waiter in self._waiters:
            _wake(waiter)

    # ---- the connection -------------------------------------------------------------------------------------------

    async def open(self) -> None:
        """Connects for the first time. Raises NoConnection, or DamagedData if the peer is not an evod server."""
        self._connection_task = asyncio.create_task(self._keep_connected())
        try:
            while not self.core.connected:
                if self.core.loss is not None:
                    raise copy_of(self.core.failed or self.core.loss)
                await self._next_change(None)
        except BaseException:
            await self.close()
            raise

    async def close(self) -> None:
        """Closes the connection. All waiting calls raise NoConnection. Does nothing in a forked process."""
        if not self.is_of_this_process:
            return
        if self.core.failed is None:
            self.core.close()
        self._wake_waiters()
        if self._connection_task is not None:
            self._connection_task.cancel()
            await asyncio.wait([self._connection_task])

    async def _keep_connected(self) -> None:
        """Connects, reads until the connection is lost, and reconnects, until the core has set `failed`."""
        while self.core.failed is None:
            try:
                await self._serve_connection()
            except (OSError, NoConnection, DamagedData, TimeoutError) as error:
                loss = transport.connection_error(error, self.server)
                if isinstance(error, ssl.SSLCertVerificationError):
                    self.core.failed = loss
                self._backoff.failed(self.core.retry_late)
                self.core.lost(loss)
                self._wake_waiters()
            except Exception as error:  # a bug in this package: all waiting calls fail, so that they do not hang
                self.core.failed = Error(f"the client has a fault: {error!r}")
                self.core.lost(self.core.failed)
                self._wake_waiters()
                raise
            await asyncio.sleep(max(0.0, self._backoff.retry_at - time.monotonic()))

    async def _serve_connection(self) -> None:
        async with asyncio.timeout(transport.CONNECT_TIMEOUT_S):
            reader, writer = await asyncio.open_connection(
                self.server.host, self.server.port, limit=4 * transport.READ_BYTES
            )
        try:
            connection: socket.socket = writer.get_extra_info("socket")
            transport.enable_keepalive(connection)
            self._writer, self._transport = writer, transport.Transport(self.server, self._tls)
            self.core.opened()
            self._flush()
            async with asyncio.timeout(transport.CONNECT_TIMEOUT_S):
                while not self.core.connected:
                    self._take(await reader.read(transport.READ_BYTES))
            self._backoff.reset()
            self._wake_waiters()
            while True:
                self._take(await reader.read(transport.READ_BYTES))
                self._wake_waiters()
        finally:
            self._writer = None
            writer.transport.abort()  # close() would hang if the server does not read
            with contextlib.suppress(OSError):
                await writer.wait_closed()

    def _take(self, data: bytes) -> None:
        if not data:
            raise transport.closed_by(self.server)
        plain = self._transport.incoming(data)
        if plain:
            self.core.received(plain)
        self._flush()

    def _flush(self) -> None:
        if self._writer is not None:
            to_send = self._transport.outgoing(self.core.outgoing())
            if to_send:
                self._writer.write(to_send)


def _wake(waiter: asyncio.Future[None]) -> None:
    if not waiter.done():
        waiter.set_result(None)
