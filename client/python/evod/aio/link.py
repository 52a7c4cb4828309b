"""The asyncio face's line: carries out plans on an event loop."""
from __future__ import annotations

import asyncio
import contextlib
import socket
import ssl
import time
from typing import Callable, TypeVar

from evod import plans, reach
from evod.core import Core
from evod.endpoint import Endpoint
from evod.errors import DamagedData, Error, NoConnection, Timeout
from evod.plans import Plan
from evod.v1 import commands_pb2 as c

T = TypeVar("T")


class Link:
    """See above."""

    def __init__(
        self, server: Endpoint, core: Core, tls: ssl.SSLContext | None, *, timeout_s: float, reconnect: bool
    ) -> None:
        self.server, self.core, self.timeout_s = server, core, timeout_s
        self._tls, self._reconnect = tls, reconnect
        self._line = reach.Line(server, None)
        self._writer: asyncio.StreamWriter | None = None
        self._absence = reach.Absence()
        self._waiting: set[asyncio.Future[None]] = set()
        self._keeper: asyncio.Task[None] | None = None

    # ---- plans ----------------------------------------------------------------------------------------------------

    async def perform(self, plan: Plan[T]) -> T:
        try:
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
            self._flush()

    async def tell(self, change: Callable[[], None]) -> None:
        change()
        self._flush()

    async def _do(self, step: plans.Step) -> c.Response | None:
        if isinstance(step, plans.Until):
            await self._wait(step.holds, self.timeout_s if step.in_time else None)
            return None
        pending = self.core.request(step)
        try:
            await self._wait(lambda: pending.done, pending.patience_s(self.timeout_s))
        finally:
            self.core.forget(pending)
        if pending.error is not None:
            raise pending.error
        return pending.response

    async def _wait(self, holds: Callable[[], object], timeout_s: float | None) -> None:
        deadline = None if timeout_s is None else time.monotonic() + timeout_s
        self._flush()
        while not holds():
            if self.core.failed is not None:
                raise self.core.failed
            now = time.monotonic()
            end = deadline
            if self._absence.since is not None:
                back_by = self._absence.since + self.timeout_s
                if now >= back_by or not self._reconnect and self.core.loss:
                    raise self.core.loss or NoConnection(f"no welcome from {self.server}")
                end = back_by if end is None else min(end, back_by)
            if deadline is not None and now >= deadline:
                raise Timeout(f"no answer within {timeout_s:g} s")
            changed: asyncio.Future[None] = asyncio.get_running_loop().create_future()
            self._waiting.add(changed)
            try:
                await asyncio.wait([changed], timeout=None if end is None else end - now)
            finally:
                self._waiting.discard(changed)

    def _tell_all(self) -> None:
        for waiting in self._waiting:
            if not waiting.done():
                waiting.set_result(None)

    # ---- the line -------------------------------------------------------------------------------------------------

    async def open(self) -> None:
        self._keeper = asyncio.create_task(self._keep())
        try:
            while not self.core.connected:
                if self.core.loss is not None:
                    raise self.core.failed or self.core.loss
                changed: asyncio.Future[None] = asyncio.get_running_loop().create_future()
                self._waiting = {changed}
                await changed
        except BaseException:
            await self.close()
            raise

    async def close(self) -> None:
        if self.core.failed is None:
            self.core.close()
        self._tell_all()
        if self._keeper is not None:
            self._keeper.cancel()
            await asyncio.wait([self._keeper])

    async def _keep(self) -> None:
        """Reads, and connects again, until it is of no use any more."""
        while self.core.failed is None:
            try:
                await self._serve_a_line()
            except (OSError, NoConnection, DamagedData, TimeoutError) as error:
                reason = reach.reason_of(error, self.server)
                if isinstance(error, ssl.SSLCertVerificationError):
                    self.core.failed = reason
                self._absence.begin()
                self.core.lost(reason)
                self._tell_all()
            except Exception as error:  # nobody is to wait for ever, on account of a fault in here
                self.core.failed = Error(f"the client has a fault: {error!r}")
                self.core.lost(self.core.failed)
                self._tell_all()
                raise
            await asyncio.sleep(max(0.0, self._absence.retry_at - time.monotonic()))

    async def _serve_a_line(self) -> None:
        async with asyncio.timeout(reach.CONNECT_TIMEOUT_S):
            reader, writer = await asyncio.open_connection(self.server.host, self.server.port, limit=4 * reach.READ_BYTES)
        try:
            connection: socket.socket = writer.get_extra_info("socket")
            reach.notice_silence(connection)
            self._writer, self._line = writer, reach.Line(self.server, self._tls)
            self.core.opened()
            self._flush()
            async with asyncio.timeout(reach.CONNECT_TIMEOUT_S):
                while not self.core.connected:
                    self._take(await reader.read(reach.READ_BYTES))
            self._absence.end()
            self._tell_all()
            while True:
                self._take(await reader.read(reach.READ_BYTES))
                self._tell_all()
        finally:
            self._writer = None
            writer.close()
            with contextlib.suppress(OSError):
                await writer.wait_closed()

    def _take(self, data: bytes) -> None:
        if not data:
            raise reach.closed_by(self.server)
        said = self._line.incoming(data)
        if said:
            self.core.received(said)
        self._flush()

    def _flush(self) -> None:
        if self._writer is not None:
            to_send = self._line.outgoing(self.core.outgoing())
            if to_send:
                self._writer.write(to_send)
