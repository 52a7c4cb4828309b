"""Run files read without a server: tables, damage, purged generations."""
import os
import pathlib
import shutil
import sqlite3
import subprocess
import tempfile
import unittest

import numpy
import pandas

import evod
from evod.tables import read_csv
from support import PROGRAM, Server

SMALL = {"population_size": 10, "generation_s": 3}


def exported(path, *what):
    done = subprocess.run([PROGRAM, "export", str(path), "--what", *what], capture_output=True, text=True, check=True)
    return read_csv(done.stdout)


class RunFiles(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        folder = tempfile.TemporaryDirectory()
        cls.addClassCleanup(folder.cleanup)
        cls.folder = pathlib.Path(folder.name)
        cls.path = cls.folder / "default.evod"
        with evod.local(seed=42, experiment=SMALL, data=folder.name) as lab:
            world = lab.world()
            world.run(3).wait()
            world.set(mutation_chance=0.4, elite_count=1)
            world.run(4).wait()
            islands = lab.create_world("islands", {**SMALL, "island_count": 3, "migration": "ring",
                                                   "migration_epoch": 1},
                                       seed=2, speed="max")
            islands.run(3).wait()
            with evod.open_run(cls.path) as run:  # while the server has it open
                assert len(run.generations()) >= 6
            cls.tables = {table: world.table(table) for table in ("generations", "organisms", "population", "events")}

    def test_tables_equal_those_of_evod_export(self):
        for name in ("default", "islands"):
            path = self.folder / f"{name}.evod"
            with evod.open_run(path) as run:
                for table in ("generations", "organisms", "population", "events", "lineage"):
                    ours, theirs = getattr(run, table)(), exported(path, table)
                    self.assertGreater(len(ours), 0)
                    if table == "events":  # Python and evod format the same JSON differently
                        ours, theirs = ours.drop(columns="request"), theirs.drop(columns="request")
                    pandas.testing.assert_frame_equal(ours, theirs, check_exact=True, check_dtype=False,
                                                      obj=f"{name}, {table}")
                pandas.testing.assert_frame_equal(run.lineage((2, 0, 3)), exported(path, "lineage", "--of", "2:0:3"))
                pandas.testing.assert_frame_equal(run.population(2), exported(path, "population", "--generation", "2"))

    def test_a_server_returns_the_same_tables(self):
        with evod.open_run(self.path) as run:
            for table, expected in self.tables.items():
                if table != "events":
                    pandas.testing.assert_frame_equal(getattr(run, table)(), expected, check_exact=True,
                                                      check_dtype=False)

    def test_properties_describe_the_run(self):
        with evod.open_run(self.path) as run:
            self.assertEqual((run.name, run.seed, run.first_generation, run.last_generation), ("default", 42, 1, 7))
            self.assertEqual(run.parameters["population_size"], 10)
            parents = run.organisms()["parent_first"]
            self.assertEqual((str(parents.dtype), parents.isna().sum()), ("Int64", 10))
            self.assertEqual([run.parameters_of(g)["elite_count"] for g in (1, 7)], [0, 1])
            self.assertEqual(run.retained_generations, [1, 2, 3, 4, 5, 6, 7])
            self.assertEqual(list(run.events()["kind"][-3:]), ["run", "set_parameters", "run"])

    def test_genes_begin_another_world(self):
        with evod.open_run(self.path) as run, evod.local(seed=1) as lab:
            genes = run.genes(5)
            world = lab.create_world("plate", SMALL, population=genes)
            numpy.testing.assert_array_equal(world.population().genes, genes[0])

    def test_purged_generations_are_named(self):
        with tempfile.TemporaryDirectory() as folder:
            server = Server("--data", folder, "--keep-every", "3", "--speed", "max")
            with evod.connect(f"127.0.0.1:{server.port}") as lab:
                lab.world().run(6).wait()
            server.end()
            with evod.open_run(os.path.join(folder, "default.evod")) as run:
                self.assertEqual(run.retained_generations, [1, 4, 6])
                self.assertEqual(sorted(set(run.organisms()["generation"])), [1, 4, 6])
                self.assertEqual(len(run.generations()), 6)
                with self.assertRaisesRegex(evod.Error, "no longer contains the organisms of generation 2"):
                    run.genes(2)

    def test_other_files_are_refused(self):
        with self.assertRaisesRegex(evod.Error, "there is no run file .*/no.evod"):
            evod.open_run(self.folder / "no.evod")
        for name, content in (("empty.evod", b""), ("text.evod", b"generation,island\n" * 1000),
                              ("zero.evod", bytes(8192))):
            (self.folder / name).write_bytes(content)
            with self.assertRaisesRegex(evod.DamagedData, f"{name} is not a run file"):
                evod.open_run(self.folder / name)
        other = self.folder / "other.evod"
        with sqlite3.connect(other) as file:
            file.execute("CREATE TABLE run (key TEXT, value TEXT)")
        file.close()
        with self.assertRaisesRegex(evod.DamagedData, "is not a run file"):
            evod.open_run(other)

    def test_a_view_in_place_of_a_table_is_refused(self):
        path = self.folder / "view.evod"
        shutil.copy(self.path, path)
        with sqlite3.connect(path) as file:
            file.execute("DROP TABLE run")
            file.execute("CREATE VIEW run AS WITH RECURSIVE n(i) AS (SELECT 1 UNION ALL SELECT i + 1 FROM n) "
                         "SELECT i AS key, i AS value FROM n")
        file.close()
        with self.assertRaisesRegex(evod.DamagedData, "view.evod is not as evod wrote it: it contains the view 'run'"):
            evod.open_run(path)

    def test_damage_raises_DamagedData(self):
        for table, column in (("population", "chromosomes"), ("population", "parents"), ("outcome", "fitness")):
            path = self.folder / "damaged.evod"
            shutil.copy(self.path, path)
            with sqlite3.connect(path) as file:
                file.execute(f"UPDATE {table} SET {column} = x'0102' WHERE generation = 3")
            file.close()
            with evod.open_run(path) as run, self.assertRaises(evod.DamagedData):
                run.organisms()
        with evod.open_run(self.path) as run, self.assertRaisesRegex(evod.Error,
                                                                     "generation: got 99, allowed in .*: 1 to 7"):
            run.genes(99)

    def test_reading_changes_nothing(self):
        before = self.path.read_bytes()
        with evod.open_run(self.path) as run:
            run.organisms()
            with self.assertRaises(evod.DamagedData):
                run._execute("DELETE FROM run")
        self.assertEqual(self.path.read_bytes(), before)


if __name__ == "__main__":
    unittest.main()
