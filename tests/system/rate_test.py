"""Fitness from clients without the Python package: evoctl, and the commands that need no network. EVOD and EVOCTL name
the programs, MESSAGES the folder of the message classes."""
import json
import pathlib
import sys
import unittest

import access_test as access
import waiting
from access_test import EVOD, c, plain

SETTING = {"fitness": "external", "external_bodies": False, "population_size": 4, "island_count": 2}


def evod(*words, status=0):
    done = waiting.run([EVOD, *words], capture_output=True, text=True)
    assert done.returncode == status, f"{words}\n{done.stdout}\n{done.stderr}"
    return done.stdout + done.stderr


class Rating(access.Access):
    def setUp(self):
        super().setUp()
        self.experiment = self.file("rated.json", json.dumps(SETTING))

    def file(self, name, text):
        path = pathlib.Path(self.folder, name)
        path.write_text(text)
        return str(path)

    def waiting_world(self, client):
        return plain.until(lambda: client.world("rated").HasField("awaited_fitness") and client.world("rated"),
                           "the end of the generation")

    def begin(self):
        server = self.serve("--speed", "max", "--seed", "7", "--experiment", self.experiment)
        client = self.come(server)
        client.call(run=c.Run(world="rated", generations=2))
        self.waiting_world(client)
        return server, client

    def test_a_fitness_has_four_digits(self):
        server, client = self.begin()
        for island, numbers in enumerate(("0.953\n0.954\n0.9531\n0.95\n", "-0.004\n-1e-9\n-0.0\n0\n")):
            self.evoctl("rate", self.file("numbers.txt", numbers), "--island", str(island), server=server)
        plain.until(lambda: client.call(get_statistics=c.GetStatistics(world="rated")).statistics.last, "its end")
        rows = [line.split()[2:6] for line in self.evoctl("history", server=server).splitlines()[1:]]
        self.assertEqual(rows, [["0.954", "0.9525", "0.953", "0.95"], ["0.0", "-0.001", "-5e-10", "-0.004"]])
        self.assertIn("fitness 0.954: organism 1 of island 0", self.evoctl("best", server=server))

    def test_evoctl_rates_and_shows_what_is_missing(self):
        server, client = self.begin()
        numbers = self.file("numbers.txt", "1\n-2.5\n3e3\r\n0\n")
        self.assertIn("waits for fitness", self.evoctl("status", server=server))
        self.assertIn("1 of 2 islands rated", self.evoctl("rate", numbers, "--generation", "1", server=server))
        for wrong, got in ((self.file("word.txt", "1\nx\n"), "line 2: got x"),
                           (self.file("five.txt", "1\n" * 5), "got 5"),
                           (self.file("none.txt", ""), "got none"), (self.folder, "this is a folder"),
                           ("/dev/zero", "this is a device"),
                           (self.file("large.txt", "1e101\n"), "allowed -1e100 to 1e100")):
            self.assertIn(got, self.evoctl("rate", wrong, "--island", "1", server=server, status=2))
        self.assertIn("--generation: got 2, allowed 1", self.evoctl("rate", numbers, "--island", "1", "--generation",
                                                                    "2",
                                                                    server=server, status=1))
        part = self.evoctl("rate", self.file("two.txt", "1\n2\n"), "--island", "1", server=server)
        self.assertIn("the island has more organisms", part)
        self.evoctl("rate", numbers, "--island", "1", server=server)
        last = plain.until(lambda: client.call(get_statistics=c.GetStatistics(world="rated")).statistics.last,
                           "its end")
        self.assertEqual([(s.fitness_best, s.best_organism) for s in last], [(3000, 2), (3000, 2)])
        self.waiting_world(client)

    def test_several_objectives_are_rated_by_lines(self):
        server, client = self.begin()
        client.call(create_world=c.CreateWorld(name="two", seed=1, parameters=plain.assignments(
            fitness="external", external_bodies=False, objectives=2, population_size=3)))
        client.call(run=c.Run(world="two", generations=1))
        plain.until(lambda: client.world("two").HasField("awaited_fitness"), "the end of the generation")
        for text, got in (("1 2\n3\n", "line 2: got 3, allowed 2 numbers, as in the first line"),
                          ("1 2 3\n", "2 numbers for each organism"), ("1;2\n", "line 1: got 1;2")):
            self.assertIn(got, self.evoctl("--world", "two", "rate", self.file("bad.txt", text), server=server,
                                           status=2))
        done = self.evoctl("--world", "two", "rate", self.file("rows.csv", "1, 2\n3,4\r\n5\t-6\n"), server=server)
        self.assertIn("rated 3 organisms", done)
        last = plain.until(lambda: client.call(get_statistics=c.GetStatistics(world="two")).statistics.last, "its end")
        self.assertEqual([(s.fitness_best, s.best_organism) for s in last], [(5, 2)])

    def test_commands_without_network_refuse_it_at_the_start(self):
        sweep = self.file("sweep.json", json.dumps({"experiment": SETTING, "grid": {"elite_count": [0, 1]},
                                                    "generations": 2}))
        for words, status in ((("run", self.experiment), 2), (("compare", self.experiment, "--controls"), 1),
                              (("sweep", sweep, "--out", f"{self.folder}/out"), 1)):
            self.assertIn("fitness: got external, allowed life, gene_sum or rastrigin", evod(*words, status=status))
        self.assertFalse(pathlib.Path(self.folder, "out").exists())


if __name__ == "__main__":
    unittest.main(argv=[sys.argv[0], *sys.argv[4:]])
