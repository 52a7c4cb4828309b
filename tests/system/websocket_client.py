"""A WebSocket client after RFC 6455, as plain as plain_client: it can send any frame, valid or not.

WebSocket has the methods of a socket, so that plain.Client(server, over=WebSocket.connected(…)) speaks over it.
"""
import base64
import hashlib
import os
import socket
import ssl
import struct

import waiting

CONTINUATION, TEXT, BINARY, CLOSE, PING, PONG = 0, 1, 2, 8, 9, 10


def frame(payload=b"", opcode=BINARY, final=True, mask=None, length=None, reserved=0):
    """A frame of a client. length: announced in place of the true one; mask: b"" for an unmasked frame."""
    mask = os.urandom(4) if mask is None else mask
    length = len(payload) if length is None else length
    short = length if length < 126 else 126 if length < 1 << 16 else 127
    head = bytes([final << 7 | reserved << 4 | opcode, bool(mask) << 7 | short])
    head += struct.pack(">H", length) if short == 126 else struct.pack(">Q", length) if short == 127 else b""
    if mask and payload:
        key = (mask * (len(payload) // 4 + 1))[:len(payload)]
        payload = (int.from_bytes(payload, "big") ^ int.from_bytes(key, "big")).to_bytes(len(payload), "big")
    return head + mask + payload


def handshake(port, key="AQIDBAUGBwgJCgsMDQ4PEA==", **fields):
    """The request that opens a session. fields: replace header fields, None omits one; "_" stands for "-"."""
    header = {"Host": f"127.0.0.1:{port}", "Upgrade": "websocket", "Connection": "Upgrade",
              "Sec-WebSocket-Version": "13",
              "Sec-WebSocket-Key": key, "Origin": f"http://127.0.0.1:{port}",
              **{name.replace("_", "-"): value for name, value in fields.items()}}
    return ("GET /session HTTP/1.1\r\n" +
            "".join(f"{name}: {value}\r\n" for name, value in header.items() if value is not None) + "\r\n").encode()


class WebSocket:
    def __init__(self, connection):
        """connection: a connected socket on which the request of the handshake has been sent."""
        self.connection, self.received, self.content = connection, bytearray(), bytearray()
        self.controls, self.messages, self.close_code = [], 0, None  # control frames as (opcode, payload)
        while b"\r\n\r\n" not in self.received:
            assert (more := waiting.receive(connection, 65536)), bytes(self.received)
            self.received += more
        answer, _, self.received = self.received.partition(b"\r\n\r\n")
        self.answer = answer.decode()
        assert self.answer.startswith("HTTP/1.1 101 "), self.answer

    @classmethod
    def connected(cls, port, come_from="127.0.0.1", early=b"", tls=None, **fields):
        """early: bytes sent in one packet with the handshake."""
        connection = socket.create_connection(("127.0.0.1", port), source_address=(come_from, 0))
        connection.settimeout(waiting.LONGEST_S)
        if tls:
            connection = tls.wrap_socket(connection, server_hostname="localhost")
        connection.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
        connection.sendall(handshake(port, **fields) + early)
        return cls(connection)

    def fileno(self):
        return self.connection.fileno()

    def settimeout(self, seconds):
        self.connection.settimeout(seconds)

    def close(self):
        self.connection.close()

    def pending(self):
        return len(self.content) or (self.connection.pending() if isinstance(self.connection, ssl.SSLSocket) else 0)

    def sendall(self, data):
        self.connection.sendall(frame(data))

    def send_raw(self, data):
        self.connection.sendall(data)

    def recv(self, count):
        """Content of binary messages; none after a Close frame or at the end of the connection."""
        while not self.content and self.close_code is None:
            if not self.decode():
                if not (more := self.connection.recv(65536)):
                    return b""
                self.received += more
        taken, self.content = bytes(self.content[:count]), self.content[count:]
        return taken

    def decode(self):
        """Takes one frame from the received bytes. Returns whether there was a whole one."""
        if len(self.received) < 2:
            return False
        first, length, at = self.received[0], self.received[1], 2
        assert length < 128, "the server masks its frames"
        if length > 125:
            at = 4 if length == 126 else 10
            if len(self.received) < at:
                return False
            length = int.from_bytes(self.received[2:at], "big")
        if len(self.received) < at + length:
            return False
        payload, opcode = bytes(self.received[at:at + length]), first & 15
        assert first & 0xf0 == 0x80, "fragmented, or a reserved bit"
        del self.received[:at + length]
        if opcode == BINARY:
            self.content += payload
            self.messages += 1
        else:
            self.controls.append((opcode, payload))
            if opcode == CLOSE:
                self.close_code = struct.unpack(">H", payload[:2])[0]
        return True

    def at_end(self):
        """Reads to the end of the connection. Returns the code of the Close frame, or None."""
        while waiting.receive(self, 65536):
            pass
        if self.close_code is not None:
            self.connection.sendall(frame(struct.pack(">H", self.close_code), CLOSE))
            while waiting.receive(self.connection, 65536):
                pass
        return self.close_code


def accept_of(key):
    """The answer to a Sec-WebSocket-Key."""
    return base64.b64encode(hashlib.sha1((key + "258EAFA5-E914-47DA-95CA-C5AB0DC85B11").encode()).digest()).decode()
