"""The server under mpirun: its processes share worlds, and a client sees the server of one process. EVOD and EVOCTL
name the programs, MESSAGES the folder of the message classes."""
import contextlib
import itertools
import json
import os
import pathlib
import resource
import signal
import sqlite3
import sys
import tempfile
import time
import unittest

import mpi_jobs as jobs
import past_test as past
import waiting
from past_test import EVOD, EVOCTL, c, plain, w
from delta_decoder import Decoder
from plain_client import EXHAUSTED, INVALID, NOT_FOUND, OK, PRECONDITION, assignments
from recovery_test import journal

# A generation has 30 ticks.
ISLANDS = {"population_size": 12, "generation_s": 0.5, "food_count": 20, "poison_count": 10, "crate_count": 2,
           "obstacle_count": 2, "migration": "ring", "migration_epoch": 1, "migrant_count": 2}
POSITIONS = [(x, y) for x in range(30, 600, 60) for y in range(30, 400, 60)]
FULL_SPEED = w.Speed(max=True)
# Fields that differ between two servers with the same worlds. Motion.cell_px depends on when contacts were last looked
# for from the start.
OF_ONE_SERVER = {"request_id", "run_id", "ticks_per_s", "slowed", "storage", "by", "sequence", "subscription_id",
                 "dropped_count", "cell_px"}


def clear_fields_of_one_server(message):
    for field, value in message.ListFields():
        if field.name in OF_ONE_SERVER:
            message.ClearField(field.name)
        elif field.type == field.TYPE_MESSAGE:
            for part in value if field.label == field.LABEL_REPEATED else [value]:
                clear_fields_of_one_server(part)


def comparable(message):
    """A copy without the fields that differ between two servers with the same worlds."""
    copy = type(message)()
    copy.CopyFrom(message)
    clear_fields_of_one_server(copy)
    return copy


def food(x_px, y_px):
    return c.PlacedItem(kind=c.ITEM_KIND_FOOD, x_px=x_px, y_px=y_px)


def has_ended(process):
    """Whether a process has closed its files: all its threads have ended. It may still wait for its parent."""
    with contextlib.suppress(OSError), open(f"/proc/{process}/stat") as stat:
        return stat.read().rsplit(")", 1)[1].split()[0] in "ZX" and len(os.listdir(f"/proc/{process}/task")) == 1
    return True


class Server(past.Server):
    """A server of one process, or of several under mpirun."""

    def __init__(self, processes, *words):
        self.is_one = processes == 1
        super().__init__(*words, launcher=[] if self.is_one else jobs.mpirun(processes), env=jobs.ENVIRONMENT)

    def ranks(self):
        """The processes by rank."""
        return {0: self.process.pid} if self.is_one else jobs.processes_by_rank(self.process)

    def kill(self):
        ranks = self.ranks()
        jobs.kill(self.process)
        self.wait_for_the_end(ranks)

    def wait_for_the_end(self, ranks):
        """Returns the status when all processes have ended. Then another server may use the folder."""
        status = waiting.ended(self.process)
        waiting.until(lambda: all(map(has_ended, ranks.values())), "the end of all ranks")
        return status

    def terminate(self):
        """Ends the server as its operator does; returns the status."""
        ranks = self.ranks()
        os.kill(ranks[0], signal.SIGTERM)
        return self.wait_for_the_end(ranks)


