"""scripts/run on a terminal, without compiling and without windows. EVOD and EVOCTL name the programs."""
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
#: Stands for evoview or a browser: notes its arguments and does not end.
WINDOW = """#!/bin/sh
echo "$@" >"$0.arguments"
exec sleep 1000
"""
#: What scripts/run finds in a shell that has neither xdg-open's browsers nor wslview.
NO_BROWSER = {
    "BASH_FUNC_command%%": "() { case ${*: -1} in x-www-browser | wslview) return 1 ;; esac; builtin command \"$@\"; }",
    "BASH_FUNC_xdg-settings%%": "() { :; }",
}


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
        self.executable("scripts/setup", "#!/bin/sh\necho setup: \"$@\"\n")
        self.bin = self.root / "build/release/bin"
        self.bin.mkdir(parents=True)
        (self.root / "build/release/build.ninja").touch()
        (self.root / "experiments").symlink_to(ROOT / "experiments")

    def executable(self, path, text):
        (self.root / path).write_text(text)
        (self.root / path).chmod(0o755)

    def link_programs(self):
        for name in ("evod", "evoctl"):
            (self.bin / name).symlink_to(os.environ[name.upper()])

    def started(self, *options, **environment):
        options = [*options, "--port", unused_port(), "--http-port", unused_port(), "--data", str(self.root / "data")]
        # bash prefers the function to the program cmake, so nothing is built.
        environment = {"BASH_FUNC_cmake%%": "() { echo cmake: \"$@\" >&2; }", "DISPLAY": "", "WAYLAND_DISPLAY": "",
                       "BROWSER": "", **environment}
        self.addCleanup(end_descendants)
        return Terminal([str(self.root / "scripts/run"), *options], **environment)

    def arguments(self, program):
        """Waits until a WINDOW has been opened; returns its arguments."""
        path = self.root / (program + ".arguments")
        waiting.until(lambda: path.exists() and path.read_text(), f"{program} opened")
        return path.read_text().strip()

    def interrupted(self, terminal):
        os.write(terminal.end, CTRL_C)
        self.assertEqual(terminal.status(), 130, terminal.text)
        return terminal.text

    def test_an_interrupt_ends_the_server_with_one_signal(self):
        self.link_programs()
        terminal = self.started()
        terminal.until("No display")
        self.interrupted(terminal)
        self.assertEqual(re.findall(r"SIG\w+(?::| again:)[^\r]*", terminal.text), ["SIGTERM: shutting down"],
                         terminal.text)

    def test_a_display_with_a_browser_opens_the_page(self):
        self.link_programs()
        self.executable("browser", WINDOW)
        terminal = self.started(DISPLAY=":1", BROWSER=str(self.root / "browser"))
        terminal.until("Ctrl-C ends the server")
        page = re.search(r"In a browser: (\S+)", terminal.text)[1]
        self.assertEqual(self.arguments("browser"), page)
        text = self.interrupted(terminal)  # the browser still runs
        self.assertIn("setup: build\r", text)
        self.assertNotRegex(text, "cmake: .*(evoview|VIEWER=ON)")

    def test_xdg_open_opens_the_page(self):
        self.link_programs()
        terminal = self.started(DISPLAY=":1", **{
            **NO_BROWSER, "BASH_FUNC_xdg-settings%%": "() { echo a.desktop; }", "BASH_FUNC_xdg-open%%": "() { :; }",
            "BASH_FUNC_setsid%%":
                "() { case $1 in xdg-open) echo opens: \"$2\" >/dev/tty ;; *) exec setsid \"$@\" ;; esac; }"})
        terminal.until("opens: http")
        self.interrupted(terminal)

    def test_viewer_opens_evoview_as_asked(self):
        self.link_programs()
        self.executable("build/release/bin/evoview", WINDOW)
        terminal = self.started("--viewer", DISPLAY=":1", BROWSER="true")
        self.assertRegex(self.arguments("build/release/bin/evoview"), r"^--server 127\.0\.0\.1:\d+$")
        text = self.interrupted(terminal)
        self.assertIn("In a browser: http", text)
        self.assertIn("setup: build viewer\r", text)
        self.assertRegex(text, "cmake: .*VIEWER=ON")
        self.assertRegex(text, "cmake: .*--target evoview")

    def test_a_display_without_a_browser_opens_evoview(self):
        self.link_programs()
        self.executable("build/release/bin/evoview", WINDOW)
        terminal = self.started(DISPLAY=":1", **NO_BROWSER)
        self.arguments("build/release/bin/evoview")
        self.assertIn("In a browser: http", self.interrupted(terminal))

    def test_the_viewer_needs_a_display(self):
        terminal = self.started("--viewer")
        self.assertEqual(terminal.status(), 2, terminal.text)
        self.assertIn("--viewer needs a display", terminal.text)

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
