"""Chromosomes of more than six genes as a user meets them: kills, forks, replays, tables, population files, sweeps and
refusals. EVOD and EVOCTL name the programs, MESSAGES the folder of the message classes."""
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
INVALID = 3


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

    def test_a_killed_server_continues_exactly(self):
        server, client = self.begin()
        for name in WORLDS:
            client.call(set_parameters=plain.set_parameters(name, crossover="blend", reset_chance=0.02))
        hashes = {name: client.world(name).state_hash for name in WORLDS}
        server.process.kill()
        waiting.ended(server.process)

        server = self.serve("--speed", "max", "--threads", "3")
        client = self.come(server)
        for name in WORLDS:
            self.assertEqual(client.world(name).state_hash, hashes[name])
            client.call(fork_world=c.ForkWorld(world=name, name=f"{name}-now"))
            client.call(fork_world=c.ForkWorld(world=name, name=f"{name}-before", at_generation=2))
            later = client.run_to(500, name).state_hash
            client.call(set_speed=c.SetSpeed(world=f"{name}-now", speed=w.Speed(max=True)))
            self.assertEqual(client.run_to(500, f"{name}-now").state_hash, later)
            client.run_to(130, f"{name}-before")
            replay = client.call(open_replay=c.OpenReplay(world=name, at=c.RunMoment(tick=250))).world
            self.assertEqual(client.wait_world(lambda world: world.tick == 250, replay.name).state_hash, hashes[name])
            bred = client.call(get_breeding=c.GetBreeding(world=name, generation=4)).breeding
            self.assertEqual(len(bred.descendants[-1].genes), GENES[name])
        server.process.terminate()
        self.assertEqual(waiting.ended(server.process), 0)
        for name in WORLDS:
            for run in (name, f"{name}-now", f"{name}-before"):
                self.assertIn("everything agrees", evod("verify", f"{self.folder}/{run}.evod"))

    def test_tables_and_bundles_contain_every_gene(self):
        server, client = self.begin()
        names = {name: list(client.world(name).gene_names) for name in WORLDS}
        server.process.terminate()
        self.assertEqual(waiting.ended(server.process), 0)
        for name in WORLDS:
            run = f"{self.folder}/{name}.evod"
            population = rows_of(evod("export", run, "--what", "population", "--generation", 1))
            self.assertEqual(list(population[0]), ["island", "organism", *names[name]])
            statistics = rows_of(evod("export", run, "--what", "generations"))
            for gene in names[name]:
                mean = sum(float(row[gene]) for row in population[:12]) / 12
                self.assertAlmostEqual(float(statistics[0][f"{gene}_mean"]), mean, places=3)
                parts = [float(statistics[2][f"{gene}_{part}"])
                         for part in ("selection", "transmission", "migration", "change")]
                self.assertAlmostEqual(sum(parts[:3]), parts[3], delta=1e-9 * max(1, *map(abs, parts)))
            bundle = pathlib.Path(self.folder, f"{name}-bundle")
            evod("export", run, "--bundle", bundle)
            self.assertEqual(rows_of((bundle / "generations.csv").read_text()), statistics)
            experiment = json.loads((bundle / "experiment.json").read_text())
            self.assertEqual({key: experiment[key] for key in WORLDS[name]}, WORLDS[name])

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

    def test_a_sweep_varies_the_number_of_genes(self):
        sweep = self.file("sweep.json", {"experiment": {**SMALL, "fitness": "gene_sum"},
                                         "grid": {"free_genes": [0, 10]},
                                         "replicates": 2, "seed": 7, "generations": 3})
        evod("sweep", sweep, "--out", f"{self.folder}/out")
        table = pathlib.Path(self.folder, "out/runs.csv").read_text()
        rows = rows_of("\n".join(line for line in table.splitlines() if not line.startswith("#")))
        self.assertEqual(len(rows), 2 * 2 * 3 * 2)
        self.assertEqual({row["free_genes"] for row in rows}, {"0", "10"})

    def test_wrong_genes_are_refused_by_name(self):
        server, client = self.begin()
        for words, field, allowed in (
            (("free_genes=1001",), "free_genes: got 1001", "0 to 1000"),
            (("mutate_group=brain",), "mutate_group: got brain", "all, body"),
            (("free_gene_min=3",), "free_gene_max: got 1", "at least free_gene_min (3)"),
            (("controller=network", "sense_food=false", "sense_poison=false"), "a network without inputs",
             "at least one sense"),
            (("controller=network", "brain_hidden=33"), "brain_hidden: got 33", "1 to 32"),
            (("fitness=gene_sum", "population_size=200000", "free_genes=700"), "free_genes: got 200000 organisms",
             "124000000"),
        ):
            said = self.evoctl("create", "wrong", "--set", *words, server=server, status=2)
            self.assertIn(field, said)
            self.assertIn(allowed, said)
        said = self.evoctl("set", "--world", "free", "mutate_group=brain", server=server, status=2)
        self.assertIn("all, body, free; their number changes at a reset", said)
        refused = client.call(INVALID, create_world=c.CreateWorld(
            name="wrong", parameters=plain.assignments(**WORLDS["free"]),
            population=[population_of(6), population_of(6)])).status
        self.assertRegex(" ".join(f"{v.field} {v.got} {v.allowed}" for v in refused.violations),
                         r"population.*(72|6).*(192|16)")
        refused = client.call(INVALID, place=c.Place(world="free", organisms=[
            c.PlacedOrganism(x_px=100, y_px=100, genes=[100] * 6)])).status
        self.assertRegex(" ".join(f"{v.field} {v.got} {v.allowed}" for v in refused.violations), r"genes.*6.*16")


def population_of(genes):
    return c.IslandPopulation(genes=[100] * genes * 12)


if __name__ == "__main__":
    unittest.main(argv=[sys.argv[0], *sys.argv[4:]], verbosity=1)