class Steps:
    """Sends commands, and keeps their answers and the states of worlds, in order."""

    def __init__(self, client):
        self.client, self.all = client, []

    def send(self, code=OK, **request):
        response = self.client.response(self.client.ask(**request))
        self.all.append((next(iter(request)), comparable(response)))
        if code is not None:
            assert response.status.code == code, f"{request}: {response.status}"
        return response

    def run_to(self, tick, world):
        self.all.append((f"{world} at tick {tick}", self.client.run_to(tick, world).state_hash))

    def create(self, world, **parameters):
        self.send(create_world=c.CreateWorld(name=world, seed=5, parameters=assignments(**{**ISLANDS, **parameters})))
        self.send(set_speed=c.SetSpeed(world=world, speed=FULL_SPEED))

    def place(self, world, island):
        """Places food and a copy of an organism at the first free position."""
        genes = self.client.call(get_organism=c.GetOrganism(world=world, island=island, organism=2)).organism.genes
        for x, y in POSITIONS:
            response = self.send(None, place=c.Place(world=world, island=island, items=[food(x, y), food(x, y)],
                                                     organisms=[
                c.PlacedOrganism(x_px=x, y_px=y, genes=genes)]))
            if response.status.code == OK:
                return response.placed
        raise AssertionError("no position is free")

    def set(self, world, at_tick=None, at_generation=None, **values):
        return self.send(set_parameters=c.SetParameters(world=world, parameters=assignments(**values), at_tick=at_tick,
                                                        at_generation=at_generation))

    def fork(self, world, name, at_generation=None, to=95):
        self.send(fork_world=c.ForkWorld(world=world, name=name, at_generation=at_generation))
        self.send(set_speed=c.SetSpeed(world=name, speed=FULL_SPEED))
        self.run_to(to, name)
        self.send(delete_world=c.DeleteWorld(world=name))


def change_everything(steps, islands, **parameters):
    """Sends every kind of command to a world, to islands of rank 0 and to others. No world awaits fitness."""
    world, last = f"w{islands}", islands - 1
    steps.create(world, island_count=islands, **parameters)
    for island in 0, last:  # before the first tick
        placed = steps.place(world, island)
        steps.send(remove=c.Remove(world=world, island=island, food=placed.food[:1], organisms=[1]))
    steps.fork(world, "begun")
    steps.run_to(10, world)
    steps.set(world, food_health=9.0, health_loss_per_s=20.0)
    steps.set(world, at_tick=17, max_speed_px_s=120.0, food_count=25)
    steps.set(world, at_generation=2, mutation_chance=0.5, population_size=15)
    cancelled = steps.set(world, at_generation=3, population_size=50).planned_change.id
    steps.send(cancel_change=c.CancelChange(world=world, id=cancelled))
    steps.send(NOT_FOUND, cancel_change=c.CancelChange(world=world, id=cancelled))
    for island in 0, islands // 2, last:
        placed = steps.place(world, island)
        steps.send(remove=c.Remove(world=world, island=island, food=placed.food[1:], organisms=[0, 5]))
    steps.send(NOT_FOUND, place=c.Place(world=world, island=islands, items=[food(9, 9)]))
    steps.send(INVALID, remove=c.Remove(world=world, island=last, organisms=[0]))  # it is dead
    steps.run_to(20, world)
    steps.fork(world, "now")
    steps.run_to(30, world)  # the end of the generation
    steps.fork(world, "over")
    steps.send(PRECONDITION, remove=c.Remove(world=world, island=last, organisms=[2]))
    steps.run_to(45, world)
    steps.set(world, population_size=10)
    steps.fork(world, "current", at_generation=2)
    steps.fork(world, "earlier", at_generation=1)
    steps.send(remove=c.Remove(world=world, island=last, organisms=range(15)))  # the island dies out
    steps.run_to(95, world)
    steps.send(get_history=c.GetHistory(world=world))
    steps.send(reset_world=c.ResetWorld(world=world, seed=6))
    steps.run_to(40, world)
    steps.send(delete_world=c.DeleteWorld(world=world))


def rate_islands(steps, islands):
    """Two generations whose fitness comes from the client."""
    world = f"rated{islands}"
    steps.create(world, island_count=islands, fitness="external")
    steps.send(run=c.Run(world=world))
    for generation in 1, 2:
        awaited = steps.client.wait_world(lambda info: info.awaited_fitness.generation == generation, world)
        steps.all.append(("awaited", list(awaited.awaited_fitness.islands), awaited.state_hash))
        rate = lambda code, island, count, first=0: steps.send(code, set_fitness=c.SetFitness(
            world=world, generation=generation, island=island, first_organism=first,
            fitness=[(7 * organism + island) % 11 for organism in range(first, first + count)]))
        rate(NOT_FOUND, islands, 12)
        for island in reversed(range(islands)):
            rate(INVALID, island, 13)
            rate(OK, island, 5)
            rate(INVALID, island, 5, first=7)
            if (generation, island) == (2, 0):
                steps.send(pause=c.Pause(world=world))  # the world shall not begin the next generation
            rate(OK, island, 7, first=5)
            if island > 0:
                rate(PRECONDITION, island, 12)
    steps.run_to(60, world)
    steps.send(delete_world=c.DeleteWorld(world=world))


