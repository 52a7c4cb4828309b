"""Random histories of real servers: whatever stops a server, its worlds equal those of a server that was never stopped.
EVOD and EVOCTL name the programs, MESSAGES the folder of the message classes. tests/histories plays many more, in one
process.

    histories_test.py      HISTORIES (6) histories, the first with the seed HISTORIES_SEED (1); MPIRUN: some servers
                           share their worlds between two processes
"""
import os
import random
import unittest

import mpi_server_test as mpi
import past_test as past
from past_test import c, plain, w

FIRST, COUNT = int(os.environ.get("HISTORIES_SEED", "1")), int(os.environ.get("HISTORIES", "6"))
ACTIONS = 50
WORLDS_MAX = 4
VALUES = {  # of parameters that change while a world runs
    "food_health": (0.0, 60.0), "poison_harm": (0.0, 60.0), "mutation_chance": (0.0, 1.0), "population_size": (1, 30),
    "generation_s": (0.3, 1.5), "damping": (0.9, 1.0), "food_count": (0, 30), "elite_count": (0, 40),
          "crate_count": (0, 3),
}
KINDS = ({}, {"controller": "network"}, {"island_count": 3, "migration": "ring", "migration_epoch": 1},
         {"fitness": "rastrigin", "island_count": 2}, {"free_genes": 3, "island_count": 2})


class History:
    """Sends the same requests to two servers: one that is stopped now and then, and one that is not."""

    def __init__(self, case, seed):
        self.case, self.chance = case, random.Random(seed)
        self.actions, self.ticks, self.forks, self.names = [], {}, set(), 0
        self.folder = f"stopped {seed}"
        self.undisturbed = case.client(case.server(1, data=f"undisturbed {seed}"))
        self.start()
        self.send(delete_world=c.DeleteWorld(world="default"))  # it has a random seed

    def start(self):
        processes = self.chance.choice((1, 1, 2)) if "MPIRUN" in os.environ else 1
        self.actions.append(f"a server of {processes} processes starts")
        self.server = self.case.server(processes, data=self.folder)
        self.client = self.case.client(self.server)

    def assert_equal(self, answers, what):
        stopped, expected = map(mpi.comparable, answers)
        self.case.assertEqual(stopped, expected, "\n".join([*self.actions, what]))

    def send(self, **request):
        """Both servers must give the same answer; returns it."""
        self.actions.append(" ".join(str(request).split())[:300])
        clients = self.client, self.undisturbed
        answers = [client.response(client.ask(**request)) for client in clients]
        self.assert_equal(answers, "the answer")
        return answers[1]

    def name(self):
        self.names += 1
        return f"w{self.names}"

    def appear(self, name, answer):
        if answer.status.code == plain.OK:
            self.ticks[name] = answer.world.tick
            self.send(set_speed=c.SetSpeed(world=name, speed=w.Speed(max=True)))

    def create(self):
        name = self.name()
        parameters = {"population_size": self.chance.choice((1, 2, 3, 7, 50)),
                      "generation_s": self.chance.uniform(0.2, 1.0),
                      "food_count": self.chance.choice((0, 20)), "poison_count": 10, **self.chance.choice(KINDS)}
        self.appear(name, self.send(create_world=c.CreateWorld(
            name=name, seed=self.chance.randrange(1000), parameters=plain.assignments(**parameters))))

    def run(self, world):
        """Begins to run a world."""
        self.ticks[world] += self.chance.choice((1, 7, 60, 90, 200))
        self.send(run_until_tick=c.RunUntilTick(world=world, tick=self.ticks[world]))

    def rest(self):
        for client in self.client, self.undisturbed:
            for world, tick in self.ticks.items():
                client.wait_world(lambda x, tick=tick: x.tick >= tick, world)

    def set(self, world):
        names = self.chance.sample(list(VALUES), self.chance.randint(1, 3))
        draw = lambda low, high: (self.chance.randint if isinstance(low, int) else self.chance.uniform)(low, high)
        generation = self.undisturbed.world(world).generation
        at = self.chance.choice(({}, {"at_tick": self.ticks[world] + self.chance.randint(1, 90)},
                                 {"at_generation": generation + self.chance.randint(1, 2)}))
        self.send(set_parameters=c.SetParameters(
            world=world, parameters=plain.assignments(**{name: draw(*VALUES[name]) for name in names}), **at))

    def place(self, world):
        items = [c.PlacedItem(kind=c.ITEM_KIND_FOOD, x_px=self.chance.uniform(20, 1200),
                              y_px=self.chance.uniform(20, 700))]
        self.send(place=c.Place(world=world, items=items))

    def remove(self, world):
        alive = self.undisturbed.call(get_statistics=c.GetStatistics(world=world)).statistics
        count = alive.live[0].organism_count if alive.live else 1
        ids = range(count) if self.chance.random() < 0.4 else [self.chance.randrange(max(count, 1))]
        self.send(remove=c.Remove(world=world, organisms=ids))

    def fork(self, world):
        name, generation = self.name(), None
        if self.chance.random() < 0.6 and world not in self.forks:
            generation = self.chance.choice((1, self.chance.randint(1, self.undisturbed.world(world).generation)))
        self.appear(name, self.send(fork_world=c.ForkWorld(world=world, name=name, at_generation=generation)))
        self.forks.add(name)

    def reset(self, world):
        if self.send(reset_world=c.ResetWorld(world=world, seed=self.chance.randrange(1000))).status.code == plain.OK:
            self.ticks[world] = 0

    def delete(self, world):
        if len(self.ticks) > 1:
            self.send(delete_world=c.DeleteWorld(world=world))
            del self.ticks[world]

    def end(self):
        self.actions.append("the server is stopped")
        self.client.socket.close()  # the server would wait for it
        self.case.assertEqual(self.server.terminate(), 0)

    def stop(self, world):
        """Stops or kills the server, half of the time while a world runs, and starts it again."""
        if self.chance.random() < 0.5:
            self.run(world)
        if self.chance.random() < 0.5:
            self.actions.append("the server is killed")
            self.server.kill()
        else:
            self.end()
        self.start()
        self.rest()
        self.compare()

    def act(self):
        if not self.ticks or (len(self.ticks) < 2 and self.chance.random() < 0.1):
            return self.create()
        kinds = {self.run: 5, self.set: 6, self.place: 2, self.remove: 2, self.reset: 1, self.delete: 2, self.stop: 3,
                 self.fork: 4 if len(self.ticks) < WORLDS_MAX else 0}
        kind, = self.chance.choices(list(kinds), list(kinds.values()))
        kind(self.chance.choice(list(self.ticks)))
        self.rest()

    def compare(self):
        for world in self.ticks:
            for request in ({"get_statistics": c.GetStatistics(world=world)},
                            {"get_parameters": c.GetParameters(world=world)},
                            {"get_history": c.GetHistory(world=world)},
                            {"get_population": c.GetPopulation(world=world, with_life=True)}):
                self.assert_equal([client.call(**request) for client in (self.client, self.undisturbed)], str(request))

    def play(self):
        for _ in range(ACTIONS):
            self.act()
        if not self.ticks:
            self.create()
        self.stop(self.chance.choice(list(self.ticks)))
        self.end()
        self.case.verify(self.case.data(self.folder))


class Histories(mpi.Case):
    def test_stopped_servers_equal_undisturbed_ones(self):
        for seed in range(FIRST, FIRST + COUNT):
            with self.subTest(seed=seed):
                History(self, seed).play()


if __name__ == "__main__":
    unittest.main(argv=[os.path.basename(__file__), *past.sys.argv[4:]])
