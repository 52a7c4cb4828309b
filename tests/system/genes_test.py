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
from access_test import EVOCTL, EVOD, c, plain

w = plain.w
SMALL = {"population_size": 12, "generation_s": 2, "island_count": 2, "migration": "ring", "migration_epoch": 2}
MATERIALS = ["steel", "wood, oak", "1"]
LIST = [{"name": "angle", "min": -90, "max": 90}, {"name": "rate", "min": 0.001, "max": 1, "scale": "logarithmic"},
        {"name": "layers", "min": 1, "max": 8, "step": 1}, {"name": "material", "choices": MATERIALS},
        {"name": "tour", "permutation": 6}]
WORLDS = {
    "list": {**SMALL, "free_genes": LIST, "rearranging": "inversion", "rearrange_chance": 0.5,
             "crossover": "simulated_binary", "free_gene_start": "latin_hypercube"},
    "free": {**SMALL, "free_genes": 10, "mutate_group": "free"},
    "net": {**SMALL, "controller": "network", "sense_speed": True, "sense_health": True, "sense_wall": True,
            "brain_hidden": 32},
}
GENES = {"list": 16, "free": 16, "net": 328}
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
            beyond = w.GENE_GROUP_BRAIN if name == "net" else w.GENE_GROUP_FREE
            self.assertEqual(set(info.gene_groups[6:]), {beyond})
        self.assertEqual(client.world("free").gene_names[-1], "free9")
        self.assertEqual(list(client.world("list").gene_names[6:]),
                         ["angle", "rate", "layers", "material", *(f"tour{i}" for i in range(6))])
        listed = client.world("list").free_genes.genes
        self.assertEqual([gene.name for gene in listed], [gene["name"] for gene in LIST])
        self.assertEqual(list(listed[3].choices), LIST[3]["choices"])
        self.assertFalse(client.world("free").HasField("free_genes"))
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
                    text = original[12 + row][gene]
                    value = MATERIALS.index(text) if gene == "material" else float(text)
                    self.assertEqual(genes[column * 12 + row], memoryview(struct.pack("f", value)).cast("f")[0])
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

    def check_listed(self, rows):
        """Every gene of the rows of a table has one of its values."""
        for row in rows:
            self.assertTrue(-90 <= float(row["angle"]) <= 90)
            self.assertTrue(0.000999 <= float(row["rate"]) <= 1)
            self.assertIn(float(row["layers"]), range(1, 9))
            self.assertIn(row["material"], MATERIALS)
            self.assertEqual(sorted(float(row[f"tour{i}"]) for i in range(6)), list(range(6)))

    def test_people_read_the_text_of_a_choice(self):
        server, client = self.begin()
        path = f"{self.folder}/organisms.jsonl"
        self.evoctl("--world", "list", "export", "--what", "organisms", "--format", "jsonl", "--output", path,
                    server=server)
        lines = [json.loads(line) for line in pathlib.Path(path).read_text().splitlines()]
        self.check_listed(lines)
        organism = next(row for row in lines if row["generation"] == 2 and row["material"] == "wood, oak")
        shown = self.evoctl("--world", "list", "organism", str(organism["organism"]), "--island",
                            str(organism["island"]), "--at-generation", "2", server=server)
        self.assertRegex(shown, "material +wood, oak\n")
        self.assertRegex(self.evoctl("--world", "list", "best", server=server), "material +(steel|wood, oak|1)\n")
        for text, there in (("wood, oak", "created"), ("0", "created"),
                            ("gelu", "one of steel, wood, oak, 1 (column mat")):
            names = list(client.world("list").gene_names)
            row = [str(organism[name]) if name != "material" else f'"{text}"' for name in names]
            population = self.file("one.csv", f"island,organism,{','.join(names)}\n0,0,{','.join(row)}\n")
            said = self.evoctl("create", f"one{len(text)}", "--population", population, "--experiment",
                               f"{self.folder}/list.json", server=server, status=2 if text == "gelu" else 0)
            self.assertIn(there, said)
            said = evod("run", f"{self.folder}/list.json", "--population", population, "--generations", 1,
                        status=text == "gelu")
            self.assertIn(there if text == "gelu" else "", said)

    def test_history_without_bodies_is_not_about_life(self):
        server = self.serve("--speed", "max")
        experiment = self.file("rated.json", {"fitness": "external", "external_bodies": False, "population_size": 2})
        self.evoctl("create", "rated", "--experiment", experiment, server=server)
        self.come(server).call(run=c.Run(world="rated", generations=1))
        rate = [EVOCTL, "--server", f"localhost:{server.port}", "--world", "rated", "rate",
                self.file("fitness.txt", "1\n2\n")]
        waiting.until(lambda: waiting.run(rate, capture_output=True).returncode == 0, "the end of generation 1")
        for words in ("history",), ("stats",):
            said = self.evoctl("--world", "rated", *words, server=server)
            self.assertIn("BEST", said)
            table = said[said.index("GENERATION"):]
            self.assertNotIn("ALIVE", table)
            self.assertNotIn("STARVED", table)

    def test_listed_genes_keep_to_their_values(self):
        server, client = self.begin()
        client.call(set_parameters=plain.set_parameters("list", mutation_chance=0.5, reset_chance=0.1,
                                                        bit_flip_chance=0.05))
        client.run_to(1000, "list")
        server.process.terminate()
        self.assertEqual(waiting.ended(server.process), 0)
        rows = rows_of(evod("export", f"{self.folder}/list.evod", "--what", "organisms"))
        self.assertGreater(len(rows), 100)
        self.check_listed(rows)
        for gene in "angle", "rate", "layers", "material", "tour3":
            self.assertGreater(len({row[gene] for row in rows}), 2, gene)

    def test_a_reset_replaces_and_removes_the_list(self):
        server, client = self.begin()
        two = w.FreeGeneList(genes=[w.FreeGene(name="x", min=0, max=3, step=1),
                                    w.FreeGene(name="y", choices=["a", "b"])])
        client.call(reset_world=c.ResetWorld(world="list", free_genes=two))
        self.assertEqual(list(client.world("list").gene_names[6:]), ["x", "y"])
        client.call(reset_world=c.ResetWorld(world="list"))
        self.assertEqual(client.world("list").free_genes, two)
        client.run_to(250, "list")
        before = client.world("list").state_hash
        server.process.kill()
        waiting.ended(server.process)
        server = self.serve("--speed", "max")
        client = self.come(server)
        again = client.wait_world(lambda info: info.tick == 250, "list")  # the server goes on to the goal of the world
        self.assertEqual(again.free_genes, two)
        self.assertEqual(again.state_hash, before)
        refused = client.call(INVALID, set_parameters=plain.set_parameters("list", free_genes=3)).status
        self.assertIn("2, the number of genes in the list", refused.violations[0].allowed)
        wrong = w.FreeGeneList(genes=[w.FreeGene(name="x", min=0, max=20_000_000, step=1)])
        refused = client.call(INVALID, reset_world=c.ResetWorld(world="list", free_genes=wrong)).status
        self.assertEqual(refused.violations[0].field, "reset_world.free_genes[0].max")
        client.call(reset_world=c.ResetWorld(world="list", free_genes=w.FreeGeneList()))
        self.assertEqual(list(client.world("list").gene_names[6:]), ["free0", "free1"])
        self.assertFalse(client.world("list").HasField("free_genes"))

    def test_founders_with_values_that_no_gene_has_are_refused(self):
        row = {"angle": 1, "rate": 0.5, "layers": 3, "material": 2, **{f"tour{i}": i for i in range(6)}}
        body = ["normal_speed", "impulse", "body_size", "base_health", "food_radius", "poison_radius"]
        setting = self.file("list.json", {**WORLDS["list"], "island_count": 1, "migration": "none",
                                          "population_size": 1})
        for change, said in (({}, None), ({"layers": 2.5}, "layers: got 2.5"), ({"material": 3}, "material: got 3"),
                             ({"tour5": 0}, "tour5: got 0")):
            values = {"island": 0, "organism": 0, **dict.fromkeys(body, 100), **row, **change}
            path = self.file("one.csv", ",".join(values) + "\n" + ",".join(map(str, values.values())) + "\n")
            output = evod("run", setting, "--population", path, "--generations", 1, status=1 if said else 0)
            self.assertIn(said or "", output)


if __name__ == "__main__":
    unittest.main(argv=[sys.argv[0], *sys.argv[4:]], verbosity=1)
