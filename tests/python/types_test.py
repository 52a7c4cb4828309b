"""mypy --strict accepts the package and a program that uses it."""
import pathlib
import shutil
import subprocess
import sys
import tempfile
import unittest

import evod

PACKAGE = pathlib.Path(evod.__file__).parent.parent
CONFIGURATION = pathlib.Path(__file__).resolve().parents[2] / "client" / "python" / "pyproject.toml"
PROGRAM = '''
from concurrent.futures import ProcessPoolExecutor
from typing import Any, assert_type
import evod, evod.aio
from evod.v1 import stream_pb2

with evod.connect("host", token="") as lab:
    assert_type(lab, evod.Lab)
    world = lab.world()
    for g in world.run(generations=5):
        assert_type(g.best, float)
    for snapshot in world.snapshots():
        assert_type(snapshot, evod.Snapshot)
        assert_type(snapshot.organisms, evod.Organisms)
        assert_type(snapshot.organisms[0], evod.Organism)
        assert_type(snapshot.organisms[snapshot.organisms.x_px < 9], evod.Organisms)
        assert_type(snapshot.state, evod.RunState)
    assert_type(world.get_parameters()["mutation_chance"].allowed, str)
    assert_type(world.info().outcome, evod.Outcome | None)
    assert_type(world.history(), evod.History)
    assert_type(world.statistics().last[0].genes["impulse"].mean, float)
    assert_type(world.organism(1).genes, evod.Genes)

assert_type(evod.run({"population_size": 9}, generations=3, selection="random"), evod.RunFile)
assert_type(evod.sweep("x.json", grid={"mutation_chance": [0.1]}).seeds, tuple[int, ...])
with ProcessPoolExecutor() as executor:
    assert_type(evod.sweep("x.json", list=[{"mutation_chance": 0.1}], executor=executor), evod.Sweep)
    table = executor.submit(evod.run_table, "x.json", seed=1).result().fitness_mean
assert_type(evod.compare("x.json", {}).differences, tuple[evod.Difference, ...])

async def main() -> None:
    async with evod.aio.connect("host") as lab:
        assert_type(lab, evod.aio.Lab)
        world = await lab.world()
        async for g in world.run(generations=5):
            assert_type(g, evod.Generation)
        async with world.snapshots() as snapshots:
            assert_type(await anext(snapshots), evod.Snapshot)
        assert_type(await world.run(1), evod.aio.Run)
        assert_type((await world.info()).state, evod.RunState)
    assert_type(await evod.aio.run(seed=1, generations=3), evod.RunFile)
'''


@unittest.skipUnless(shutil.which("mypy"), "mypy is not installed")
class Types(unittest.TestCase):
    def mypy(self, *arguments):
        command = ["mypy", "--config-file", CONFIGURATION, "--cache-dir", PACKAGE.parent / "mypy_cache", *arguments]
        done = subprocess.run(command, cwd=PACKAGE, capture_output=True, text=True)
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)

    def test_the_package_is_typed(self):
        self.mypy()

    def test_a_program_is_typed(self):
        with tempfile.TemporaryDirectory() as folder:
            program = pathlib.Path(folder) / "program.py"
            program.write_text(PROGRAM)
            self.mypy(program)


if __name__ == "__main__":
    unittest.main()