class Case(past.Case):
    maxDiff = None

    def server(self, processes, *options, data=None):
        """data: the name of its folder."""
        server = Server(processes, "--data", self.data(data or f"of {processes}"), *options)
        self.addCleanup(server.log.close)
        self.addCleanup(server.kill)
        return server

    def data(self, name):
        return os.path.join(self.folder, name)

    def client(self, server, key=None):
        client = plain.Client(server, key=key)
        self.addCleanup(client.socket.close)
        return client

    def experiment(self, **parameters):
        path = pathlib.Path(self.folder, "shared.json")
        path.write_text(json.dumps({**ISLANDS, "island_count": 8, **parameters}))
        return "--experiment", str(path), "--seed", "7", "--speed", "max"

    def verify(self, server):
        """All files of a server that has ended, by simulating them again."""
        files = list(pathlib.Path(server).glob("*.evod"))
        self.assertTrue(files)
        for file in files:
            done = waiting.run([EVOD, "verify", str(file)], capture_output=True, text=True)
            self.assertEqual(done.returncode, 0, done.stdout + done.stderr)


class Commands(Case):
    def assert_same_steps(self, steps, expected):
        for (name, *step), (wanted_name, *wanted) in zip(steps.all, expected.all):
            self.assertEqual((name, step), (wanted_name, wanted))
        self.assertEqual(len(steps.all), len(expected.all))

    def compare(self, perform, *processes):
        """Performs the same steps on a server of one process and on servers of so many."""
        expected = None
        for count in 1, *processes:
            server = self.server(count)
            steps = Steps(self.client(server))
            with self.subTest(processes=count):
                perform(steps)
                if expected is not None:
                    self.assert_same_steps(steps, expected)
                self.assertEqual(server.terminate(), 0)
            expected = expected or steps

    def test_commands_give_the_states_of_one_process(self):
        def perform(steps):
            change_everything(steps, 8)
            change_everything(steps, 4, controller="network")
            for islands in 8, 4:
                rate_islands(steps, islands)
        self.compare(perform, 2, 3, 4)
        self.verify(self.data("of 4"))

    def test_a_world_with_few_islands_is_not_shared(self):
        def perform(steps):
            steps.create("small", island_count=2)
            steps.create("large", island_count=8)
            for world in "small", "large":  # they run at the same time
                steps.send(run_until_tick=c.RunUntilTick(world=world, tick=100))
            for world in "small", "large":
                steps.run_to(100, world)
                steps.place(world, 1)
                steps.fork(world, "fork", to=130)
        self.compare(perform, 4)

    def test_a_reset_changes_the_number_of_islands(self):
        def perform(steps):
            steps.create("w", island_count=2)
            for islands in 8, 2, 8:
                steps.run_to(35, "w")
                steps.set("w", island_count=islands)
                steps.send(reset_world=c.ResetWorld(world="w"))
                steps.send(get_statistics=c.GetStatistics(world="w"))
            steps.run_to(35, "w")
        self.compare(perform, 4)
        self.verify(self.data("of 4"))


