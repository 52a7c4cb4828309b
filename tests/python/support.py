"""Real servers, a relay and a folder of files for the tests of the Python package. The environment variable EVOD names
the program."""
import json
import os
import pathlib
import re
import signal
import socket
import subprocess
import tempfile
import threading
import unittest

import evod
import waiting
from evod import transport
from waiting import until

PROGRAM = os.environ["EVOD"]
transport.CONNECT_TIMEOUT_S = 600.0  # a busy machine may be slow


class Server:
    """A server that a test can kill; other tests use evod.local()."""

    def __init__(self, *options, port=0):
        self.log = tempfile.TemporaryFile()
        self.process = subprocess.Popen([PROGRAM, "--port", str(port), *options], stdout=self.log, stderr=self.log)
        until(lambda: self.process.poll() is not None or "listening on" in self.output(), "ready")
        if self.process.poll() is not None:
            raise AssertionError("evod ended at once:\n" + self.output())
        self.port = int(re.search(r"listening on 127\.0\.0\.1:(\d+)", self.output())[1])

    def output(self):
        return os.pread(self.log.fileno(), 1 << 20, 0).decode(errors="replace")

    def kill(self):
        self.process.kill()
        waiting.ended(self.process)
        self.log.close()

    def end(self):
        self.process.send_signal(signal.SIGTERM)
        assert waiting.ended(self.process) == 0, self.output()
        self.log.close()


class Relay:
    """Forwards data between a client and a server, and can cut the connection.

    at(to_server, data): called on a thread of the relay before it forwards a piece of data; True drops the piece and
    cuts the connection.
    """

    def __init__(self, port, at=lambda to_server, data: False):
        self.port, self.at = port, at  # port of the server for the next connection
        self.connection_count = 0
        self._open = []
        self._listener = socket.create_server(("127.0.0.1", 0))
        self.address = "127.0.0.1:%d" % self._listener.getsockname()[1]
        threading.Thread(target=self._accept, daemon=True).start()

    def _accept(self):
        while True:
            try:
                client, _ = self._listener.accept()
            except OSError:
                return
            try:
                server = socket.create_connection(("127.0.0.1", self.port))
            except OSError:
                client.close()
                continue
            self.connection_count += 1
            self._open.append((client, server))
            for end, other, to_server in ((client, server, True), (server, client, False)):
                threading.Thread(target=self._carry, args=(end, other, to_server), daemon=True).start()

    def _carry(self, end, other, to_server):
        try:
            while data := end.recv(1 << 16):
                if self.at(to_server, data):
                    break
                other.sendall(data)
        except OSError:
            pass
        self.cut((end, other))

    def cut(self, connection=None):
        for ends in [connection] if connection else list(self._open):
            for end in ends:
                try:
                    end.shutdown(socket.SHUT_RDWR)
                except OSError:
                    pass
                end.close()

    def close(self):
        self._listener.shutdown(socket.SHUT_RDWR)  # wakes the accepting thread
        self._listener.close()
        self.cut()


class Temporary(unittest.TestCase):
    """A test case with a folder, which is removed at the end of each test."""

    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)

    def file(self, name, values):
        """The path of a new JSON file in the folder."""
        path = self.folder / name
        path.write_text(json.dumps(values))
        return path

    def refused(self, call, *fields):
        """Asserts that the call raises InvalidArgument about exactly these fields. Returns the exception."""
        with self.assertRaises(evod.InvalidArgument) as raised:
            call()
        self.assertEqual(sorted(violation.field for violation in raised.exception.violations), sorted(fields))
        self.assertNotIn("/tmp/evod-", str(raised.exception))
        return raised.exception
