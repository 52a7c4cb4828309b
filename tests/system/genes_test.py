"""Chromosomes of more than six genes as a user meets them: their names, and population files. EVOD and EVOCTL
name the programs, MESSAGES the folder of the message classes."""
import csv
import io
import json
import pathlib
import struct
import sys
import unittest

import access_test as access
import waiting
from access_test import EVOD, c, plain

w = plain.w
SMALL = {"population_size": 12, "generation_s": 2, "island_count": 2, "migration": "ring", "migration_epoch": 2}
WORLDS = {
    "free": {**SMALL, "free_genes": 10, "mutate_group": "free"},
    "net": {**SMALL, "controller": "network", "sense_speed": True, "sense_health": True, "sense_wall": True,
            "brain_hidden": 32},
}
GENES = {"free": 16, "net": 328}


def evod(*words, status=0):
    done = waiting.run([EVOD, *map(str, words)], capture_output=True, text=True)
    assert done.returncode == status, f"{words}\n{done.stdout}\n{done.stderr}"
    return done.stdout + done.stderr


def rows_of(text):
    return list(csv.DictReader(io.StringIO(text)))


class Genes(access.Access):
    def file(self, name, content):
        path = pathlib.Path(self.folder, name)
        path.write_text(content if isinstance(content, str) else json.dumps(content))
        return str(path)

    def begin(self):
        """A server with both worlds after 250 ticks: two generations of two seconds, and a migration."""
        server = self.serve("--speed", "max")
        client = self.come(server)
        for name, setting in WORLDS.items():
            self.evoctl("create", name, "--seed", "7", "--experiment", self.file(f"{name}.json", setting),
                        server=server)
            client.call(set_speed=c.SetSpeed(world=name, speed=w.Speed(max=True)))
            client.run_to(250, name)
        return server, client

    def test_names_and_groups_are_those_of_the_world(self):
        _, client = self.begin()
        for name, count in GENES.items():
            info = client.world(name)
            self.assertEqual((len(info.gene_names), len(info.gene_groups)), (count, count))
            self.assertEqual(set(info.gene_groups[:6]), {w.GENE_GROUP_BODY})
            beyond = w.GENE_GROUP_FREE if name == "free" else w.GENE_GROUP_BRAIN
            self.assertEqual(set(info.gene_groups[6:]), {beyond})
        self.assertEqual(client.world("free").gene_names[-1], "free9")
        self.assertEqual(client.world("net").gene_names[6], "hidden1<food_bearing")
        self.assertEqual(client.world("net").gene_names[-1], "turn<bias")

    def test_a_population_moves_between_worlds_by_file(self):
        server, client = self.begin()
        for name, setting in WORLDS.items():
            path = f"{self.folder}/{name}.csv"
            self.evoctl("--world", name, "export", "--what", "population", "--generation", "2", "--output", path,
                        server=server)
            self.evoctl("create", f"{name}-copy", "--population", path, "--experiment", f"{self.folder}/{name}.json",
                        server=server)
            copied = client.call(get_population=c.GetPopulation(world=f"{name}-copy", island=1)).population
            original = rows_of(pathlib.Path(path).read_text())
            genes = memoryview(copied.genes).cast("f")
            for row in range(12):
                for column, gene in enumerate(client.world(name).gene_names):
                    self.assertEqual(genes[column * 12 + row],
                                     memoryview(struct.pack("f", float(original[12 + row][gene]))).cast("f")[0])
        text = pathlib.Path(self.folder, "free.csv").read_text()
        for content, there, expected in ((text, "[6]: got the gene free0", "allowed no gene"),
                                         (text.replace("free3", "free33"), "[9]: got the gene free33",
                                          "allowed the gene free3")):
            path = self.file("other.csv", content)
            setting = "free.json" if "free33" in content else "default.json"
            self.file("default.json", SMALL)
            for said in (evod("run", f"{self.folder}/{setting}", "--population", path, "--generations", 1, status=1),
                         self.evoctl("create", "wrong", "--population", path, "--experiment",
                                     f"{self.folder}/{setting}",
                                     server=server, status=2)):
                self.assertIn(there, said)
                self.assertIn(expected, said)


if __name__ == "__main__":
    unittest.main(argv=[sys.argv[0], *sys.argv[4:]], verbosity=1)
