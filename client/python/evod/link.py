"""The plain face's line: carries out plans over a socket.

Threads      none of its own. Any number may share a Link: whoever waits first reads for all, and hands that over when what
             it waited for is there.
"""
from __future__ import annotations

import contextlib
import selectors
import socket
import ssl
import threading
import time
from typing import Callable, Iterator, TypeVar

from evod import plans, reach
from evod.core import Core
from evod.endpoint import Endpoint
from evod.errors import DamagedData, Error, NoConnection, Timeout
from evod.plans import Plan
from evod.v1 import commands_pb2 as c

T = TypeVar("T")
#: Of few sockets, whatever their numbers.
_Selector = getattr(selectors, "PollSelector", selectors.SelectSelector)


class Link:
    """See above."""

    def __init__(
        self, server: Endpoint, core: Core, tls: ssl.SSLContext | None, *, timeout_s: float, reconnect: bool
    ) -> None:
        self.server, self.core, self.timeout_s = server, core, timeout_s
        self._tls, self._reconnect = tls, reconnect
        self._changed = threading.Condition(threading.Lock())  # guards everything here, and the core
        self._reading = False  # somebody reads for all
        self._closed = False
        self._socket: socket.socket | None = None
        self._line = reach.Line(server, None)
        self._to_send = bytearray()
        self._told, self._tell = socket.socketpair()  # wakes who reads
        for end in (self._told, self._tell):
            end.setblocking(False)
        self._absence = reach.Absence()
        self._welcome_by = 0.0

    # ---- plans ----------------------------------------------------------------------------------------------------

    def perform(self, plan: Plan[T]) -> T:
        with self._changed:
            try:
                step = next(plan)
                while True:
                    try:
                        result = self._do(step)
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

    def tell(self, change: Callable[[], None]) -> None:
        """Changes something that is not answered."""
        with self._changed:
            change()
            self._flush()

    def _do(self, step: plans.Step) -> c.Response | None:
        if isinstance(step, plans.Until):
            self._wait(step.holds, self.timeout_s if step.in_time else None)
            return None
        pending = self.core.request(step)
        try:
            self._wait(lambda: pending.done, pending.patience_s(self.timeout_s))
        finally:
            self.core.forget(pending)
        if pending.error is not None:
            raise pending.error
        return pending.response

    def _wait(self, holds: Callable[[], object], timeout_s: float | None) -> None:
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
                if self._absence.since is not None and self.core.loss:
                    raise self.core.loss
                raise Timeout(f"no answer within {timeout_s:g} s")
            remaining_s = None if end is None else max(0.0, end - now)
            if self._reading:
                self._changed.wait(remaining_s)
                continue
            self._reading = True
            try:
                self._go_on(remaining_s)
            finally:
                self._reading = False
                self._changed.notify_all()
                if self._closed:
                    self._close()

    # ---- the line -------------------------------------------------------------------------------------------------

    def open(self) -> None:
        """The first time; NoConnection: there is no server, or it does not want us."""
        with self._changed:
            try:
                while not self.core.connected:
                    self._go_on(reach.CONNECT_TIMEOUT_S)
                    if self.core.loss is not None:
                        raise self.core.failed or self.core.loss
            except BaseException:
                self._close()
                raise

    def close(self) -> None:
        with self._changed:
            self._close()
            self._changed.notify_all()

    def _close(self) -> None:
        if self.core.failed is None:
            self.core.close()
        self._closed = True
        if self._reading:  # who does that closes the rest
            self._wake()
            return
        for end in (self._socket, self._told, self._tell):
            if end is not None:
                end.close()
        self._socket = None

    @contextlib.contextmanager
    def _unlocked(self) -> Iterator[None]:
        self._changed.release()
        try:
            yield
        finally:
            self._changed.acquire()

    def _wake(self) -> None:
        with contextlib.suppress(BlockingIOError):
            self._tell.send(b"!")

    def _go_on(self, most_s: float | None) -> None:
        """Connects, waits for the time to, or sends and receives once. The lock is free meanwhile."""
        if self._socket is None:
            wait_s = self._absence.retry_at - time.monotonic()
            if wait_s > 0:
                self._sleep(wait_s if most_s is None else min(wait_s, most_s))
            else:
                self._connect()
            return
        if not self.core.connected:
            wait_s = self._welcome_by - time.monotonic()
            if wait_s <= 0:
                self._lost(reach.reason_of(TimeoutError(), self.server))
                return
            most_s = wait_s if most_s is None else min(wait_s, most_s)
        connection = self._socket
        events = selectors.EVENT_READ | (selectors.EVENT_WRITE if self._to_send else 0)
        data: bytes | None = None
        lost: Error | None = None
        with self._unlocked():
            try:
                if self._wait_for(connection, events, most_s):
                    data = connection.recv(reach.READ_BYTES)
            except BlockingIOError:
                pass
            except OSError as error:
                lost = reach.reason_of(error, self.server)
        if self._closed:
            return
        if lost is not None:
            self._lost(lost)
        elif data is not None:
            self._take(data)
        self._flush()

    def _sleep(self, wait_s: float) -> None:
        with self._unlocked():
            self._wait_for(None, 0, wait_s)

    def _wait_for(self, connection: socket.socket | None, events: int, most_s: float | None) -> bool:
        """Until it can be written to or read from, or we are woken. Whether it can be read from."""
        with _Selector() as selector:
            selector.register(self._told, selectors.EVENT_READ)
            if connection is not None:
                selector.register(connection, events)
            readable = [key.fileobj for key, ready in selector.select(most_s) if ready & selectors.EVENT_READ]
        if self._told in readable:
            self._told.recv(4096)
        return connection in readable

    def _connect(self) -> None:
        with self._unlocked():
            try:
                connection = socket.create_connection((self.server.host, self.server.port), reach.CONNECT_TIMEOUT_S)
            except OSError as error:
                failure: OSError | None = error
            else:
                failure = None
                reach.notice_silence(connection)
                connection.setblocking(False)
        if failure is not None:
            self._lost(reach.reason_of(failure, self.server))
        elif self._closed:
            connection.close()
        else:
            self._socket, self._line = connection, reach.Line(self.server, self._tls)
            self._to_send.clear()
            self._welcome_by = time.monotonic() + reach.CONNECT_TIMEOUT_S
            self.core.opened()
            self._flush()

    def _take(self, data: bytes) -> None:
        try:
            if not data:
                raise reach.closed_by(self.server)
            said = self._line.incoming(data)
            if said:
                self.core.received(said)
        except (ssl.SSLError, NoConnection, DamagedData) as error:
            if isinstance(error, ssl.SSLCertVerificationError):
                self.core.failed = reach.reason_of(error, self.server)
            self._lost(reach.reason_of(error, self.server))
        if self.core.connected:
            self._absence.end()

    def _flush(self) -> None:
        """Sends what can be sent without waiting."""
        if self._socket is None or self._closed:
            return
        try:
            self._to_send += self._line.outgoing(self.core.outgoing())
            while self._to_send:
                del self._to_send[: self._socket.send(self._to_send)]
        except BlockingIOError:
            if self._reading:
                self._wake()
        except OSError:
            self._to_send.clear()  # what the server said before it closed may still be on its way: who reads will see

    def _lost(self, error: Error) -> None:
        if self._socket is not None:
            self._socket.close()
            self._socket = None
        self._absence.begin()
        self.core.lost(error)
