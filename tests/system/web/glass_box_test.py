"""The glass box of the page against evod: what it computes from a breeding is what the server did.

EVOD names the program, MESSAGES the folder of the message classes. Needs node, esbuild and protoc.
"""
import pathlib
import subprocess
import sys
import unittest

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1]))
import export_test  # noqa: E402
from past_test import c, plain, w  # noqa: E402

CHECK = pathlib.Path(__file__).with_name("glass_box_check.mjs")
SELECTIONS = ("roulette", "stochastic_universal", "tournament", "random", "truncation")
SCALINGS = ("none", "windowing", "linear_ranking", "exponential_ranking")
OPERATORS = dict(rearrange_chance=0.7, crossover_chance=0.8, population_model="generational", tournament_winners=2,
                 selection="tournament", elite_count=3, mutation_step=60.0, reset_chance=0.1, bit_flip_chance=0.02)


class GlassBox(export_test.Runs):
    def check(self, *changes):
        """Breeds a generation with each of these changes of parameters, and checks what the page makes of it."""
        _, client = self.serve()
        self.run_world(client, 1, population_size=40)
        files = []
        for generation, change in enumerate(changes, 1):
            client.call(set_parameters=plain.set_parameters("w", **change))
            client.call(run=c.Run(world="w", generations=1))
            plain.until(lambda: client.world("w").generation == generation + 1 and
                        client.world("w").state == w.RUN_STATE_WAITING, "a generation")
            files.append(f"{self.folder}/{generation}")
            bred = client.call(get_breeding=c.GetBreeding(world="w", generation=generation)).breeding
            self.assertEqual(len(bred.contenders), 40)
            pathlib.Path(files[-1]).write_bytes(bred.SerializeToString())
        subprocess.run(["node", CHECK, *files], check=True)

    def test_every_selection_matches_the_server(self):
        self.check(*(dict(selection=selection) for selection in SELECTIONS))

    def test_every_scaling_matches_the_server(self):
        self.check(*(dict(fitness_scaling=scaling) for scaling in SCALINGS))

    def test_every_operator_reproduces_the_genes(self):
        self.check(*(dict(OPERATORS, rearranging=rearranging, crossover=crossover)
                     for rearranging in ("swap", "scramble", "inversion")
                     for crossover in ("single_point", "multi_point", "blend")))


if __name__ == "__main__":
    unittest.main(argv=[sys.argv[0], *sys.argv[4:]])
