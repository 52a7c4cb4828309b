"""Foreign files: pipes, devices and endless files in place of files, and run files with added SQL.
evod refuses them at once and names them. EVOD names the program.
"""
import os
import pathlib
import shutil
import sqlite3
import subprocess
import tempfile
import unittest

import waiting

EVOD = os.environ["EVOD"]
ENDLESS = "WITH RECURSIVE n(i) AS (SELECT 1 UNION ALL SELECT i + 1 FROM n)"


class ForeignFiles(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)
        self.pipe = self.folder / "pipe"
        os.mkfifo(self.pipe)

    def assert_refused(self, *arguments, words):
        done = waiting.run([EVOD, *map(str, arguments)], capture_output=True, text=True, stdin=subprocess.DEVNULL)
        self.assertEqual(done.returncode, 1, arguments)
        self.assertIn(words, done.stderr)
        self.assertLess(len(done.stderr), 1000)

    def serve(self, *options):
        return ["--port", "0", "--data", self.folder / "data", *options]

    def test_pipes_and_devices_are_refused_everywhere(self):
        out = ["--out", self.folder / "out"]
        for path, kind in (self.pipe, "a pipe"), ("/dev/zero", "a device"), (self.folder, "a folder"):
            for arguments, file in (
                    (["run", path], "an experiment file"),
                    (["run", "--population", path], "a population file"),
                    (["check", path], "an experiment file"),
                    (["compare", path, "--controls"], "an experiment file"),
                    (["sweep", path, *out], "a sweep file"),
                    (["verify", path], "a run file"),
                    (["export", path, "--what", "events"], "a run file"),
                    (["fork", path, "--name", "w", "--data", self.folder / "data"], "a run file"),
                    (["replay", path, "--port", "0"], "a run file"),
                    (self.serve("--experiment", path), "an experiment file"),
                    (self.serve("--population", path), "a population file")):
                with self.subTest(arguments):
                    self.assert_refused(*arguments, words=f"{path}: this is {kind}, not {file}")

    def assert_damaged(self, words):
        """Starts a server and ends it: it does not run the world of the file, and says why."""
        server = subprocess.Popen([EVOD, *map(str, self.serve())], stderr=subprocess.PIPE, text=True)
        self.addCleanup(server.stderr.close)
        log = []
        for line in server.stderr:
            log.append(line)
            if "listening on" in line:
                break
        server.terminate()
        self.assertEqual(waiting.ended(server), 0)
        self.assertIn(words, "".join(log))

    def test_a_pipe_in_the_data_folder_is_refused(self):
        data = self.folder / "data"
        data.mkdir()
        os.mkfifo(data / "tokens", 0o600)
        self.assert_refused(*self.serve(), words=f"{data / 'tokens'}: this is a pipe, not a token file")
        os.remove(data / "tokens")
        os.mkfifo(data / "w.evod", 0o600)
        self.assert_damaged(f'world "w" does not run: {data / "w.evod"}: this is a pipe, not a run file')

    def test_pipes_as_certificates_are_refused(self):
        waiting.run([EVOD, "certificate", "localhost"], capture_output=True, check=True, cwd=self.folder)
        certificate, key = self.folder / "evod.crt", self.folder / "evod.key"
        os.chmod(self.pipe, 0o600)
        endless = self.folder / "endless"  # a link to a device
        endless.symlink_to("/dev/zero")
        for options, path, kind in ((["--tls-cert", self.pipe, "--tls-key", key], self.pipe, "a pipe"),
                                    (["--tls-cert", endless, "--tls-key", key], endless, "a device"),
                                    (["--tls-cert", certificate, "--tls-key", self.pipe], self.pipe, "a pipe"),
                                    (["--tls-cert", certificate, "--tls-key", key, "--tls-client-ca", endless], endless,
                                     "a device")):
            self.assert_refused(*self.serve(*options), words=f"{path}: this is {kind}, not a PEM file")

    def test_sql_in_a_run_file_is_refused_and_not_run(self):
        server = subprocess.Popen([EVOD, *map(str, self.serve("--seed", "7"))], stderr=subprocess.PIPE, text=True)
        self.addCleanup(server.stderr.close)
        for line in server.stderr:
            if "listening on" in line:
                break
        server.terminate()
        self.assertEqual(waiting.ended(server), 0)
        sound, path = self.folder / "sound.evod", self.folder / "data" / "default.evod"
        shutil.copy(path, sound)
        for kind, name, *statements in (
                ("trigger", "t", "CREATE TRIGGER t AFTER INSERT ON journal BEGIN "
                                 "DELETE FROM journal WHERE number = new.number; END"),
                ("trigger", "t", "CREATE TRIGGER t BEFORE INSERT ON journal BEGIN SELECT raise(IGNORE); END"),
                ("view", "founders", "DROP TABLE founders", f"CREATE VIEW founders AS {ENDLESS} "
                                     "SELECT i AS generation, i AS island, x'' AS founders, i AS checksum FROM n"),
                ("view", "run", "DROP TABLE run",
                 f"CREATE VIEW run AS {ENDLESS} SELECT 'a' AS key, 'b' AS value, i AS checksum FROM n"),
                ("index", "i", "CREATE INDEX i ON journal (tick)")):
            shutil.copy(sound, path)
            with sqlite3.connect(path) as run:
                for statement in statements:
                    run.execute(statement)
            run.close()
            words = f'{path} is not as evod wrote it: the {kind} "{name}"'
            for arguments in (["verify", path], ["export", path, "--what", "events"], ["replay", path]):
                self.assert_refused(*arguments, words=words)
            self.assert_damaged(words)


if __name__ == "__main__":
    unittest.main()