class Compared(Case):
    """The same world in a server of three processes and in one of one process."""

    def setUp(self):
        super().setUp()
        self.shared, self.alone = self.server(3), self.server(1)
        self.clients = [self.client(server) for server in (self.alone, self.shared)]

    def both(self, code=OK, **request):
        """Asserts that both servers answer the same."""
        alone, shared = (comparable(client.call(code, **request)) for client in self.clients)
        self.assertEqual(shared, alone, request)
        return shared

    def create(self, **parameters):
        for client in self.clients:
            Steps(client).create("w", **{"island_count": 8, **parameters})

    def run_to(self, tick):
        alone, shared = (client.run_to(tick, "w").state_hash for client in self.clients)
        self.assertEqual(shared, alone, tick)

    def change_islands(self):
        for island in 0, 4, 7:
            placed = [Steps(client).place("w", island) for client in self.clients]
            self.assertEqual(*map(comparable, placed))
            self.both(remove=c.Remove(world="w", island=island, food=placed[0].food[:1], organisms=[3]))


class Snapshots(Compared):
    TICKS = (0, 10, 30, 31, 60)

    def snapshots(self, client, islands):
        """The snapshots of a paused world by island."""
        found, state = {}, client.world("w").state_hash
        while len(found) < len(islands):
            snapshot = client.next_snapshot(lambda snapshot: snapshot.state_hash.hex() == state)
            found[snapshot.island] = snapshot
        self.assertEqual(sorted(found), sorted(islands))
        return found

    def compare(self, islands, **subscription):
        asked = dict(world="w", rate_hz=60, headings=True, **subscription)
        ids = [client.call(subscribe_snapshots=c.SubscribeSnapshots(**asked)).subscription.subscription_id
               for client in self.clients]
        for tick in self.TICKS:
            self.run_to(tick)
            if tick == 10:
                self.change_islands()
            for client, subscription_id in zip(self.clients, ids):
                client.snapshots.clear()
                client.call(request_keyframe=c.RequestKeyframe(subscription_id=subscription_id))
            alone, shared = (self.snapshots(client, islands) for client in self.clients)
            for island in islands:
                self.assertEqual(comparable(shared[island]), comparable(alone[island]), (tick, island))
                if tick == 10:
                    self.assertGreater(len(plain.columns(shared[island])["organisms"]["id"]), 9)

    def test_all_islands_are_those_of_one_process(self):
        self.create(controller="network")
        self.compare(range(8))

    def test_one_island_is_that_of_one_process(self):
        self.create()
        self.compare([7], island=7)

    def test_their_state_hash_is_that_of_the_run_file(self):
        self.create()
        client = self.clients[1]
        client.call(subscribe_snapshots=c.SubscribeSnapshots(world="w", rate_hz=120, island=6))
        hashes = {}
        for tick in (60, 120, 180):
            client.run_to(tick, "w")
            hashes[tick] = client.next_snapshot(lambda snapshot: snapshot.tick == tick).state_hash.hex()
        self.assertEqual(self.shared.terminate(), 0)
        with contextlib.closing(sqlite3.connect(f"file:{self.data('of 3')}/w.evod?mode=ro", uri=True)) as run:
            stored = {tick: f"{high % 2**64:016x}{low % 2**64:016x}" for tick, low, high in
                      run.execute("SELECT tick, low, high FROM state_hash WHERE tick > 0")}
        self.assertEqual({tick: stored[tick] for tick in hashes}, hashes)
        self.verify(self.data("of 3"))

    def test_they_keep_coming_at_full_speed(self):
        self.create()
        client = self.clients[1]
        client.call(subscribe_snapshots=c.SubscribeSnapshots(world="w", rate_hz=60, island=5))
        deltas = client.call(subscribe_snapshots=c.SubscribeSnapshots(
            world="w", rate_hz=60, island=5, codec=plain.stream_pb2.CODEC_DELTA)).subscription.subscription_id
        client.call(run=c.Run(world="w"))
        decoder, tick, seen = Decoder(plain.zstd_content), -1, {}
        for _ in range(60):
            snapshot = client.next_snapshot()
            self.assertEqual(snapshot.island, 5)
            if snapshot.subscription_id == deltas:
                self.assertGreater(snapshot.tick, tick)
                tick, entities = snapshot.tick, decoder.decode(snapshot)
                seen[tick] = [list(entities["organisms"][field]) for field in ("id", "x", "y")]
            else:
                organisms = plain.columns(snapshot)["organisms"]
                expected = [list(organisms["id"]), list(16 * organisms["x"]), list(16 * organisms["y"])]
                self.assertEqual(seen.get(snapshot.tick, expected), expected)
        self.assertGreater(len(seen), 10)


