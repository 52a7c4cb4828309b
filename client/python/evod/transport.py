"""Connections to a server: TLS, TCP keepalive, reconnect backoff, and error messages for failed connections."""
from __future__ import annotations

import random
import socket
import ssl
import time

from evod.endpoint import Endpoint
from evod.errors import DamagedData, NoConnection

CONNECT_TIMEOUT_S = 5.0  # limit for connecting, and another such limit for receiving the Welcome
READ_BYTES = 256 << 10
_BACKOFF_MIN_S, BACKOFF_MAX_S = 0.1, 5.0  # wait before reconnecting; each failed attempt doubles it


class Backoff:
    """Computes when to reconnect. Stores when the session was lost. Times are values of time.monotonic()."""

    def __init__(self) -> None:
        self.down_since: float | None = time.monotonic()  # when the session was lost; None: connected
        self.failed_at, self.retry_at = 0.0, 0.0  # the last failure, and when to connect again
        self._backoff_s = _BACKOFF_MIN_S

    def failed(self, late: bool = False) -> None:
        """Call it when the connection was lost or an attempt to connect has failed.

        late  the server is full. Another attempt soon would take the place of another client, or of another session of
              the same user.
        """
        self.failed_at = now = time.monotonic()
        self._backoff_s = BACKOFF_MAX_S if late else self._backoff_s
        self.down_since = now if self.down_since is None else self.down_since
        # Jitter, so that the clients of a server do not all reconnect at the same moment.
        self.retry_at = now + self._backoff_s * random.uniform(0.5, 1.0)
        self._backoff_s = min(2 * self._backoff_s, BACKOFF_MAX_S)

    def reset(self) -> None:
        """Call it when the server has sent its Welcome."""
        self.down_since, self._backoff_s = None, _BACKOFF_MIN_S


def enable_keepalive(connection: socket.socket) -> None:
    """Enables TCP keepalive, which detects a peer that disappeared without closing the connection: a suspended
    laptop."""
    connection.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
    connection.setsockopt(socket.SOL_SOCKET, socket.SO_KEEPALIVE, 1)
    for option, value in (("TCP_KEEPIDLE", 10), ("TCP_KEEPINTVL", 5), ("TCP_KEEPCNT", 3)):
        if hasattr(socket, option):  # systems without this option use their own default
            connection.setsockopt(socket.IPPROTO_TCP, getattr(socket, option), value)


def connection_error(error: Exception, server: Endpoint) -> NoConnection | DamagedData:
    """Converts an exception from the socket, from TLS or from the decoder to the error that the caller receives."""
    if isinstance(error, (NoConnection, DamagedData)):
        return error
    if isinstance(error, ConnectionRefusedError):
        return NoConnection(f"no server at {server}: start one with `evod`")
    if isinstance(error, socket.gaierror):
        return NoConnection(f"the host {server.host} is not known: check its name")
    if isinstance(error, ssl.SSLCertVerificationError):
        return NoConnection(f"no TLS with {server}: its certificate is not trusted: {error.verify_message}")
    if isinstance(error, (ssl.SSLEOFError, ConnectionResetError, BrokenPipeError)):
        return closed_by(server)
    if isinstance(error, ssl.SSLError):
        return NoConnection(f"no TLS with {server}: {(error.reason or str(error)).replace('_', ' ').lower()}")
    if isinstance(error, TimeoutError):
        return NoConnection(
            f"{server} did not answer within {CONNECT_TIMEOUT_S:g} s: check the address, and the network and firewalls "
            "on "
            "the way"
        )
    return NoConnection(f"the connection to {server} failed: {getattr(error, 'strerror', None) or error}")


def closed_by(server: Endpoint) -> NoConnection:
    """Returns the error for a connection that the server closed."""
    return NoConnection(f"the server at {server} closed the connection")


class Transport:
    """Encrypts and decrypts the bytes of a connection if TLS is used; otherwise returns them unchanged. Has no
    socket."""

    def __init__(self, server: Endpoint, tls: ssl.SSLContext | None) -> None:
        self._tls: ssl.SSLObject | None = None
        if tls is not None:
            self._received, self._to_send = ssl.MemoryBIO(), ssl.MemoryBIO()
            self._tls = tls.wrap_bio(self._received, self._to_send, server_hostname=server.host)
        self._handshake_done = False
        self._queued = b""  # bytes to send after the TLS handshake

    def outgoing(self, data: bytes) -> bytes:
        """Returns the bytes to write to the socket so that the server receives `data`.

        The result is empty while the TLS handshake is waiting for bytes from the server. `data` is then sent later.
        """
        if self._tls is None:
            return data
        self._queued += data
        if not self._handshake_done:
            try:
                self._tls.do_handshake()
                self._handshake_done = True
            except ssl.SSLWantReadError:
                pass
        if self._handshake_done and self._queued:
            self._tls.write(self._queued)
            self._queued = b""
        return self._to_send.read()

    def incoming(self, data: bytes) -> bytes:
        """Decrypts bytes that were read from the socket. Call outgoing() afterwards, because the handshake may need a
        reply.

        Raises ssl.SSLError if the handshake fails or a certificate is rejected.
        """
        if self._tls is None:
            return data
        self._received.write(data)
        parts = []
        try:
            if not self._handshake_done:
                self._tls.do_handshake()
                self._handshake_done = True
            while part := self._tls.read(256 << 10):
                parts.append(part)
        except (ssl.SSLWantReadError, ssl.SSLZeroReturnError):
            pass
        return b"".join(parts)
