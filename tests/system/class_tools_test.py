"""evoctl class against a real server: a class from a list, plain clients as students, and everything collected. EVOD
and EVOCTL name the programs, MESSAGES the folder of the message classes."""
import csv
import json
import pathlib
import subprocess
import sys
import unittest

import past_test as past
import waiting
from past_test import EVOD, EVOCTL, c, plain, w
from plain_client import session_pb2

NAMES = ["Ada", "Bo Ek", "Zoë"]


class Student(plain.Client):
    """A client that joins with a code, or comes back with a token."""

    def __init__(self, server, **hello):
        super().__init__(server, hello=False)
        self.hello(**hello)
        self.first = self.control()
        self.welcome = self.first.welcome
        self.member = self.welcome.membership


class Classes(past.Case):
    def setUp(self):
        super().setUp()
        self.data = pathlib.Path(self.folder, "data")
        self.server_ = self.server("--data", self.data, "--speed", "max", "--web", "--http-port", "0")

    def evoctl(self, *words, status=0):
        done = waiting.run([EVOCTL, "--server", f"localhost:{self.server_.port}", *waiting.PATIENT, *map(str, words)],
                           capture_output=True, text=True)
        self.assertEqual(done.returncode, status, done.stdout + done.stderr)
        return done.stderr if status else done.stdout

    def json(self, *words):
        return json.loads(self.evoctl("--json", *words))

    def join(self, code, name=""):
        student = Student(self.server_, join=session_pb2.Join(code=code, name=name))
        self.addCleanup(student.socket.close)
        self.assertTrue(student.first.HasField("welcome"), student.first)
        return student

    def listed(self, *names):
        path = pathlib.Path(self.folder, "list.csv")
        path.write_text("name\n" + "".join(f"{name}\n" for name in names))
        return path

    def info(self, name="bio2"):
        return next(x for x in self.json("class", "list")["classes"] if x["name"] == name)


class FromAList(Classes):
    def test_a_class_is_created_joined_compared_and_collected(self):
        experiment = pathlib.Path(self.folder, "lesson.json")
        experiment.write_text(json.dumps({"population_size": 50, "generation_s": 1.0, "seed": 7}))
        created = self.json("class", "create", "bio2", "--experiment", experiment, "--students", self.listed(*NAMES))
        codes = {code["name"]: code["code"] for code in created["codes"]}
        self.assertEqual(list(codes), NAMES)
        students = [self.join(codes[name]) for name in NAMES]
        self.assertEqual([student.member.name for student in students], NAMES)
        worlds = [student.member.world for student in students]
        self.assertEqual(len(set(worlds)), 3)
        for student, world in zip(students, worlds):
            student.call(add_note=c.AddNote(world=world, kind="prediction", text=f"{student.member.name}, \"more\"\n"))
        self.assertIn("started: 3 worlds of bio2", self.evoctl("class", "run", "bio2", "4"))
        for student, world in zip(students, worlds):
            student.wait_world(lambda x: x.state == w.RUN_STATE_WAITING and x.generation == 4, world)
        students[1].call(fork_world=c.ForkWorld(world=worlds[1], name=worlds[1] + "_2"))

        rows = list(csv.DictReader(self.evoctl("class", "compare", "bio2", "--csv").splitlines()))
        self.assertEqual([(row["name"], row["generation"]) for row in rows],
                         [(name, str(generation)) for name in NAMES for generation in (1, 2, 3, 4)])
        self.assertEqual(len({row["fitness_best"] for row in rows if row["generation"] == "1"}), 1, "the same start")
        self.assertEqual(len(self.evoctl("class", "compare", "bio2", "--csv", "--summary").splitlines()), 4)

        folder = pathlib.Path(self.folder, "collected")
        self.assertIn("4 run files", self.evoctl("class", "collect", "bio2", folder))
        self.assertEqual({path.name for path in folder.iterdir()},
                         {f"{world}.evod" for world in [*worlds, worlds[1] + "_2"]} | {"notes.csv", "students.csv"})
        for path in folder.glob("*.evod"):
            verified = waiting.run([EVOD, "verify", path], capture_output=True, text=True)
            self.assertEqual(verified.returncode, 0, verified.stderr)
        with open(folder / "notes.csv", newline="") as file:
            notes = list(csv.DictReader(file))
        self.assertEqual([tuple(note[column] for column in ("name", "world", "kind", "text", "generation"))
                          for note in notes],
                         [(name, world, "prediction", f"{name}, \"more\"\n", "1")
                          for name, world in zip(NAMES, worlds)])
        with open(folder / "students.csv", newline="") as file:
            rows = list(csv.DictReader(file))
        self.assertEqual([tuple(row[column] for column in ("name", "generations", "worlds", "notes", "joined"))
                          for row in rows],
                         [("Ada", "4", "1", "1", "true"), ("Bo Ek", "4", "2", "1", "true"),
                          ("Zoë", "4", "1", "1", "true")])
        self.server("replay", folder / f"{worlds[0]}.evod")

    def test_a_wrong_list_creates_nothing(self):
        wrong = self.listed("Ada", "Bo", "Ada", "x" * 25)
        faults = self.evoctl("class", "create", "bio2", "--students", wrong, status=2)
        self.assertIn("list.csv, line 4: Ada stands in line 2 already", faults)
        self.assertIn("list.csv, line 5: the name has 25 characters", faults)
        self.assertIn("No such file", self.evoctl("class", "create", "bio2", "--students", "/nowhere/x", status=2))
        self.evoctl("class", "create", "bio2", "--students", self.listed(*(f"s{i}" for i in range(200))), status=2)
        self.evoctl("class", "create", "bio2", "--range", "population_size=500", status=2)
        self.assertIn("population_size", self.evoctl("class", "create", "bio2", "--set", "population_size=100000",
                                                     "--range", "population_size=1..500", status=2))
        self.assertEqual(self.json("class", "list"), {"classes": []})


