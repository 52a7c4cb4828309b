"""scripts/run on a terminal, without compiling. EVOD and EVOCTL name the programs."""
import contextlib
import os
import pathlib
import pty
import re
import select
import shutil
import signal
import socket
import tempfile
import unittest

import waiting

ROOT = pathlib.Path(__file__).resolve().parents[2]
CTRL_C = b"\x03"
#: A server that ends with the second signal.
STUBBORN = """#!/usr/bin/env python3
import signal, socket, sys
ends = {signal.SIGINT, signal.SIGTERM}
signal.pthread_sigmask(signal.SIG_BLOCK, ends)
listener = socket.create_server(("127.0.0.1", int(sys.argv[sys.argv.index("--port") + 1])))
print("the server waits", flush=True)
for number in (1, 2):
    print("signal", number, signal.Signals(signal.sigwait(ends)).name, flush=True)
"""


def unused_port():
    with contextlib.closing(socket.create_server(("127.0.0.1", 0))) as listener:
        return str(listener.getsockname()[1])


def end_descendants():
    """Ends the programs of a test that has failed."""
    for process in waiting.descendants():
        with contextlib.suppress(OSError):
            os.kill(int(process), signal.SIGKILL)


class Terminal:
    """A program on a terminal of its own."""

    def __init__(self, command, **environment):
        self.text = ""
        self.process, self.end = pty.fork()
        if self.process == 0:
            os.execvpe(command[0], command, {**os.environ, **environment})

    def read(self):
        """Reads what the program has printed since; false after its end."""
        with contextlib.suppress(OSError):  # no process has the terminal any more
            while select.select([self.end], [], [], 0.05)[0]:
                self.text += os.read(self.end, 1 << 16).decode(errors="replace")
            return True
        return False

    def until(self, pattern):
        waiting.until(lambda: self.read() and re.search(pattern, self.text), pattern)

    def status(self):
        """Waits for the end of the program; returns its exit status."""
        waiting.until(lambda: not self.read(), "the end of the program")
        os.close(self.end)
        return os.waitstatus_to_exitcode(os.waitpid(self.process, 0)[1])


class Run(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.root = pathlib.Path(folder.name)
        (self.root / "scripts").mkdir()
        for name in ("run", "common"):
            shutil.copy(ROOT / "scripts" / name, self.root / "scripts")
        self.executable("scripts/setup", "#!/bin/sh\n")
        self.bin = self.root / "build/release/bin"
        self.bin.mkdir(parents=True)
        (self.root / "build/release/build.ninja").touch()
        (self.root / "experiments").symlink_to(ROOT / "experiments")

    def executable(self, path, text):
        (self.root / path).write_text(text)
        (self.root / path).chmod(0o755)

    def started(self):
        options = ["--port", unused_port(), "--http-port", "0", "--data", str(self.root / "data")]
        # bash prefers the function to the program cmake, so nothing is built.
        environment = {"BASH_FUNC_cmake%%": "() { :; }", "DISPLAY": "", "WAYLAND_DISPLAY": ""}
        self.addCleanup(end_descendants)
        return Terminal([str(self.root / "scripts/run"), *options], **environment)

    def test_an_interrupt_ends_the_server_with_one_signal(self):
        for name in ("evod", "evoctl"):
            (self.bin / name).symlink_to(os.environ[name.upper()])
        terminal = self.started()
        terminal.until("No display")
        os.write(terminal.end, CTRL_C)
        self.assertEqual(terminal.status(), 130, terminal.text)
        self.assertEqual(re.findall(r"SIG\w+(?::| again:)[^\r]*", terminal.text), ["SIGTERM: shutting down"],
                         terminal.text)

    def test_a_second_interrupt_reaches_the_server(self):
        (self.bin / "evoctl").symlink_to(os.environ["EVOCTL"])
        self.executable("build/release/bin/evod", STUBBORN)
        terminal = self.started()
        terminal.until("the server waits")
        for number in (1, 2):
            os.write(terminal.end, CTRL_C)
            terminal.until(f"signal {number} SIGTERM")
        self.assertEqual(terminal.status(), 130, terminal.text)


if __name__ == "__main__":
    unittest.main()
