"""Saved at random ticks and loaded by another process with another number of threads, worlds live on as those that were
never stopped.

    EVOD=… EVOCTL=… MESSAGES=… save_and_load_test.py      ROUNDS (1) of 50 ticks each, drawn from SEED (1)
"""
import os
import pathlib
import random
import sqlite3
import unittest

import past_test as past
from past_test import c, plain, w

SEED, ROUNDS = int(os.environ.get("SEED", "1")), int(os.environ.get("ROUNDS", "1"))
FORKS = (2, 3)  # of each world in a round, after one change of its parameters and after another
TICKS_AFTER = 1000
THREADS = ((1, 3), (3, 1), (2, 5), (4, 2))  # of the server that saves and of the one that loads, round by round

WORLDS = {
    "plain": {},
    "islands": {"island_count": 4, "migration": "ring", "migration_epoch": 1},
    "crates": {"crate_count": 12, "obstacle_count": 5, "restitution": 1.0},
    "scarce": {"respawn": False, "food_count": 60, "poison_count": 10},
    "slow_to_grow": {"respawn_s": 3.5, "food_count": 40, "health_loss_per_s": 12.0},
    "steady_state": {"population_model": "steady_state", "selection": "tournament", "elite_count": 1},
    "generational": {"population_model": "generational", "fitness_scaling": "linear_ranking",
                     "crossover": "multi_point"},
    "integrated": {"integrator": "backward_euler", "tick_s": 0.01, "flee_rule": "always"},
    "crowd": {"population_size": 300, "scale_with_population": True, "reference_population": 50, "island_count": 2},
    "genes_alone": {"fitness": "rastrigin", "island_count": 3, "migration": "random"},
}


class SaveAndLoad(past.Case):
    def story(self, chance):
        """At which ticks the parameters of a world change, and at which it is forked: no change comes as long as a fork
        is to be as the world is."""
        tick, changes, forks = 0, [], []
        for count in FORKS:
            tick += chance.randrange(700)
            changes.append(tick)
            forks += sorted(chance.sample(range(tick, tick + 1500), count))
            tick = forks[-1] + TICKS_AFTER
        return changes, forks

    def save(self, client, name, chance):
        """Runs a world and saves it now and then. Returns by name of the copy: its tick, its hash, and its later
        hash."""
        sizes = {"population_size": chance.randrange(5, 60), "generation_s": chance.choice([0.5, 2.0, 9.0, 40.0])}
        client.call(create_world=c.CreateWorld(name=name, seed=chance.randrange(1 << 32),
                                               parameters=plain.assignments(**{**sizes, **WORLDS[name]})))
        client.call(set_speed=c.SetSpeed(world=name, speed=w.Speed(max=True)))
        changes, forks = self.story(chance)
        hashes = {}
        for tick in sorted({*changes, *forks, *(fork + TICKS_AFTER for fork in forks)}):
            now = client.run_to(tick, name) if tick else client.world(name)
            hashes[tick] = now.state_hash
            if tick in changes:
                client.call(set_parameters=plain.set_parameters(
                    name, food_health=chance.uniform(1, 60), mutation_chance=chance.random(),
                    damping=chance.uniform(0.9, 1), **({"force_per_unit": 3.0} if chance.random() < 0.5 else {})))
            if tick in forks:
                saved = client.call(fork_world=c.ForkWorld(world=name, name=f"{name}-{tick}")).world
                self.assertEqual((saved.tick, saved.state_hash), (tick, now.state_hash), saved.name)
        client.call(pause=c.Pause(world=name))  # once that is answered, all that came before is in the file
        return {f"{name}-{tick}": (tick, hashes[tick], hashes[tick + TICKS_AFTER]) for tick in forks}

    def load(self, client, saved):
        for name, (tick, now, _) in saved.items():
            there = client.world(name)
            self.assertEqual((there.tick, there.state_hash), (tick, now), name)
            client.call(set_speed=c.SetSpeed(world=name, speed=w.Speed(max=True)))
            client.call(run_until_tick=c.RunUntilTick(world=name, tick=tick + TICKS_AFTER))
        for name, (tick, _, later) in saved.items():
            there = client.wait_world(lambda x: x.tick == tick + TICKS_AFTER, name)
            self.assertEqual(there.state_hash, later, f"{name} after {TICKS_AFTER} ticks")

    def rows(self, name, columns):
        with sqlite3.connect(f"file:{self.folder}/{name}.evod?mode=ro", uri=True) as run:
            return set(run.execute(f"SELECT {columns}"))

    def test_a_world_loaded_on_other_threads_continues_exactly(self):
        chance, count = random.Random(SEED), 0
        for number in range(ROUNDS):
            for file in pathlib.Path(self.folder).iterdir():
                file.unlink()
            saving_threads, loading_threads = THREADS[number % len(THREADS)]
            saving = self.server("--data", self.folder, "--threads", str(saving_threads))
            client, saved = self.client(saving), {}
            for kind in WORLDS:
                saved.update(self.save(client, kind, chance))
            saving.kill()
            loading = self.server("--data", self.folder, "--threads", str(loading_threads))
            self.load(self.client(loading), saved)
            loading.end()
            for name, (tick, _, _) in saved.items():
                begins_with = self.rows(name, f"tick FROM checkpoint WHERE tick = {tick}")
                self.assertEqual(begins_with, {(tick,)} if tick > 0 else set(), name)
                hashes = f"tick, low, high FROM state_hash WHERE tick > {tick} AND tick <= {tick + TICKS_AFTER}"
                self.assertEqual(self.rows(name, hashes), self.rows(name.split("-")[0], hashes), name)
                count += 1
        print(f"seed {SEED}: saved and loaded {count} times", flush=True)
        self.assertEqual(count, sum(FORKS) * len(WORLDS) * ROUNDS)


if __name__ == "__main__":
    print("seed", SEED, flush=True)
    unittest.main(argv=[os.path.basename(__file__), *past.sys.argv[4:]])