class ByCommands(Classes):
    def setUp(self):
        super().setUp()
        self.evoctl("class", "create", "bio2", "--set", "population_size=12", "generation_s=1", "--seed", 7)
        self.ada = self.join(self.info()["code"], "Ada")

    def world(self, name="bio2_ada"):
        return next(x for x in self.ada.call(list_worlds=c.ListWorlds()).worlds.worlds if x.name == name)

    def test_joining_is_opened_locked_and_renewed(self):
        code = self.info()["code"]
        shown = self.evoctl("class", "show", "bio2")
        self.assertIn(f"#join={code}", shown)
        self.assertRegex(shown, r"1  Ada +bio2_ada +1  joined")
        self.assertIn("no student can join", self.evoctl("class", "lock", "bio2"))
        refused = Student(self.server_, join=session_pb2.Join(code=code, name="Bo"))
        self.addCleanup(refused.socket.close)
        self.assertEqual(refused.first.goodbye.status.reason, c.REASON_CODE_UNKNOWN)
        new = self.evoctl("class", "code", "bio2", "--page", "https://lab.example", "--qr")
        self.assertIn("https://lab.example/#join=", new)
        self.assertNotIn(code, new)
        self.assertIn("█▀", new)
        self.assertEqual(self.join(self.info()["code"], "Bo").member.world, "bio2_bo")

    def test_members_are_removed_readmitted_and_renamed(self):
        token = self.ada.member.token
        self.assertIn("Ada is removed", self.evoctl("class", "kick", "bio2", "Ada"))
        self.assertEqual(self.ada.goodbye().reason, c.REASON_MEMBER_REMOVED)
        self.assertIn("is a member again", self.evoctl("class", "readmit", "bio2", "1"))
        self.assertIn("is now Ada L.", self.evoctl("class", "rename", "bio2", "Ada", "Ada L."))
        (code,) = self.json("class", "sheet", "bio2", "Ada L.")["codes"]
        again = self.join(code["code"])
        self.assertEqual((again.member.name, again.member.world), ("Ada L.", "bio2_ada"))
        self.assertNotEqual(again.member.token, token)
        self.assertIn("has no member Bob", self.evoctl("class", "kick", "bio2", "Bob", status=1))
        self.assertIn("has joined already", self.evoctl("class", "sheet", "bio2", status=1))

    def test_all_worlds_are_controlled_at_once(self):
        self.join(self.info()["code"], "Bo")
        self.assertIn("changed: 2 worlds", self.evoctl("class", "set", "bio2", "mutation_chance=0.5"))
        self.assertIn("mutation_chance", self.evoctl("class", "set", "bio2", "mutation_chance=2", status=1))
        self.assertIn("speed set: 2 worlds", self.evoctl("class", "speed", "bio2", "2"))
        self.assertIn("started: 2 worlds", self.evoctl("class", "run", "bio2"))
        self.assertIn("is frozen", self.evoctl("class", "freeze", "bio2"))
        tick = self.world().tick
        self.assertTrue(self.world().frozen)
        self.ada.call(plain.PRECONDITION, pause=c.Pause(world="bio2_ada"))
        self.assertRegex(self.evoctl("status"), r"bio2_ada +frozen .* bio2 +bio2/ada")
        self.assertEqual(self.world().tick, tick)
        self.assertIn("goes on", self.evoctl("class", "resume", "bio2"))
        plain.until(lambda: self.world().tick > tick, "ticks")
        self.assertIn("paused: 2 worlds", self.evoctl("class", "pause", "bio2"))
        self.assertEqual(self.world().state, w.RUN_STATE_PAUSED)
        self.assertIn("resumed: 2 worlds", self.evoctl("class", "resume", "bio2"))
        self.assertIn("reset: 2 worlds", self.evoctl("class", "reset", "bio2", "--seed", "9"))
        self.assertEqual(self.world().seed, 9)
        self.assertIn("deleted class bio2", self.evoctl("class", "delete", "bio2"))
        self.assertIn("no classes", self.evoctl("class", "list"))
        self.assertIn("no class has the name bio2", self.evoctl("class", "show", "bio2", status=1))

    def test_a_teacher_sees_the_own_classes(self):
        self.server_.end()
        token = subprocess.run([EVOD, "token", "add", "frau_k", "--role", "teacher", "--data", self.data],
                               capture_output=True, text=True, check=True).stdout.strip()
        subprocess.run([EVOD, "token", "add", "otto", "--role", "admin", "--data", self.data], capture_output=True,
                       check=True)
        self.server_ = self.server("--data", self.data, "--require-token")
        path = pathlib.Path(self.folder, "token")
        path.write_text(token)
        path.chmod(0o600)
        self.assertIn("no classes", self.evoctl("--token-file", path, "class", "list"))
        self.evoctl("--token-file", path, "class", "create", "own")
        self.assertIn("own    frau_k", self.evoctl("--token-file", path, "class", "list"))
        self.evoctl("--token-file", path, "class", "freeze", "bio2", status=1)
        self.assertIn("role", self.evoctl("--token-file", path, "create", "x", status=1))


if __name__ == "__main__":
    unittest.main(argv=[sys.argv[0], *sys.argv[4:]])
