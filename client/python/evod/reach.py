"""What both faces know of reaching a server."""
from __future__ import annotations

import random
import socket
import ssl
import time

from evod.endpoint import Endpoint
from evod.errors import DamagedData, NoConnection

CONNECT_TIMEOUT_S = 5.0  # for connecting, and again for the welcome
READ_BYTES = 256 << 10
_BACKOFF_MIN_S, _BACKOFF_MAX_S = 0.1, 5.0  # wait before the first new attempt; doubles each time


class Absence:
    """For how long there has been no server, and when to try again; times as of time.monotonic()."""

    def __init__(self) -> None:
        self.since: float | None = time.monotonic()  # None: there is one
        self.retry_at = 0.0
        self._backoff_s = _BACKOFF_MIN_S

    def begin(self) -> None:
        """There is no line, or not another one."""
        now = time.monotonic()
        self.since = now if self.since is None else self.since
        # Many clients of one server should not come back in the same instant.
        self.retry_at = now + self._backoff_s * random.uniform(0.5, 1.0)
        self._backoff_s = min(2 * self._backoff_s, _BACKOFF_MAX_S)

    def end(self) -> None:
        self.since, self._backoff_s = None, _BACKOFF_MIN_S


def notice_silence(connection: socket.socket) -> None:
    """Lets the machine find out that the other end is gone without a word: a cable, a suspended laptop."""
    connection.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
    connection.setsockopt(socket.SOL_SOCKET, socket.SO_KEEPALIVE, 1)
    for option, value in (("TCP_KEEPIDLE", 10), ("TCP_KEEPINTVL", 5), ("TCP_KEEPCNT", 3)):
        if hasattr(socket, option):  # a system without it still works
            connection.setsockopt(socket.IPPROTO_TCP, getattr(socket, option), value)


def reason_of(error: Exception, server: Endpoint) -> NoConnection | DamagedData:
    if isinstance(error, (NoConnection, DamagedData)):
        return error
    if isinstance(error, ConnectionRefusedError):
        return NoConnection(f"no server at {server}: start one with `evod`")
    if isinstance(error, socket.gaierror):
        return NoConnection(f"the host {server.host} is not known: check its name")
    if isinstance(error, ssl.SSLCertVerificationError):
        return NoConnection(f"no TLS with {server}: its certificate is not believed: {error.verify_message}")
    if isinstance(error, (ssl.SSLEOFError, ConnectionResetError, BrokenPipeError)):
        return closed_by(server)
    if isinstance(error, ssl.SSLError):
        return NoConnection(f"no TLS with {server}: {(error.reason or str(error)).replace('_', ' ').lower()}")
    if isinstance(error, TimeoutError):
        return NoConnection(
            f"nothing was heard from {server} within {CONNECT_TIMEOUT_S:g} s: check the address, and what lies between "
            "here and there"
        )
    return NoConnection(f"the connection with {server} failed: {getattr(error, 'strerror', None) or error}")


def closed_by(server: Endpoint) -> NoConnection:
    return NoConnection(f"the server at {server} closed the connection")


class Line:
    """What goes over a line, in the clear or within TLS; knows nothing of sockets."""

    def __init__(self, server: Endpoint, tls: ssl.SSLContext | None) -> None:
        self._tls: ssl.SSLObject | None = None
        if tls is not None:
            self._received, self._to_send = ssl.MemoryBIO(), ssl.MemoryBIO()
            self._tls = tls.wrap_bio(self._received, self._to_send, server_hostname=server.host)
        self._shaken = False
        self._held = b""  # to be said once hands have been shaken

    def outgoing(self, data: bytes) -> bytes:
        """What has to be sent so that the other end gets the data; may be more than that, or less yet."""
        if self._tls is None:
            return data
        self._held += data
        if not self._shaken:
            try:
                self._tls.do_handshake()
                self._shaken = True
            except ssl.SSLWantReadError:
                pass
        if self._shaken and self._held:
            self._tls.write(self._held)
            self._held = b""
        return self._to_send.read()

    def incoming(self, data: bytes) -> bytes:
        """What the other end says; afterwards outgoing() may have something to send. ssl.SSLError: it is not believed."""
        if self._tls is None:
            return data
        self._received.write(data)
        parts = []
        try:
            if not self._shaken:
                self._tls.do_handshake()
                self._shaken = True
            while part := self._tls.read(256 << 10):
                parts.append(part)
        except (ssl.SSLWantReadError, ssl.SSLZeroReturnError):
            pass
        return b"".join(parts)
