"""The wheel of scripts/package_python is complete: it works in a new virtual environment, without protoc and the
sources."""
import os
import pathlib
import subprocess
import tempfile
import unittest

SOURCES = pathlib.Path(__file__).resolve().parents[2]
PROGRAM = """
import evod, evod.aio, evod.v1.commands_pb2
print(evod.__file__)
with evod.local(seed=42) as lab:
    for g in lab.world().run(generations=1):
        print(g)
"""


class Wheel(unittest.TestCase):
    def run_it(self, *command, **environment):
        without_package = {name: value for name, value in os.environ.items() if name != "PYTHONPATH"}
        done = subprocess.run(command, capture_output=True, text=True, cwd=self.folder,
                              env={**without_package, **environment})
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
        return done.stdout

    def test_the_wheel_works_in_a_new_environment(self):
        with tempfile.TemporaryDirectory() as folder:
            self.folder = pathlib.Path(folder)
            printed = self.run_it(str(SOURCES / "scripts/package_python"), folder, EVOD_SKIP_SETUP="1")
            (wheel,) = self.folder.glob("evod-*-py3-none-any.whl")
            self.assertEqual(printed.strip(), str(wheel))
            self.run_it("/usr/bin/python3", "-m", "venv", "--system-site-packages", "new")
            python = str(self.folder / "new/bin/python3")
            (self.folder / "tools").mkdir()
            (self.folder / "tools/rm").symlink_to("/bin/rm")  # for the shell that supervises a local server
            tools = {"PATH": f"{folder}/new/bin:{folder}/tools"}
            self.run_it(python, "-m", "pip", "install", "--quiet", "--no-index", "--no-deps", str(wheel), **tools)
            where, generation = self.run_it(python, "-c", PROGRAM, **tools).splitlines()
            self.assertTrue(where.startswith(folder), where)
            self.assertEqual(generation, "generation 1: best 337.6, mean 71.1, 25 of 50 alive")

    def test_the_same_sources_give_the_same_bytes(self):
        built = []
        for _ in range(2):
            with tempfile.TemporaryDirectory() as folder:
                self.folder = pathlib.Path(folder)
                self.run_it(str(SOURCES / "scripts/package_python"), folder, EVOD_SKIP_SETUP="1")
                built.append(next(self.folder.glob("*.whl")).read_bytes())
        self.assertEqual(built[0], built[1])


if __name__ == "__main__":
    unittest.main()