class Queries(Compared):
    def ask_everything(self):
        self.both(get_statistics=c.GetStatistics(world="w"))
        self.both(get_history=c.GetHistory(world="w"))
        self.both(get_parameters=c.GetParameters(world="w"))
        for island in range(8):
            self.both(get_history=c.GetHistory(world="w", island=island))
            self.both(get_motion=c.GetMotion(world="w", island=island))
            population = self.both(get_population=c.GetPopulation(world="w", island=island, with_life=True)).population
            for organism in range(population.organism_count):
                self.both(get_organism=c.GetOrganism(world="w", island=island, organism=organism))
            self.both(NOT_FOUND, get_organism=c.GetOrganism(world="w", island=island,
                                                            organism=population.organism_count))
        for request in ({"get_motion": c.GetMotion(world="w", island=8)},
                        {"get_history": c.GetHistory(world="w", island=8)},
                        {"get_population": c.GetPopulation(world="w", island=8)},
                        {"get_organism": c.GetOrganism(world="w", island=8)},
                        {"subscribe_snapshots": c.SubscribeSnapshots(world="w", island=8, rate_hz=1)}):
            self.both(NOT_FOUND, **request)

    def at_all_moments(self, has_bodies=True, **parameters):
        self.create(population_size=6, **parameters)
        self.ask_everything()
        for tick in (12, 30, 31, 65) if has_bodies else (1, 2):
            self.run_to(tick)
            if tick == 12:
                self.change_islands()
            self.ask_everything()
        self.both(get_breeding=c.GetBreeding(world="w", island=6))
        self.both(delete_world=c.DeleteWorld(world="w"))

    def test_bodies(self):
        self.at_all_moments()

    def test_brains(self):
        self.at_all_moments(controller="network")

    def test_chromosomes_alone(self):
        self.at_all_moments(has_bodies=False, fitness="gene_sum")


