"""Looking back: evod replay, OpenReplay, Seek and ForkWorld over real sockets. EVOD and EVOCTL name the programs,
MESSAGES the folder of the message classes."""
import os
import pathlib
import re
import sqlite3
import subprocess
import sys
import tempfile
import unittest

EVOD, EVOCTL = os.environ["EVOD"], os.environ["EVOCTL"]
sys.argv[1:1] = [EVOD, os.environ["MESSAGES"], "-"]  # as plain_client reads them
sys.path.insert(0, str(pathlib.Path(__file__).parent))
import plain_client as plain  # noqa: E402
import waiting  # noqa: E402

c, w = plain.c, plain.w
CREATE = {"population_size": 12, "generation_s": 2.0, "island_count": 2, "migration": "ring", "migration_epoch": 2}


def at(**moment):
    return c.RunMoment(**moment)


class Server(plain.Server):
    def __init__(self, *words, launcher=(), **popen):
        """launcher: the words before the program, of another one that starts it."""
        self.log = tempfile.TemporaryFile()
        self.process = subprocess.Popen([*launcher, EVOD, *words, "--port", "0"], stdout=self.log, stderr=self.log,
                                        **popen)
        line = plain.until(lambda: self.process.poll() is not None or
                           re.search(r"listening on 127\.0\.0\.1:(\d+)", self.output()), "ready")
        if line is True:
            raise AssertionError("evod ended at once:\n" + self.output())
        self.port = int(line[1])

    def kill(self):
        self.process.kill()
        waiting.ended(self.process)


class Client(plain.Client):
    def world(self, name=""):
        """Also a replay, which ListWorlds does not contain."""
        return self.call(get_statistics=c.GetStatistics(world=name)).statistics.world


