"""evod verify and evod export, on runs that real servers have written. EVOD and EVOCTL name the programs."""
import csv
import io
import json
import os
import pathlib
import re
import shutil
import signal
import sqlite3
import struct
import subprocess
import tempfile
import unittest

import waiting

EVOD, EVOCTL = os.environ["EVOD"], os.environ["EVOCTL"]
EXPERIMENT = {"population_size": 12, "generation_s": 2, "island_count": 2, "migration": "ring", "migration_epoch": 2,
              "migrant_count": 4}
GENES = ["normal_speed", "impulse", "body_size", "base_health", "food_radius", "poison_radius"]


def evod(*arguments, status=0):
    done = waiting.run([EVOD, *map(str, arguments)], capture_output=True, text=True)
    assert done.returncode == status, f"status {done.returncode}, wanted {status}\n{done.stdout}\n{done.stderr}"
    return done.stdout if status == 0 else done.stderr


class Server:
    """A context with a server that has the world "small"; leaving it shuts the server down."""

    def __init__(self, folder, seed, *options):
        experiment = pathlib.Path(folder) / "small.json"
        experiment.write_text(json.dumps(EXPERIMENT))
        self.run = pathlib.Path(folder) / "small.evod"
        self.process = subprocess.Popen(
            [EVOD, "--data", folder, "--port", "0", "--speed", "max", "--experiment", experiment, "--seed", str(seed),
             *options],
            stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
        for line in self.process.stdout:
            if found := re.search(r"listening on (127\.0\.0\.1:\d+)", line):
                self.address = found[1]
                return
        raise AssertionError("the server did not start")

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.end(signal.SIGTERM, 0)

    def end(self, how, status):
        self.process.send_signal(how)
        waiting.communicate(self.process)
        assert self.process.returncode == status, self.process.returncode

    def evoctl(self, *words):
        done = waiting.run([EVOCTL, "--server", self.address, *waiting.PATIENT, *words], capture_output=True, text=True)
        assert done.returncode == 0, f"{words}\n{done.stdout}\n{done.stderr}"


def setUpModule():
    """Three and a half generations with changes; four without; and the same with another seed."""
    global folder, changed, plain, other
    folder = tempfile.TemporaryDirectory()
    unittest.addModuleCleanup(folder.cleanup)
    paths = []
    for name, seed in ("changed", 1), ("plain", 2), ("other", 3):
        os.mkdir(f"{folder.name}/{name}")
        with Server(f"{folder.name}/{name}", seed) as server:
            if name == "changed":
                server.evoctl("until", "130", "--wait")
                server.evoctl("set", "food_health=7", "mutation_chance=0.5")
                server.evoctl("until", "240", "--wait")
                server.evoctl("set", "population_size=15")
                server.evoctl("until", "421", "--wait")
            else:
                server.evoctl("run", "4", "--wait")
        paths.append(server.run)
    changed, plain, other = paths


class Case(unittest.TestCase):
    def setUp(self):
        own = tempfile.TemporaryDirectory()
        self.addCleanup(own.cleanup)
        self.folder = own.name

    def copy(self, run, *statements):
        """A changed copy of a run; `other` is the database of another run."""
        path = f"{self.folder}/copy.evod"
        shutil.copy(run, path)
        database = sqlite3.connect(path, isolation_level=None)
        database.execute(f"ATTACH '{other}' AS other")
        for statement in statements:
            self.assertGreater(database.execute(statement).rowcount, 0, statement)
        database.close()
        return path


class Documentation(Case):
    """Checks docs/RUN_FILE.md: its tables and columns, and its queries."""

    text = (pathlib.Path(__file__).parents[2] / "docs/RUN_FILE.md").read_text()

    def setUp(self):
        super().setUp()
        self.run_file = sqlite3.connect(f"file:{changed}?mode=ro", uri=True)
        self.addCleanup(self.run_file.close)

    def test_every_table_and_column_is_documented(self):
        words = set(re.findall(r"\w+", self.text))
        for (table,) in self.run_file.execute("SELECT name FROM sqlite_schema WHERE type = 'table'").fetchall():
            self.assertIn(table, words)
            # documented as the columns of the CSV
            if table in ("statistics", "inherited_statistics", "selection_account"):
                continue
            for column in self.run_file.execute(f"SELECT name FROM pragma_table_info('{table}')").fetchall():
                self.assertIn(column[0], words, table)

    def test_its_queries_answer(self):
        queries = re.search(r"```sql\n(.*?)```", self.text, re.S)[1].split(";")[:-1]
        self.assertEqual(len(queries), 3)
        best, journal, dying = (self.run_file.execute(query).fetchall() for query in queries)
        self.assertEqual([row[0] for row in best], [1, 2, 3])
        self.assertEqual([row[0] for row in journal if row[0] > 0], [130, 130, 130, 240, 240, 240])
        self.assertTrue(all(2 * (starved + poisoned) > born for _, starved, poisoned, born in dying))


class Verify(Case):
    def test_a_run_agrees_on_any_number_of_threads(self):
        for run, words in (changed, "4 generations, 421 ticks, 7 "), (plain, "4 generations, 480 ticks, 8 "):
            for threads in 1, 2, 7:
                said = evod("verify", run, "--threads", threads)
                self.assertIn("everything agrees: " + words, said)
                self.assertRegex(said, r" state hashes, 0 checkpoints compared in \d+\.\d\d s, \d+(\.\d)? × real "
                                       r"time\n$")

    def test_a_reset_run_and_the_next_one_agree(self):
        with Server(self.folder, 5) as server:
            server.evoctl("until", "150", "--wait")
            server.evoctl("set", "food_health=7", "population_size=9")
            server.evoctl("reset", "--seed", "6")
            server.evoctl("until", "200", "--wait")
            server.evoctl("set", "food_health=8")
            server.evoctl("until", "300", "--wait")
        runs = sorted(pathlib.Path(self.folder).glob("*.evod"), key=lambda run: run.name == "small.evod")
        self.assertEqual(len(runs), 2)
        self.assertIn("2 generations, 150 ticks", evod("verify", runs[0]))
        self.assertIn("3 generations, 300 ticks", evod("verify", runs[1]))

    def test_a_row_of_another_run_is_reported_with_its_moment(self):
        for table, where, moment, part, agrees in (
                ("state_hash", "tick = 180", "generation 2, tick 180", "the state hash: stored ",
                 "generation 2, tick 120: the beginning of the generation"),
                ("outcome", "generation = 2 AND island = 1", "generation 2, tick 240", "the fitness of organism ",
                 "generation 2, tick 240: the state hash"),
                ("population", "generation = 3 AND island = 0", "generation 3, tick 240", "the chromosomes: gene ",
                 "generation 2, tick 240: the end of the generation"),
                ("population", "generation = 1 AND island = 0", "generation 1, tick 0", "the chromosomes: gene ",
                 "none"),
                ("statistics", "generation = 4 AND island = 0", "generation 4, tick 480",
                 "the statistics: fitness_best on island 0", "generation 4, tick 480: the state hash")):
            with self.subTest(table=table, where=where):
                path = self.copy(plain, f"DELETE FROM {table} WHERE {where}",
                                 f"INSERT INTO {table} SELECT * FROM other.{table} WHERE {where}")
                said = evod("verify", path, status=1)
                self.assertIn(f"last tick that agrees: {agrees}\n", said)
                self.assertIn(f"first that differs: {moment}: {part}", said)
                self.assertIn(", simulated again ", said)

    def test_what_cannot_be_verified_is_refused(self):
        for path, words in {
            "/nowhere.evod": "/nowhere.evod: there is no such file",
            self.folder: "this is a folder",
            __file__: "not a database",
        }.items():
            self.assertIn(words, evod("verify", path, status=1))
        self.assertIn("--threads", evod("verify", plain, "--threads", 0, status=2))
        self.assertIn("evod: run: got nothing, a value is required", evod("verify", status=2))

    @unittest.skipIf(os.geteuid() != 0, "only root can become a user with read access alone")
    def test_read_access_is_enough_to_verify(self):
        path = pathlib.Path(self.copy(plain))
        os.chmod(self.folder, 0o755)
        os.chmod(path, 0o644)
        try:
            done = waiting.run([EVOD, "verify", path], capture_output=True, text=True, user=65534, group=65534)
        except PermissionError:
            self.skipTest("other users cannot read the program")
        self.assertEqual(done.returncode, 0, done.stderr)


class Export(Case):
    def rows(self, run, what):
        """The rows of the CSV, every value a text; checks that the JSON Lines are equal."""
        text = evod("export", run, "--what", what)
        rows = list(csv.DictReader(io.StringIO(text, newline="")))
        objects = [json.loads(line) for line in evod("export", run, "--what", what, "--format", "jsonl").splitlines()]
        self.assertEqual(len(rows), len(objects))
        for row, values in zip(rows, objects):
            self.assertEqual(list(row), list(values))
            for name, value in values.items():
                if value is None:
                    self.assertEqual(row[name], "")
                elif isinstance(value, (int, float)):
                    self.assertEqual(float(row[name]), value)
                elif isinstance(value, dict):
                    self.assertEqual(json.loads(row[name]), value)
                else:
                    self.assertEqual(row[name], value)
        return rows

    def test_generations_equal_those_of_evod_run(self):
        evod("run", plain.with_suffix(".json"), "--seed", 2, "--generations", 4, "--csv", self.folder + "/run.csv")
        self.assertEqual(evod("export", plain, "--what", "generations"),
                         pathlib.Path(self.folder + "/run.csv").read_text())
        self.assertEqual(len(self.rows(changed, "generations")), 3 * 2)

    def test_organisms_equal_the_stored_ones(self):
        rows = self.rows(changed, "organisms")
        self.assertEqual(len(rows), 2 * (12 + 12 + 15 + 15))
        database = sqlite3.connect(f"file:{changed}?mode=ro", uri=True)
        self.addCleanup(database.close)
        for generation, island, count, elite, survivors, chromosomes, parents in database.execute(
                "SELECT generation, island, organism_count, elite_count, survivor_count, chromosomes, parents "
                "FROM population ORDER BY generation, island"):
            genes = struct.unpack(f"<{6 * count}f", chromosomes)
            pairs = struct.unpack(f"<{len(parents) // 4}I", parents)
            fitness, lived, cause = database.execute(
                "SELECT fitness, lived_ticks, cause FROM outcome WHERE generation = ? AND island = ?",
                (generation, island)).fetchone() or (b"", b"", b"")
            fitness, lived = struct.unpack(f"<{len(fitness) // 8}d", fitness), struct.unpack(f"<{len(lived) // 4}I",
                                                                                             lived)
            for organism in range(count):
                row = rows.pop(0)
                self.assertEqual([int(row[x]) for x in ("generation", "island", "organism")],
                                 [generation, island, organism])
                for gene, value in zip(GENES, genes[6 * organism:]):
                    self.assertEqual(struct.unpack("<f", struct.pack("<f", float(row[gene])))[0], value)
                    self.assertLessEqual(len(row[gene]), 10)
                if generation == 1:
                    self.assertEqual((row["parent_first"], row["parent_second"], row["origin"]), ("", "", "initial"))
                else:
                    self.assertEqual((int(row["parent_first"]), int(row["parent_second"])),
                                     pairs[2 * organism:2 * organism + 2])
                    self.assertEqual(row["origin"], "elite" if organism < elite else
                                     "survivor" if organism < survivors else "child")
                if generation == 4:  # is not over
                    self.assertEqual((row["fitness"], row["lived_s"], row["cause"]), ("", "", ""))
                    continue
                self.assertEqual(float(row["fitness"]), fitness[organism])
                self.assertEqual(row["cause"], ("alive", "starved", "poisoned")[cause[organism]])
                alive = row["cause"] == "alive"
                self.assertAlmostEqual(float(row["lived_s"]), 2 if alive else lived[organism] / 60)
                if not alive:
                    self.assertEqual(row["lived_s"], row["fitness"])
        self.assertEqual(rows, [])

    def test_events_are_the_commands(self):
        rows = self.rows(changed, "events")
        self.assertEqual([row["kind"] for row in rows],
                         ["create_world", "set_speed", "pause", "run_until_tick", "set_parameters", "pause",
                          "run_until_tick", "set_parameters", "pause", "run_until_tick"])
        self.assertEqual([int(row["number"]) for row in rows], list(range(1, 11)))
        self.assertEqual([int(row["tick"]) for row in rows], [0, 0, 0, 0, 130, 130, 130, 240, 240, 240])
        parts = ("sender", "user", "program")
        self.assertEqual([rows[0][part] for part in (*parts, "address")], ["server", "", "", ""])
        self.assertEqual([rows[3][part] for part in parts], ["client", "", "evoctl"])
        self.assertRegex(rows[3]["address"], r"^127\.0\.0\.1:\d+$")
        for row in rows:
            request = json.loads(row["request"])
            self.assertEqual(list(request), [row["kind"]], "and no client_key, by which another could send the next")
        self.assertEqual(json.loads(rows[4]["request"])["set_parameters"]["parameters"][0],
                         {"name": "food_health", "value": {"real": 7}})

    def lineage(self, run, *arguments):
        rows = list(csv.DictReader(io.StringIO(evod("export", run, "--what", "lineage", *arguments), newline="")))
        return {(int(row["generation"]), int(row["island"]), int(row["organism"])): row for row in rows}

    @staticmethod
    def parents(row):
        return [tuple(int(row[f"parent_{which}{of}"]) for of in ("_generation", "_island", ""))
                for which in ("first", "second")]

    def test_lineage_has_parents_with_their_islands(self):
        self.rows(plain, "lineage")
        family = self.lineage(plain)
        organisms = {tuple(int(row[x]) for x in ("generation", "island", "organism")): row
                     for row in self.rows(plain, "organisms")}
        self.assertEqual(list(family), list(organisms))
        children, kept, strangers = {}, {}, set()
        for name, row in family.items():
            self.assertEqual((row["origin"], row["fitness"]), (organisms[name]["origin"], organisms[name]["fitness"]))
            if name[0] == 1:
                self.assertEqual({row[x] for x in row if x.startswith("parent")}, {""})
                continue
            parents = self.parents(row)
            strangers |= {name[0] for parent in parents if parent[1] != name[1]}
            if row["origin"] == "child":
                for parent in set(parents):
                    children[parent] = children.get(parent, 0) + 1
            else:
                self.assertEqual(parents[0], parents[1])
                kept[parents[0]] = kept.get(parents[0], 0) + 1
                for gene in GENES:  # wherever it came from, it is the same
                    self.assertEqual(organisms[name][gene], organisms[parents[0]][gene])
        self.assertEqual(strangers, {3})  # migration is after every second generation
        for name, row in family.items():
            counts = ("", "") if name[0] == 4 else (str(children.get(name, 0)), str(kept.get(name, 0)))
            self.assertEqual((row["child_count"], row["kept_count"]), counts)

    def test_lineage_of_an_organism_lists_its_ancestors(self):
        family = self.lineage(plain)
        for last in (4, 0, 11), (3, 1, 0), (1, 1, 3):
            ancestors = self.lineage(plain, "--of", ":".join(map(str, last)))
            generations = [name[0] for name in ancestors]
            self.assertEqual(generations, sorted(generations, reverse=True))
            wanted, found = {last}, {}
            while wanted:
                found |= {name: family[name] for name in wanted}
                wanted = {parent for name in wanted if name[0] > 1 for parent in self.parents(family[name])}
            self.assertEqual(ancestors, found)
        for of, words in {
            "5:0:0": "--of: got 5, allowed a generation from 1 to 4",
            "4:2:0": "--of: got 2, allowed an island from 0 to 1",
            "4:1:12": "--of: got 12, allowed an organism from 0 to 11",
            "4:1": "--of: got 4:1, allowed GENERATION:ISLAND:ORGANISM",
        }.items():
            self.assertIn(words, evod("export", plain, "--what", "lineage", "--of", of, status=1))
        self.assertIn("only with --what lineage", evod("export", plain, "--what", "events", "--of", "1:0:0", status=1))

    def test_another_world_can_begin_with_a_population(self):
        path = self.folder + "/plate.csv"
        evod("export", plain, "--what", "population", "--generation", 3, "--output", path)
        rows = list(csv.DictReader(io.StringIO(pathlib.Path(path).read_text())))
        self.assertEqual(list(rows[0]), ["island", "organism", *GENES])
        self.assertEqual([list(row.values()) for row in rows],
                         [[row[x] for x in rows[0]] for row in self.rows(plain, "organisms")
                          if row["generation"] == "3"])
        with Server(self.folder, 8, "--population", path) as server:
            server.evoctl("until", "250", "--wait")
            server.evoctl("reset")
            server.evoctl("until", "130", "--wait")
        for run in pathlib.Path(self.folder).glob("*.evod"):
            self.assertIn("everything agrees", evod("verify", run))
            self.assertEqual(evod("export", run, "--what", "population", "--generation", 1),
                             pathlib.Path(path).read_text())
            again = self.folder + "/again.csv"
            evod("run", plain.with_suffix(".json"), "--seed", 8, "--population", path, "--generations", 1, "--csv",
                 again)
            self.assertEqual(evod("export", run, "--what", "generations").splitlines()[:3],
                             pathlib.Path(again).read_text().splitlines())
        # Without --population the world continues; with another population the server refuses it.
        Server(self.folder, 8).end(signal.SIGTERM, 0)
        evod("export", plain, "--what", "population", "--generation", 2, "--output", path)
        self.assertIn("with other organisms", evod("--data", self.folder, "--experiment", self.folder + "/small.json",
                                                         "--population", path, status=1))
        self.assertIn("--generation: got 5, allowed 1 to 4",
                      evod("export", plain, "--what", "population", "--generation", 5, status=1))
        self.assertIn("only with --what population",
                      evod("export", plain, "--what", "events", "--generation", 1, status=1))

    def test_a_world_is_created_with_a_population(self):
        path = self.folder + "/plate.csv"
        evod("export", plain, "--what", "population", "--output", path)  # of the last generation
        with Server(self.folder, 9) as server:
            server.evoctl("create", "same", "--experiment", self.folder + "/small.json", "--population", path)
        self.assertEqual(evod("export", self.folder + "/same.evod", "--what", "population"),
                         pathlib.Path(path).read_text())

    def bundle(self, run, *names):
        folder = pathlib.Path(self.folder) / "bundle"
        shutil.rmtree(folder, ignore_errors=True)
        evod("export", run, "--bundle", folder)
        self.assertEqual(sorted(file.name for file in folder.iterdir()),
                         sorted(["REPEAT.md", "SHA256SUMS", "events.csv", "experiment.json", "generations.csv",
                                 "lineage.csv", "notes.csv", "organisms.csv", *names]))
        subprocess.run(["sha256sum", "--check", "--strict", "--quiet", "SHA256SUMS"], cwd=folder, check=True)
        for what in "generations", "organisms", "lineage", "events", "notes":
            self.assertEqual((folder / f"{what}.csv").read_text(),
                             evod("export", folder / "small.evod", "--what", what))
        self.assertIn("everything agrees", evod("verify", folder / "small.evod"))
        return folder

    def repeat(self, folder):
        """Runs the commands of REPEAT.md."""
        commands = re.findall("^    (.*)$", (folder / "REPEAT.md").read_text(), re.M)
        for command in commands:
            words = [EVOD if word == "evod" else word for word in command.split()]
            subprocess.run(words, cwd=folder, check=True, stdout=subprocess.PIPE)
        return len(commands)

    def test_a_bundle_states_how_to_repeat_the_run(self):
        self.assertEqual(self.repeat(self.bundle(plain, "small.evod")), 4)
        with sqlite3.connect(f"file:{plain}?mode=ro", uri=True) as run:
            (build,) = run.execute("SELECT value FROM run WHERE key = 'build'").fetchone()
        self.assertRegex(build, r"^([0-9a-f]{12}\+? by )?(GNU|Clang) [0-9.]+ for \w+, \w+$")
        self.assertIn(f", built from {build} |", (pathlib.Path(self.folder) / "bundle/REPEAT.md").read_text())
        folder = self.bundle(changed, "small.evod")
        self.assertEqual(self.repeat(folder), 2)
        self.assertIn("The world was changed 2 times during the run", (folder / "REPEAT.md").read_text())
        self.assertIn("exists already", evod("export", plain, "--bundle", folder, status=1))
        self.assertIn("--format: got jsonl, allowed only csv with --bundle",
                      evod("export", plain, "--bundle", self.folder + "/lines", "--format", "jsonl", status=1))
        self.assertFalse(os.path.exists(self.folder + "/lines"))
        self.assertIn("/nowhere/b: No such", evod("export", plain, "--bundle", "/nowhere/b", status=1))
        damaged = self.copy(plain, "UPDATE statistics SET alive_count = 99 WHERE generation = 2")
        evod("export", damaged, "--bundle", self.folder + "/half", status=1)
        self.assertFalse(os.path.exists(self.folder + "/half"))

    def test_a_fork_is_created_in_the_folder_of_its_file(self):
        with tempfile.TemporaryDirectory() as folder:
            shutil.copy(plain, folder)
            evod("fork", f"{folder}/{os.path.basename(plain)}", "--name", "beside")
            self.assertIn("everything agrees", evod("verify", f"{folder}/beside.evod"))

    def test_a_bundle_is_of_one_moment_while_a_server_writes(self):
        plate = self.folder + "/plate.csv"
        evod("export", plain, "--what", "population", "--output", plate)
        with Server(self.folder, 4, "--population", plate, "--keep-every", "5") as server:
            server.evoctl("until", "1500", "--wait")
            server.evoctl("run")
            folder = self.bundle(server.run, "small.evod", "population.csv")
            self.assertEqual(self.repeat(folder), 4)
            self.assertEqual((folder / "population.csv").read_text(), pathlib.Path(plate).read_text())

    def test_a_file_gets_the_output_of_stdout(self):
        path = self.folder + "/organisms.jsonl"
        self.assertEqual(evod("export", plain, "--what", "organisms", "--format", "jsonl", "--output", path), "")
        self.assertEqual(pathlib.Path(path).read_text(),
                         evod("export", plain, "--what", "organisms", "--format", "jsonl"))

    def test_errors_name_the_field(self):
        path = self.copy(plain)
        for arguments, words in {
            (path, "--what", "genes"): ["--what", "genes", "generations", "organisms", "lineage", "population",
                                        "events"],
            (path, "--what", "events", "--format", "xml"): ["--format", "xml", "csv", "jsonl"],
            (path, "--what", "events", "--bundle", self.folder + "/b"): ["--what: not allowed with --bundle"],
        }.items():
            said = evod("export", *arguments, status=2)
            for word in words:
                self.assertIn(word, said)
        for arguments, words in {
            (path,): ["--what: got nothing", "--bundle FOLDER"],
            ("/nowhere.evod", "--what", "events"): ["/nowhere.evod: there is no such file"],
            (path, "--what", "events", "--output", "/nowhere/events"): ["--output: cannot write /nowhere/events: No "
                                                                        "such"],
            (path, "--what", "events", "--output", path): ["--output: got " + path,
                                                           "a file other than the run file itself"],
            (path, "--what", "organisms", "--output", "/dev/full"): ["--output: cannot write /dev/full"],
        }.items():
            said = evod("export", *arguments, status=1)
            for word in words:
                self.assertIn(word, said)
        evod("verify", path)  # it is still there
        damaged = self.copy(plain, "UPDATE statistics SET alive_count = 99 WHERE generation = 2")
        self.assertIn("statistics of generation 2", evod("export", damaged, "--what", "generations", status=1))


unittest.main()
