"""Classes from Python: a teacher, members who join, notes, and what is collected."""
import csv
import pathlib
import subprocess
import tempfile
import unittest

import evod
import evod.aio
from support import PROGRAM, Relay, until


class Teacher(unittest.TestCase):
    def setUp(self):
        self.lab = evod.local(seed=1)
        self.addCleanup(self.lab.close)
        self.bio2 = self.lab.create_class("bio2", {"population_size": 12, "generation_s": 1.0}, seed=7,
                                          ranges={"population_size": (1, 50)})

    def join(self, name, **options):
        lab = evod.join(self.lab.address, self.bio2.open(), name, **options)
        self.addCleanup(lab.close)
        return lab, lab.world(lab.membership.world)

    def test_members_note_predictions_and_all_is_collected(self):
        ada, bo = self.join("Ada"), self.join("Bo")
        self.assertEqual([member.name for member in self.bio2.members()], ["Ada", "Bo"])
        self.assertEqual((ada[0].role, ada[0].membership.class_), ("viewer", "bio2"))
        self.assertIsNone(self.lab.membership)
        for lab, world in (ada, bo):
            world.note(f"of {lab.membership.name}\n", kind="prediction")
            world.set_speed("max")
        self.assertEqual(self.bio2.run(3), {})
        for _, world in (ada, bo):
            world.wait()
        (note,) = ada[1].notes()
        self.assertEqual((note.kind, note.text, note.generation, note.user),
                         ("prediction", "of Ada\n", 1, "bio2/ada"))
        mean = ada[1].observe("mean(fitness_mean, 1, 3)")
        self.assertAlmostEqual(mean, sum(g.mean for g in ada[1].history()) / 3)
        self.assertIsNone(ada[1].observe("mean(fitness_mean, 1, 30)"))
        rows = self.bio2.compare()
        self.assertEqual([(row["name"], row["generation"]) for row in rows],
                         [(name, generation) for name in ("Ada", "Bo") for generation in (1, 2, 3)])
        self.assertEqual(rows[0]["fitness_best"], rows[3]["fitness_best"], "the same start")
        with tempfile.TemporaryDirectory() as folder:
            written = self.bio2.collect(pathlib.Path(folder, "new"))
            self.assertEqual([path.name for path in written],
                             ["bio2_ada.evod", "bio2_bo.evod", "notes.csv", "students.csv"])
            for path in written[:2]:
                subprocess.run([PROGRAM, "verify", path], check=True, capture_output=True)
            with open(written[2], newline="") as file:
                self.assertEqual([(row["name"], row["text"]) for row in csv.DictReader(file)],
                                 [("Ada", "of Ada\n"), ("Bo", "of Bo\n")])
            with open(written[3], newline="") as file:
                students = list(csv.DictReader(file))
            self.assertEqual([(row["name"], row["generations"], row["notes"]) for row in students],
                             [("Ada", "3", "1"), ("Bo", "3", "1")])
            self.assertEqual(list(evod.open_run(written[0]).notes()["text"]), ["of Ada\n"])

    def test_refusals_of_single_worlds_are_returned(self):
        lab, world = self.join("Ada")
        self.assertEqual(list(self.bio2.resume()), ["bio2_ada"], "it has no goal")
        self.assertEqual(self.bio2.set(mutation_chance=0.5), {})
        self.assertEqual(world.get_parameters().mutation_chance, 0.5)
        with self.assertRaises(evod.InvalidArgument):
            self.bio2.set(mutation_chance=2)
        with self.assertRaisesRegex(evod.InvalidArgument, "population_size"):
            world.set(population_size=51)
        self.bio2.freeze()
        self.assertTrue(self.bio2.info().frozen)
        with self.assertRaises(evod.FailedPrecondition):
            world.run(1)
        self.assertEqual(self.bio2.resume(), {})
        self.assertEqual(self.bio2.reset(seed=9), {})
        self.assertEqual(world.info().seed, 9)

    def test_members_are_managed(self):
        lab, _ = self.join("Ada")
        self.bio2.lock()
        self.assertEqual(self.bio2.info().code, "")
        with self.assertRaises(evod.Unauthenticated):
            evod.join(self.lab.address, "BCDFGH", "Bo")
        (code,) = self.bio2.add_members(["Zoë"])
        with evod.join(self.lab.address, code.code) as zoe:
            self.assertEqual(zoe.membership.name, "Zoë")
        with self.assertRaises(evod.InvalidArgument) as raised:
            self.bio2.add_members(["x" * 25])
        self.assertEqual([violation.field for violation in raised.exception.violations], ["names[0]"])
        self.bio2.rename("Ada", "Ada L.")
        self.bio2.kick("Ada L.")
        until(lambda: not lab._link.core.connected, "the end of the session")
        self.bio2.readmit(1)
        with evod.join(self.lab.address, self.bio2.new_personal_code("Ada L.")) as again:
            self.assertEqual(again.membership.world, "bio2_ada")
        with self.assertRaises(KeyError):
            self.bio2.kick("Bob")
        self.assertEqual(self.bio2.update(lesson="drift", ranges={}).lesson, "drift")
        self.assertEqual([one.name for one in self.lab.classes()], ["bio2"])
        self.bio2.delete()
        self.assertEqual(self.lab.classes(), ())
        with self.assertRaises(evod.NotFound):
            self.lab.classroom("bio2")
        with self.assertRaises(evod.InvalidArgument):
            self.lab.create_class("bio2", seeds="none")

    def test_a_lost_member_comes_back_as_the_same(self):
        relay = Relay(int(self.lab.address.rpartition(":")[2]))
        self.addCleanup(relay.close)
        lab = evod.join(relay.address, self.bio2.open(), "Ada")
        self.addCleanup(lab.close)
        for _ in range(2):
            relay.cut()
            self.assertEqual(lab.world(lab.membership.world).info().owner, "bio2/ada")
        self.assertEqual(len(self.bio2.members()), 1)


class Asynchronous(unittest.IsolatedAsyncioTestCase):
    async def test_the_same_with_asyncio(self):
        async with evod.aio.local() as teacher:
            bio2 = await teacher.create_class("bio2", {"population_size": 12})
            async with evod.aio.join(teacher.address, await bio2.open()) as lab:
                world = await lab.world(lab.membership.world)
                await world.note("x")
                self.assertEqual([note.text for note in await world.notes()], ["x"])
            with tempfile.TemporaryDirectory() as folder:
                self.assertEqual(len(await bio2.collect(folder)), 3)


if __name__ == "__main__":
    unittest.main()