class Case(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = folder.name

    def server(self, *options, **popen):
        server = Server(*options, **popen)
        self.addCleanup(server.log.close)
        self.addCleanup(server.kill)
        return server

    def client(self, server):
        client = Client(server)
        self.addCleanup(client.socket.close)
        return client

    def recorded(self, client, ticks=(0, 1, 119, 120, 121, 250, 421)):
        """A world with changes of parameters on its way, and its hash at some ticks."""
        client.call(create_world=c.CreateWorld(name="w", seed=3, parameters=plain.assignments(**CREATE)))
        client.call(set_speed=c.SetSpeed(world="w", speed=w.Speed(max=True)))
        hashes = {}
        for tick in ticks:
            hashes[tick] = client.run_to(tick, "w").state_hash
            if tick == 119:
                client.call(set_parameters=plain.set_parameters("w", food_health=7.0))
            if tick == 250:
                client.call(set_parameters=plain.set_parameters("w", population_size=15, mutation_chance=0.5))
        return hashes


class OpenReplay(Case):
    def setUp(self):
        super().setUp()
        self.served = self.server("--data", self.folder)
        self.live = self.client(self.served)
        self.hashes = self.recorded(self.live)

    def test_replays_are_exact_and_change_nothing(self):
        viewer = self.client(self.served)
        before = self.live.world("w")
        past = viewer.call(open_replay=c.OpenReplay(world="w")).world
        self.assertEqual((past.name, past.tick, past.state), ("w@1", 0, w.RUN_STATE_PAUSED))
        self.assertEqual((past.replay.replay_of, past.replay.first_generation, past.replay.last_generation),
                         ("w", 1, 4))
        self.assertEqual((past.replay.first_tick, past.replay.last_tick), (0, 421))
        for tick in (421, 0, 250, 119, 121, 1, 120):
            there = viewer.call(seek=c.Seek(world=past.name, to=at(tick=tick))).world
            self.assertEqual((there.tick, there.state_hash), (tick, self.hashes[tick]))
            self.assertEqual(there.state, w.RUN_STATE_PAUSED)
        self.assertEqual(self.live.world("w"), before)

    def test_moments_are_named_by_generation_and_tick(self):
        viewer = self.client(self.served)
        past = viewer.call(open_replay=c.OpenReplay(world="w", at=at(generation=2))).world
        self.assertEqual((past.generation, past.generation_tick, past.tick), (2, 0, 120))
        to = lambda **moment: viewer.call(seek=c.Seek(world=past.name, to=at(**moment))).world
        end = to(generation=1, tick=120)
        self.assertEqual((end.generation, end.generation_tick), (1, 120))
        self.assertEqual(end.state_hash, self.hashes[120])
        self.assertEqual(to(generation=3, tick=10).state_hash, self.hashes[250])
        self.assertEqual(to().tick, 421)
        for wrong, field, allowed in (({"generation": 5}, "generation", "1 to 4"),
                                      ({"generation": 0}, "generation", "1 to 4"),
                                      ({"tick": 422}, "tick", "0 to 421"),
                                      ({"generation": 2, "tick": 121}, "tick", "0 to 120 in generation 2")):
            refused = viewer.call(c.CODE_NOT_FOUND, seek=c.Seek(world=past.name, to=at(**wrong)))
            self.assertEqual(refused.status.violations[0].field, "seek.to." + field)
            self.assertEqual(refused.status.violations[0].allowed, allowed)
        self.assertEqual(viewer.world(past.name).tick, 421)

    def test_an_empty_moment_opens_the_last_one(self):
        viewer = self.client(self.served)
        last = viewer.call(open_replay=c.OpenReplay(world="w", at=at())).world
        self.assertEqual((last.tick, last.state_hash, last.state), (421, self.hashes[421], w.RUN_STATE_PAUSED))
        first = viewer.call(open_replay=c.OpenReplay(world="w")).world
        self.assertEqual((first.tick, first.state_hash), (0, self.hashes[0]))

    def test_a_replay_follows_the_running_world(self):
        viewer = self.client(self.served)
        past = viewer.call(open_replay=c.OpenReplay(world="w", at=at(tick=100))).world.name
        viewer.call(set_speed=c.SetSpeed(world=past, speed=w.Speed(max=True)))
        viewer.call(resume=c.Resume(world=past))
        there = viewer.wait_world(lambda world: world.tick == 421, past)
        self.assertEqual(there.state_hash, self.hashes[421])
        later = self.live.run_to(600, "w")
        there = viewer.wait_world(lambda world: world.tick == 600, past)
        self.assertEqual(there.state_hash, later.state_hash)
        self.assertEqual(there.replay.last_tick, 600)
        back = viewer.call(seek=c.Seek(world=past, to=at(tick=120))).world  # it runs, so it goes on
        self.assertNotEqual(back.state, w.RUN_STATE_PAUSED)
        viewer.wait_world(lambda world: world.tick == 600, past)

    def test_a_replay_can_be_streamed_stepped_and_queried(self):
        viewer = self.client(self.served)
        past = viewer.call(open_replay=c.OpenReplay(world="w", at=at(tick=249))).world.name
        viewer.call(subscribe_snapshots=c.SubscribeSnapshots(world=past, rate_hz=60))
        self.assertEqual(viewer.next_snapshot().tick, 249)
        viewer.call(run_until_tick=c.RunUntilTick(world=past, tick=250))
        self.assertEqual(viewer.next_snapshot(lambda snapshot: snapshot.tick == 250).state_hash.hex(), self.hashes[250])
        viewer.call(seek=c.Seek(world=past, to=at(tick=121)))
        self.assertEqual(viewer.next_snapshot(lambda snapshot: snapshot.tick == 121).state_hash.hex(), self.hashes[121])
        statistics = viewer.call(get_statistics=c.GetStatistics(world=past)).statistics
        self.assertEqual({row.generation for row in statistics.last}, {1})
        self.assertEqual(len(viewer.call(get_history=c.GetHistory(world=past)).history.generations), 2)
        viewer.call(get_organism=c.GetOrganism(world=past, organism=3))
        reported = viewer.call(get_population=c.GetPopulation(world=past)).population
        self.assertEqual((reported.generation, reported.generation_tick, len(reported.parents)),
                         (2, 1, 8 * reported.organism_count))
        viewer.call(seek=c.Seek(world=past, to=at(tick=421)))  # where the run is
        for name, request in (("population", {"get_population": c.GetPopulation}),
                              ("motion", {"get_motion": c.GetMotion})):
            then, now = (getattr(viewer.call(**{key: kind(world=world) for key, kind in request.items()}), name)
                         for world in (past, "w"))
            if name == "population":
                self.assertEqual(len(then.founders), 4 * now.organism_count,
                                 "families are reported apart in the past too")
            else:  # as high as it was when contacts were last looked for afresh
                then.ClearField("cell_px")
                now.ClearField("cell_px")
            self.assertEqual(then, now, "to the last bit")

    def test_a_replay_cannot_be_changed(self):
        viewer = self.client(self.served)
        past = viewer.call(open_replay=c.OpenReplay(world="w")).world.name
        for request in ({"set_parameters": plain.set_parameters(past, food_health=3.0)},
                        {"reset_world": c.ResetWorld(world=past)}, {"delete_world": c.DeleteWorld(world=past)}):
            refused = viewer.call(c.CODE_FAILED_PRECONDITION, **request)
            self.assertIn("is a replay", refused.status.message)
        viewer.call(c.CODE_FAILED_PRECONDITION, seek=c.Seek(world="w", to=at(tick=1)))
        viewer.call(c.CODE_INVALID_ARGUMENT, seek=c.Seek(world=past))
        viewer.call(c.CODE_INVALID_ARGUMENT, close_replay=c.CloseReplay())
        viewer.call(c.CODE_NOT_FOUND, open_replay=c.OpenReplay(world="nowhere"))
        journal = sqlite3.connect(f"file:{self.folder}/w.evod?mode=ro", uri=True)
        count = lambda: journal.execute("SELECT count(*) FROM journal").fetchone()[0]
        entries = count()
        viewer.call(resume=c.Resume(world=past))
        self.live.call(set_parameters=plain.set_parameters("w", food_health=9.0))
        self.assertEqual(count(), entries + 1)
        journal.close()

    def test_replays_belong_to_their_session(self):
        with Client(self.served) as viewer:
            names = [viewer.call(open_replay=c.OpenReplay(world="w")).world.name for _ in range(4)]
            self.assertEqual(len(set(names)), 4)
            viewer.call(close_replay=c.CloseReplay(world=names[0]))
            viewer.call(c.CODE_NOT_FOUND, close_replay=c.CloseReplay(world=names[0]))
            viewer.call(c.CODE_NOT_FOUND, close_replay=c.CloseReplay(world="w"))
            viewer.call(open_replay=c.OpenReplay(world=names[1]))  # the same past
            self.assertEqual([world.name for world in viewer.call(list_worlds=c.ListWorlds()).worlds.worlds],
                             ["default", "w"])
        asked = lambda: self.live.response(self.live.ask(get_statistics=c.GetStatistics(world=names[1])))
        gone = lambda: asked().status.code == c.CODE_NOT_FOUND
        plain.until(gone, "the session's looks are closed")

    def test_the_run_may_end_during_a_replay(self):
        viewer = self.client(self.served)
        past = viewer.call(open_replay=c.OpenReplay(world="w", at=at(tick=10))).world
        self.live.call(reset_world=c.ResetWorld(world="w", seed=99))
        there = viewer.call(seek=c.Seek(world=past.name, to=at(tick=250))).world
        self.assertEqual(there.state_hash, self.hashes[250])
        self.live.call(delete_world=c.DeleteWorld(world="w"))
        self.assertEqual(viewer.call(seek=c.Seek(world=past.name, to=at(tick=120))).world.state_hash, self.hashes[120])

    def test_a_server_without_recording_refuses(self):
        viewer = self.client(self.server("--keep-nothing"))
        refused = viewer.call(c.CODE_FAILED_PRECONDITION, open_replay=c.OpenReplay())
        self.assertIn("stores no runs", refused.status.message)


class Fork(Case):
    def setUp(self):
        super().setUp()
        self.served = self.server("--data", self.folder)
        self.live = self.client(self.served)
        self.hashes = self.recorded(self.live)

    def lives_as_its_origin(self, client, name, ticks=(250, 421)):
        client.call(set_speed=c.SetSpeed(world=name, speed=w.Speed(max=True)))
        begun = client.world(name).tick
        for tick in (tick for tick in ticks if tick >= begun):
            self.assertEqual(client.run_to(tick, name).state_hash, self.hashes[tick], tick)

    def test_a_fork_equals_its_origin_until_a_change(self):
        forked = self.live.call(fork_world=c.ForkWorld(world="w", name="f", at_generation=2)).world
        self.assertEqual((forked.name, forked.generation, forked.tick, forked.state),
                         ("f", 2, 120, w.RUN_STATE_WAITING))
        self.assertEqual(forked.seed, 3)
        self.assertNotEqual(forked.run_id, self.live.world("w").run_id)
        self.lives_as_its_origin(self.live, "f", [121, 250])  # the origin's change at 250 is not the fork's
        self.assertNotEqual(self.live.run_to(421, "f").state_hash, self.hashes[421])
        self.assertEqual(self.live.world("w").state_hash, self.hashes[421])

    def test_refusals_of_forks_name_the_field(self):
        refused = lambda code, **fields: self.live.call(code, fork_world=c.ForkWorld(**fields)).status
        self.assertEqual(refused(c.CODE_INVALID_ARGUMENT, world="w", name="../f").violations[0].field,
                         "fork_world.name")
        self.assertEqual(refused(c.CODE_INVALID_ARGUMENT, world="w", name="f", at_generation=0).violations[0].field,
                         "fork_world.at_generation")
        self.assertEqual(refused(c.CODE_ALREADY_EXISTS, world="w", name="w", at_generation=2).violations[0].field,
                         "fork_world.name")
        missing = refused(c.CODE_NOT_FOUND, world="w", name="f", at_generation=9).violations[0]
        self.assertEqual((missing.field, missing.allowed), ("fork_world.at_generation", "1 to 4"))
        refused(c.CODE_NOT_FOUND, world="nowhere", name="f")

    def test_a_replay_can_be_forked(self):
        past = self.live.call(open_replay=c.OpenReplay(world="w", at=at(generation=3))).world.name
        self.live.call(fork_world=c.ForkWorld(world=past, name="f", at_generation=3))
        self.lives_as_its_origin(self.live, "f", [250])


class Replay(Case):
    def setUp(self):
        super().setUp()
        server = Server("--data", self.folder)
        with Client(server) as client:
            self.hashes = self.recorded(client)
        server.end()
        self.run_file = f"{self.folder}/w.evod"

    def test_a_finished_run_is_served_to_any_viewer(self):
        viewer = self.client(self.server("replay", self.run_file, "--generation", "2"))
        world = viewer.world()
        self.assertEqual((world.name, world.generation, world.tick), ("w", 2, 120))
        self.assertEqual((world.replay.replay_of, world.replay.last_tick), ("", 421))
        viewer.call(subscribe_events=c.SubscribeEvents())
        viewer.call(set_speed=c.SetSpeed(speed=w.Speed(max=True)))
        viewer.call(resume=c.Resume())
        viewer.next_event("generation_finished")
        self.assertEqual(viewer.wait_world(lambda there: there.tick == 421).state_hash, self.hashes[421])
        for tick in (0, 250, 120):
            self.assertEqual(viewer.call(seek=c.Seek(to=at(tick=tick))).world.tick, tick)
        viewer.call(c.CODE_FAILED_PRECONDITION, reset_world=c.ResetWorld(world="w"))

    def test_a_replay_writes_nothing(self):
        before = pathlib.Path(self.run_file).read_bytes()
        served = self.server("replay", self.run_file)
        viewer = self.client(served)
        viewer.call(seek=c.Seek(to=at(generation=3, tick=7)))
        forked = viewer.call(fork_world=c.ForkWorld(name="f", at_generation=2)).world  # in memory alone
        self.assertEqual(viewer.run_to(250, forked.name).state_hash, self.hashes[250])
        served.end()
        self.assertEqual(pathlib.Path(self.run_file).read_bytes(), before)

    def test_evoctl_seeks(self):
        served = self.server("replay", self.run_file)
        run = lambda *words: waiting.run([EVOCTL, "--server", f"127.0.0.1:{served.port}", *waiting.PATIENT, *words],
                                         capture_output=True, text=True)
        done = run("seek", "--generation", "3", "--tick", "10")
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertEqual(self.client(served).world().state_hash, self.hashes[250])
        self.assertNotEqual(run("seek", "--tick", "422").returncode, 0)

    def test_evoctl_waits_until_the_end_of_the_replay(self):
        served = self.server("replay", self.run_file, "--generation", "2")
        run = lambda *words: waiting.run([EVOCTL, "--server", f"127.0.0.1:{served.port}", *waiting.PATIENT, *words],
                                         capture_output=True, text=True)
        status = run("status").stdout
        self.assertIn("\nit shows a stored run, which it does not change\n", status)
        self.assertNotIn("not recorded", status)
        self.assertEqual(run("speed", "max").returncode, 0)
        done = run("run", "1", "--wait")
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertNotIn("last moment", done.stdout)
        end = "tick 421 .*, the last tick in its run file: evoctl seek moves it to another"
        done = run("run", "--wait")
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertRegex(done.stdout, end)
        done = run("run", "50", "--wait")
        self.assertEqual(done.returncode, 1)
        self.assertRegex(done.stderr, "stopped before its goal: .*" + end)
        done = run("until", "9000", "--wait")
        self.assertEqual(done.returncode, 1)
        self.assertRegex(done.stderr, "stopped before its goal: .*" + end)

    def test_evoctl_says_that_forks_are_not_recorded(self):
        served = self.server("replay", self.run_file)
        done = waiting.run([EVOCTL, "--server", f"127.0.0.1:{served.port}", *waiting.PATIENT, "fork", "w",
                            "--at-generation", "2", "--name", "mine"], capture_output=True, text=True)
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertIn("forked mine", done.stdout)
        self.assertIn("it is not recorded", done.stdout)
        self.assertIn("`evod fork`", done.stdout)

    def test_other_files_are_refused(self):
        for path, words in ((f"{self.folder}/nothing.evod", "no such file"), (__file__, "not"),
                            (self.folder, "folder")):
            done = waiting.run([EVOD, "replay", path], capture_output=True, text=True)
            self.assertEqual(done.returncode, 1)
            self.assertIn(words, done.stderr)
        done = waiting.run([EVOD, "replay", self.run_file, "--generation", "9"], capture_output=True, text=True)
        self.assertEqual(done.returncode, 1)
        self.assertIn("--generation: got 9, allowed 1 to 4", done.stderr)
        done = waiting.run([EVOD, "fork", self.run_file, "--at-generation", "9", "--name", "x", "--data",
                            f"{self.folder}/other"], capture_output=True, text=True)
        self.assertEqual(done.returncode, 1)
        self.assertIn("--at-generation: got 9, allowed 1 to 4", done.stderr)


if __name__ == "__main__":
    unittest.main(argv=[sys.argv[0], *sys.argv[4:]])
