"""The configuration file of the server. EVOD and EVOCTL name the programs, MESSAGES the folder of the message
classes."""
import pathlib
import signal
import unittest

import past_test as past
import waiting
from past_test import EVOD, c, plain


class Config(past.Case):
    def config(self, *lines):
        path = pathlib.Path(self.folder, "evod.conf")
        path.write_text("".join(line + "\n" for line in lines))
        return str(path)

    def evod(self, *words, status):
        done = waiting.run([EVOD, *words], capture_output=True, text=True)
        self.assertEqual(done.returncode, status, done.stdout + done.stderr)
        return done.stdout + done.stderr

    def test_a_server_starts_with_the_options_of_a_file(self):
        path = self.config("# a comment", f"data = {self.folder}/data", "port = 1", "seed = 7", "sessions-max = 5",
                           "web", "http-port = 0")
        self.assertEqual(self.evod("check-config", path, status=0), f"{path}: valid\n")
        server = self.server("--config", path, "--seed", "8")  # and --port 0
        self.assertIn("seed 8", server.output())
        self.assertIn("page at ", server.output())
        plain.until(pathlib.Path(self.folder, "data", "default.evod").exists, "the run file")
        self.assertEqual(self.client(server).welcome.limits.sessions_max, 5)

    def test_every_mistake_is_reported_and_nothing_starts(self):
        path = self.config("prot = 1", "port = many", "web = yes", f"data = {self.folder}/data")
        errors = [f"evod: {path}:1: prot: unknown option; did you mean port?",
                  f"evod: {path}:2: port: got many, allowed a whole number, 0 to 65535",
                  f"evod: {path}:3: web: got yes, allowed no value"]
        self.assertEqual(self.evod("check-config", path, status=2).splitlines(), errors)
        self.assertEqual(self.evod("--config", path, status=2).splitlines(), [*errors, "See evod --help"])
        self.assertFalse(pathlib.Path(self.folder, "data").exists())

    def test_what_several_lines_say_is_checked(self):
        for lines, error in (([f"tls-key = {self.folder}/none"], "--tls-key requires --tls-cert"),
                             ([f"tls-cert = {self.folder}/none", f"tls-key = {self.folder}/none"],
                              "--tls-key: cannot read"),
                             (["bind = lab"], "--bind: got"),
                             ([f"experiment = {self.folder}/none"], f"{self.folder}/none")):
            path = self.config(*lines)
            self.assertIn(f"{path}: ", self.evod("check-config", path, status=2))
            self.assertIn(error, self.evod("check-config", path, status=2))

    def test_sighup_reads_the_file_again(self):
        data = f"data = {self.folder}/data"
        path = self.config(data, "log-level = info")
        server = self.server("--config", path)

        def reload(*lines):
            self.config(*lines)
            server.process.send_signal(signal.SIGHUP)

        reload(data, "log-level = inf", "prot = 3", "sessions-max = 7")
        plain.until(lambda: f"{path}:3: prot: unknown option; did you mean port?" in server.output(), "an error")
        self.assertIn(f"the configuration stays as it is: {path}:2: log-level: got inf", server.output())
        self.assertNotIn("next start", server.output())
        reload(data, "log-level = debug", "sessions-max = 7", "keep-runs = 0")
        plain.until(lambda: "sessions-max takes effect at the next start" in server.output(), "a warning")
        self.assertIn(f"configuration reloaded from {path}", server.output())
        self.assertNotRegex(server.output(), "(log-level|keep-runs|data|port) takes effect")
        client = self.client(server)
        plain.until(lambda: "connected as admin" in server.output(), "a line of the level debug")
        client.call(reset_world=c.ResetWorld(world="default"))
        plain.until(lambda: "--keep-runs 0: deleted" in server.output(), "the ended run deleted")
        pathlib.Path(path).unlink()
        server.process.send_signal(signal.SIGHUP)
        plain.until(lambda: "No such file" in server.output(), "the missing file")
        server.end()


if __name__ == "__main__":
    unittest.main(argv=[past.sys.argv[0], *past.sys.argv[4:]])
