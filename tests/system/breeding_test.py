"""How generations were bred: GetBreeding and evoctl breeding, against the tables of the run's file. EVOD and EVOCTL
name the programs, MESSAGES the folder of the message classes."""
import csv
import io
import json
import sys
import unittest

import export_test
import waiting
from past_test import CREATE, EVOCTL, c, plain

NOT_FOUND, FAILED_PRECONDITION = 5, 9


def ask(**wanted):
    return c.GetBreeding(**{"world": "w", **wanted})


def genes_of(descendant):
    """What the record says became of the parents' genes."""
    share = descendant.second_share
    genes = [second if descendant.from_second >> gene & 1 else first
             for gene, (first, second) in enumerate(zip(descendant.first_genes, descendant.second_genes))]
    if share:
        genes = [float(plain.numpy.float32(first + share * (second - first)))
                 for first, second in zip(descendant.first_genes, descendant.second_genes)]
    if descendant.crossed_genes:
        genes = list(descendant.crossed_genes)
    if descendant.HasField("order_mutation"):
        genes = [genes[gene] for gene in descendant.order_mutation.order]
    for mutation in descendant.mutations:
        assert genes[mutation.gene] == mutation.before
        genes[mutation.gene] = mutation.after
    return genes


class Breeding(export_test.Runs):
    def breeding(self, client, **wanted):
        return client.call(get_breeding=ask(**wanted)).breeding

    def parameters(self, bred):
        return {p.name: getattr(p.value, p.value.WhichOneof("kind")) for p in bred.parameters}

    def organisms(self, *words):
        """Rows of the table by generation, island and organism."""
        rows = csv.DictReader(io.StringIO(self.evod_export("--what", "organisms", *words)))
        return {(int(r["generation"]), int(r["island"]), int(r["organism"])): r for r in rows}

    def check(self, bred, table):
        """A breeding says what the table of organisms says."""
        generation, island = bred.generation, bred.island
        self.assertEqual(len(bred.contenders), bred.contender_count)
        self.assertEqual(len(bred.picks), bred.pick_count)
        self.assertEqual(len(bred.descendants), bred.descendant_count)
        homes = []
        for organism, contender in enumerate(bred.contenders):
            home = (contender.migrant.island, contender.migrant.organism) if contender.HasField("migrant") else \
                (island, organism)
            homes.append(home)
            shuffled = self.parameters(bred)["shuffle_fitness"]
            self.assertEqual(contender.HasField("own_fitness"), shuffled)
            self.assertEqual(contender.own_fitness if shuffled else contender.fitness,
                             float(table[generation, *home]["fitness"]))
            self.assertEqual(contender.copies, sum(pick.organism == organism for pick in bred.picks))
            self.assertGreaterEqual(contender.expected_copies_error, 0)
            self.assertTrue(0 <= contender.unpicked_chance <= 1, contender.unpicked_chance)
            self.assertGreaterEqual(contender.expected_copies, 1 - contender.unpicked_chance - 1e-9)
        order = sorted(range(len(homes)), key=lambda i: (-bred.contenders[i].fitness, i))
        self.assertEqual([bred.contenders[organism].rank for organism in order], list(range(len(order))))
        self.assertAlmostEqual(sum(contender.expected_copies for contender in bred.contenders), bred.pick_count)
        names = list(table[generation, island, 0])[6:12]
        for number, descendant in enumerate(bred.descendants):
            row = table[generation + 1, island, number]
            self.assertEqual(descendant.id, number)
            self.assertEqual((descendant.first_parent, descendant.second_parent),
                             (int(row["parent_first"]), int(row["parent_second"])))
            kinds = {"elite": c.DESCENDANT_KIND_ELITE, "survivor": c.DESCENDANT_KIND_SURVIVOR,
                     "child": c.DESCENDANT_KIND_CHILD}
            self.assertEqual(descendant.kind, kinds[row["origin"]])
            self.assertEqual([plain.numpy.float32(row[name]) for name in names], list(descendant.genes))
            self.assertEqual(genes_of(descendant), list(descendant.genes))
            for genes, parent in ((descendant.first_genes, descendant.first_parent),
                                  (descendant.second_genes, descendant.second_parent)):
                of_parent = table[generation, *homes[parent]]
                self.assertEqual([plain.numpy.float32(of_parent[name]) for name in names], list(genes))
        for pick in bred.picks:
            if pick.HasField("turns"):
                self.assertLessEqual(bred.contenders[pick.organism].slot_begin, pick.turns + 1e-12)
                self.assertGreaterEqual(bred.contenders[pick.organism].slot_end, pick.turns - 1e-12)
            if pick.contestants:
                best = min(pick.contestants, key=lambda contestant: bred.contenders[contestant].rank)
                self.assertEqual(best, pick.organism)

    def test_every_generation_agrees_with_the_tables(self):
        server, client = self.serve()
        self.run_world(client, 5, mutate_survivors=True, elite_count=1, rearranging="swap", rearrange_chance=0.5,
                       bit_flip_chance=0.02, crossover_chance=0.7)
        reported = {(generation, island): self.breeding(client, generation=generation, island=island)
                for generation in range(1, 5) for island in range(2)}
        table = self.organisms()
        for bred in reported.values():
            self.check(bred, table)
        migrants = {key for key, bred in reported.items() for contender in bred.contenders
                    if contender.HasField("migrant")}
        self.assertEqual(migrants, {(generation, island) for generation in (2, 4) for island in range(2)})
        self.assertEqual(self.breeding(client, island=1), reported[4, 1])

        # The same of the past, where the last is the one before what is shown; and of a file that is served again.
        replay = client.call(open_replay=c.OpenReplay(world="w", at=c.RunMoment(generation=3))).world.name
        self.assertEqual(self.breeding(client, world=replay), reported[2, 0])
        self.assertEqual(self.breeding(client, world=replay, generation=4), reported[4, 0])
        server.end()
        replayed = self.client(self.server("replay", f"{self.folder}/w.evod"))
        self.assertEqual(self.breeding(replayed, generation=1, island=1), reported[1, 1])

    def test_shuffled_fitness_is_what_the_selection_used(self):
        server, client = self.serve()
        self.run_world(client, 5, shuffle_fitness=True, elite_count=2)
        reported = {(generation, island): self.breeding(client, generation=generation, island=island)
                for generation in range(1, 5) for island in range(2)}
        table = self.organisms()
        for (generation, island), bred in reported.items():
            self.check(bred, table)
            if generation % 2:  # no migration: the island's own fitness, permuted
                self.assertEqual(sorted(contender.fitness for contender in bred.contenders),
                                 sorted(contender.own_fitness for contender in bred.contenders))
            self.assertNotEqual([contender.fitness for contender in bred.contenders],
                                [contender.own_fitness for contender in bred.contenders])
        text = waiting.run([EVOCTL, "--server", f"localhost:{server.port}", *waiting.PATIENT, "--world", "w",
                            "breeding"],
                           capture_output=True, text=True).stdout
        self.assertRegex(text, r"ORGANISM +OWN FITNESS +SHUFFLED +RANK")
        self.assertIn("shuffle_fitness=true", text)

    def test_spread_genes_can_be_computed_from_the_record(self):
        _, client = self.serve()
        self.run_world(client, 4, crossover="simulated_binary", creep="polynomial", scale_chance=1.0, scale_range=1.0,
                       out_of_bounds="reflect")
        reported = [self.breeding(client, generation=generation, island=1) for generation in range(1, 4)]
        table = self.organisms()
        for bred in reported:
            self.check(bred, table)
        children = [descendant for bred in reported for descendant in bred.descendants[bred.survivor_count:]]
        self.assertTrue(any(gene not in (first, second) for child in children for gene, first, second in
                            zip(child.crossed_genes, child.first_genes, child.second_genes)))
        kinds = {mutation.kind for child in children for mutation in child.mutations}
        self.assertEqual(kinds, {c.MUTATION_KIND_CREEP, c.MUTATION_KIND_SCALE, c.MUTATION_KIND_REFLECT})

    def test_blended_genes_can_be_computed_from_the_record(self):
        server, client = self.serve()
        self.run_world(client, 4, crossover="blend", crossover_chance=0.5, mutate_survivors=True,
                       fitness_per_second=0.0, fitness_per_food=10.0, fitness_per_poison=-5.0, scale_chance=0.5)
        reported = [self.breeding(client, generation=generation, island=1) for generation in range(1, 4)]
        table = self.organisms()
        for bred in reported:
            self.check(bred, table)
        children = [descendant for bred in reported for descendant in bred.descendants[bred.survivor_count:]]
        self.assertTrue(all(child.crossed == (0 < child.second_share < 0.5) for child in children))
        self.assertEqual({child.crossed for child in children}, {True, False})
        scaled = [mutation for bred in reported for descendant in bred.descendants for mutation in descendant.mutations
                  if mutation.kind == c.MUTATION_KIND_SCALE]
        self.assertTrue(scaled)
        self.assertTrue(all(0.9 - 1e-6 <= mutation.after / mutation.before <= 1.1 + 1e-6 for mutation in scaled))
        text = "".join(waiting.run([EVOCTL, "--server", f"localhost:{server.port}", *waiting.PATIENT, "--world", "w",
                                    "breeding", "--generation", str(generation), "--island", "1", "--rows", "12"],
                                   capture_output=True, text=True).stdout for generation in range(1, 4))
        self.assertRegex(text, r" → \d+\.\d\d scale")
        self.assertRegex(text, r"child +\d+, \d+ +0\.\d{3} of 1 \+ 0\.\d{3} of 2 ")

    def test_a_running_world_reports_the_latest_breeding(self):
        _, client = self.serve()
        self.run_world(client, 2)
        client.call(run=c.Run(world="w"))
        for _ in range(20):
            generation = client.world("w").generation
            self.assertGreaterEqual(self.breeding(client).generation, generation - 1)
        client.call(pause=c.Pause(world="w"))
        self.assertEqual(self.breeding(client).generation, client.world("w").generation - 1)

    def test_purged_generations_are_simulated_again(self):
        _, client = self.serve("--keep-every", "10")
        self.run_world(client, 24, fitness="gene_sum")
        reported = [self.breeding(client, generation=generation, island=1) for generation in (1, 9, 10, 14, 23)]
        table = self.organisms()  # after what was reported, which waits for the file
        for bred in reported:
            self.check(bred, table)

    def test_many_rows_come_in_parts(self):
        _, client = self.serve()
        self.run_world(client, 2, fitness="gene_sum", population_size=1500, island_count=1)
        first = self.breeding(client)
        self.assertEqual((len(first.contenders), len(first.picks), len(first.descendants)), (1000, 750, 1000))
        rest = self.breeding(client, first_contender=1000, first_pick=700, first_descendant=1000)
        self.assertEqual((len(rest.contenders), len(rest.picks), len(rest.descendants)), (500, 50, 500))
        self.assertEqual(list(rest.picks), list(first.picks)[700:])
        self.assertEqual(sum(contender.copies for bred in (first, rest) for contender in bred.contenders), 750)
        first.MergeFrom(c.Breeding(contenders=rest.contenders, descendants=rest.descendants))
        self.check(first, self.organisms())
        beyond = self.breeding(client, first_contender=2**32 - 1, first_pick=1500, first_descendant=1500)
        self.assertEqual((len(beyond.contenders), len(beyond.picks), len(beyond.descendants)), (0, 0, 0))
        self.assertEqual(client.welcome.limits.breeding_rows_max, 1000)

    def test_simultaneous_queries_are_all_answered(self):
        server, client = self.serve()
        self.run_world(client, 4)
        expected = self.breeding(client)
        gone = self.client(server)
        for _ in range(8):
            gone.ask(get_breeding=ask())
        gone.socket.close()
        others = [self.client(server) for _ in range(6)]
        asked = [(other, other.ask(get_breeding=ask())) for other in others for _ in range(8)]
        for other, request_id in asked:
            while request_id not in other.responses:
                other.step()
            self.assertEqual(other.responses[request_id].breeding, expected)

    def test_invalid_requests_name_the_field(self):
        _, client = self.serve()
        client.call(create_world=c.CreateWorld(name="w", seed=5, parameters=plain.assignments(**CREATE)))
        client.call(FAILED_PRECONDITION, get_breeding=ask())
        client.call(FAILED_PRECONDITION, get_breeding=ask(generation=1))
        client.run_to(250, "w")
        for field, allowed, wanted in (("generation", "1 to 2", {"generation": 0}),
                                       ("generation", "1 to 2", {"generation": 3}),
                                       ("island", "0 to 1", {"island": 2}), ("world", None, {"world": "nowhere"})):
            status = client.call(NOT_FOUND, get_breeding=ask(**wanted)).status
            self.assertEqual([violation.field for violation in status.violations], ["get_breeding." + field])
            self.assertIn(allowed, (None, status.violations[0].allowed))

    def test_a_server_without_recording_refuses(self):
        client = self.client(self.server("--keep-nothing"))
        status = client.call(FAILED_PRECONDITION, get_breeding=c.GetBreeding()).status
        self.assertIn("--keep-nothing", status.message)

    def test_evoctl_prints_text_and_json(self):
        server, client = self.serve()
        self.run_world(client, 3, selection="tournament")

        def evoctl(*words, status=0):
            done = waiting.run([EVOCTL, "--server", f"localhost:{server.port}", *waiting.PATIENT, "--world", "w",
                                *words],
                               capture_output=True, text=True)
            self.assertEqual(done.returncode, status, done.stdout + done.stderr)
            return done.stderr if status else done.stdout

        bred = self.breeding(client, island=1)
        text = evoctl("breeding", "--island", "1", "--rows", "12")
        self.assertIn("generation 2 of island 1: 12 organisms, 6 picks; the next generation: 0 elite, 6 other "
                      "survivors, "
                      "6 children", text)
        self.assertIn("selection=tournament", text)
        for pick in bred.picks:
            self.assertIn(f"won tournament {pick.tournament} of {', '.join(map(str, pick.contestants))}\n", text)
        for child in bred.descendants[6:]:
            self.assertRegex(text, rf"\n *{child.id}  child +{child.first_parent}, {child.second_parent} ")
        self.assertEqual(evoctl("breeding", "--rows", "4", "--from", "3").count("more: --from 7"), 2)  # not of 6 picks
        self.assertNotIn("OWN FITNESS", text)
        reported = json.loads(evoctl("--json", "breeding", "--generation", "1"))
        self.assertEqual(len(reported["descendants"]), 12)
        self.assertEqual(reported["descendants"][7]["first_parent"],
                         self.breeding(client, generation=1).descendants[7].first_parent)
        self.assertIn("allowed 1 to 2", evoctl("breeding", "--generation", "9", status=1))
        self.assertIn("--rows", evoctl("breeding", "--rows", "0", status=2))


if __name__ == "__main__":
    unittest.main(argv=[sys.argv[0], *sys.argv[4:]])