class Faults(Case):
    def changed(self, client, request_id, value):
        """Sends a change; returns the tick from which it holds."""
        return client.call(client_key="k", request_id=request_id,
                           set_parameters=plain.set_parameters("shared", food_health=value)).applied_tick

    def test_a_killed_process_loses_no_command(self):
        options, ticks = self.experiment(), {}
        for processes, killed in (4, 2), (1, 0), (2, 1), (4, 3):
            server = self.server(processes, *options, "--start", data="d")
            client, ranks = self.client(server), server.ranks()
            for request_id in ticks:  # the servers before have stored them
                self.assertEqual(self.changed(client, request_id, request_id), ticks[request_id])
            with contextlib.suppress(EOFError, OSError):
                for sent in itertools.count():
                    if sent == 10:
                        os.kill(ranks[killed], signal.SIGKILL)
                    request_id = len(ticks) + 1  # the last one of each server is sent again to the next
                    ticks[request_id] = self.changed(client, request_id, request_id)
            self.assertEqual(server.wait_for_the_end(ranks), -signal.SIGKILL if server.is_one else 128 + signal.SIGKILL)
            kept = [(request_id, tick) for _, tick, key, request_id in journal(self.data("d"), "shared") if key == "k"]
            self.assertEqual(kept[:len(ticks)], list(ticks.items()))
        client = self.client(self.server(2, data="d"))
        client.call(pause=c.Pause(world="shared"))
        end = client.world("shared")
        alone = self.client(self.server(1, *options))
        for _, tick, key, request_id in journal(self.data("d"), "shared"):
            if key == "k":
                alone.run_to(tick, "shared")
                self.assertEqual(self.changed(alone, request_id, request_id), tick)
        self.assertEqual(alone.run_to(end.tick, "shared").state_hash, end.state_hash)

    def test_a_world_without_memory_for_it_is_refused(self):
        server = self.server(3, *self.experiment())
        client = self.client(server)
        before = client.run_to(50, "shared")
        with open(f"/proc/{server.ranks()[1]}/statm") as statm:
            present = int(statm.read().split()[0]) * resource.getpagesize()
        # Open MPI also needs some memory: its queues grow when a process is late.
        resource.prlimit(server.ranks()[1], resource.RLIMIT_AS, (present + (32 << 20), resource.RLIM_INFINITY))
        crowd = assignments(population_size=300_000, scale_with_population=True, reference_population=50,
                            island_count=3)
        refused = client.call(EXHAUSTED, create_world=c.CreateWorld(name="crowd", seed=1, parameters=crowd)).status
        self.assertIn("not enough memory: nothing was changed", refused.message)
        self.assertEqual(client.world("shared").state_hash, before.state_hash)
        client.run_to(100, "shared")

    def test_a_stopped_process_is_named(self):
        server = self.server(3, *self.experiment(), "--start", "--rank-timeout", "1")
        client = self.client(server)
        client.wait_world(lambda info: info.tick > 100)
        ranks = server.ranks()
        os.kill(ranks[1], signal.SIGSTOP)
        self.assertEqual(waiting.ended(server.process), jobs.EXIT_RANK_LOST)
        self.assertRegex(server.output(), jobs.LOST.format(1, 1))

    def test_a_signal_to_rank_0_ends_all_well(self):
        server = self.server(3, *self.experiment(), "--start", data="d")
        self.client(server).wait_world(lambda info: info.tick > 100)
        for rank in 2, 1:
            os.kill(server.ranks()[rank], signal.SIGTERM)  # rank 0 alone ends the server
        self.client(server).wait_world(lambda info: info.tick > 200)
        self.assertEqual(server.terminate(), 0)
        self.assertEqual(server.output().count("stopped\n"), 1)
        with contextlib.closing(sqlite3.connect(f"file:{self.data('d')}/shared.evod?mode=ro", uri=True)) as run:
            self.assertEqual(run.execute("SELECT how FROM end_mark").fetchall(), [("closed",)])
        self.verify(self.data("d"))

    def test_a_shut_down_ends_all(self):
        server = self.server(3, *self.experiment(), "--start")
        ranks = server.ranks()
        client = self.client(server)
        client.wait_world(lambda info: info.tick > 100)
        client.call(shut_down=c.ShutDown())
        client.next_event("server_going_away")
        self.assertEqual(server.wait_for_the_end(ranks), 0)

    def test_a_server_that_cannot_start_ends_all(self):
        alone = self.server(1)
        file = pathlib.Path(self.folder, "file")
        file.touch()
        for sentence, port, data, options in (("port is in use", alone.port, self.data("d"), ()),
                                              ("file", 0, file, ()),
                                              ("No such file", 0, self.data("d"), ("--experiment", f"{file}.json"))):
            with self.subTest(sentence):
                done = waiting.run([*jobs.mpirun(3), EVOD, "--port", str(port), "--data", str(data), *options],
                                   capture_output=True, text=True, env=jobs.ENVIRONMENT)
                self.assertEqual(done.returncode, 1)
                self.assertEqual(done.stderr.count(sentence), 1, done.stderr)

    def test_idle_processes_wait_for_clients(self):
        # Longer than the others wait for rank 0 while there is work.
        server, idle_s, began = self.server(3, *self.experiment(), "--rank-timeout", "1"), 12, time.monotonic()
        client = self.client(server)
        expected = self.client(self.server(1, *self.experiment())).run_to(50, "shared").state_hash
        waiting.until(lambda: time.monotonic() - began > idle_s, "the processes being idle")
        done = waiting.run([EVOCTL, "--server", f"localhost:{server.port}", *waiting.PATIENT, "until", "50", "--wait"],
                           capture_output=True, text=True)
        self.assertEqual(done.returncode, 0, done.stderr)
        for each in client, self.client(server):
            self.assertEqual(each.world().state_hash, expected)


if __name__ == "__main__":
    unittest.main(argv=[sys.argv[0], *sys.argv[4:]])
