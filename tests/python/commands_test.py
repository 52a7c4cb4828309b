"""Everything that can be asked, from the plain face; wrong input; access."""
import concurrent.futures
import contextlib
import os
import pathlib
import resource
import socket
import subprocess
import tempfile
import threading
import unittest
from signal import SIGINT
from unittest import mock

import numpy

import evod
from evod.endpoint import Endpoint
from evod.v1 import commands_pb2 as c, world_pb2 as w
from support import PROGRAM, Server, until
from walk import asked_kinds, walk_all, wait_for


class Commands(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.lab = evod.local(seed=42, experiment={"population_size": 12, "generation_s": 2})
        cls.addClassCleanup(cls.lab.close)

    def refused(self, call, *fields):
        """The error of what is refused; the fields that are at fault are these and no others."""
        with self.assertRaises(evod.Error) as raised:
            call()
        self.assertEqual(sorted(v.field for v in raised.exception.violations), sorted(fields), raised.exception)
        for violation in raised.exception.violations:
            self.assertTrue(violation.allowed and violation.got, violation)
        return raised.exception

    def test_every_kind_of_request_can_be_asked(self):
        with tempfile.TemporaryDirectory() as data, evod.local(seed=1, data=data) as lab:
            kinds = asked_kinds(lab)
            wait_for(walk_all(lab))
        self.assertEqual(kinds, set(field.name for field in c.Request.DESCRIPTOR.oneofs_by_name["kind"].fields))

    def test_every_parameter_reads_and_sets_as_an_attribute(self):
        world = self.lab.create_world("attributes")
        registry, now = self.lab.registry(), world.get_parameters()
        self.assertEqual(list(now), list(registry))
        self.assertEqual(set(registry) - set(dir(world.parameters)), set())
        for name, description in registry.items():
            self.assertTrue(description.help and description.allowed and description.effect, name)
            self.assertEqual(getattr(now, name), description.default)
        for name in ("mutation_chance", "population_size", "respawn", "selection"):
            value = {"real": 0.25, "count": 20, "flag": False, "choice": "random"}[registry[name].kind]
            setattr(world.parameters, name, value)
            parameter = world.parameters[name]
            self.assertEqual(parameter.pending if parameter.pending is not None else parameter.value, value)
        with self.assertRaisesRegex(AttributeError, "did you mean mutation_chance"):
            world.parameters.mutation_chanc
        self.assertIn("Organisms on each island.", world.parameters._repr_html_())
        world.delete()

    def test_what_is_out_of_range_is_not_even_sent_and_told_as_the_server_tells_it(self):
        world = self.lab.world()
        wrong = {"mutation_chance": 1.5, "elite_count": -1, "selection": "best", "respawn": "yes", "no_such": 1,
                 "population_size": 2.5, "tick_s": float("nan"), "mutation_step": True, "survivors": "half"}
        kinds = asked_kinds(self.lab)
        error = self.refused(lambda: world.set(wrong), *(f"set_parameters.{name}" for name in wrong))
        self.assertNotIn("set_parameters", kinds)
        self.assertEqual(error.code_name, "INVALID_ARGUMENT")
        got = {violation.field: violation.got for violation in error.violations}
        for name, text in {"respawn": "'yes'", "mutation_step": "True", "survivors": "'half'", "population_size": "2.5",
                           "mutation_chance": "1.5", "selection": "best"}.items():
            self.assertEqual(got[f"set_parameters.{name}"], text)
        by_name = {"mutation_chance": w.ParameterValue(real=1.5), "selection": w.ParameterValue(choice="best")}
        assignments = [w.ParameterAssignment(name=name, value=value) for name, value in by_name.items()]
        told = self.refused(lambda: self.lab.request(set_parameters=c.SetParameters(parameters=assignments)),
                            *(f"set_parameters.{name}" for name in by_name))
        self.assertEqual(set(told.violations) - set(error.violations), set())
        self.assertEqual(told.message, error.message)

    def test_numbers_of_numpy_are_numbers(self):
        world = self.lab.world()
        parameters = world.set(mutation_chance=numpy.float32(0.5), elite_count=numpy.int64(3), respawn=numpy.True_,
                               mutation_step=numpy.int8(7), dry_run=True)
        self.assertEqual((parameters.mutation_chance, parameters.elite_count, parameters.mutation_step), (0.5, 3, 7))
        self.assertNotEqual(world.parameters.elite_count, 3)

    def test_what_only_the_server_can_judge_is_told_too(self):
        world = self.lab.world()
        self.refused(lambda: world.set(tournament_winners=9), "set_parameters.tournament_size")
        self.refused(lambda: world.set(mutation_chance=0.1, expected_revision=77), "set_parameters.expected_revision")
        self.refused(lambda: self.lab.create_world("../x"), "create_world.name")
        self.refused(lambda: world.run(generations=0), "run.generations")
        self.refused(lambda: world.run(generations=-1), "run.generations")
        self.refused(lambda: world.run(generations=1.5), "run.generations")
        self.refused(lambda: world.set_speed(0), "set_speed.speed.real_time_factor")
        self.refused(lambda: world.set_speed("fast"), "set_speed.speed")
        self.refused(lambda: world.snapshots(rate_hz=0), "subscribe_snapshots.rate_hz")
        self.refused(lambda: world.snapshots(detail="all"), "view.detail")
        self.refused(lambda: world.snapshots(region=(0, 0, 1)), "view.region")
        self.refused(lambda: world.export("organism"), "export_run.table")
        self.refused(lambda: world.step(-1), "run_until_tick.tick")
        self.refused(lambda: world.step("one"), "run_until_tick.tick")
        self.refused(lambda: world.organism(-1, island=2**32), "get_organism.organism", "get_organism.island")
        self.refused(lambda: world.reset(seed=2**64), "reset_world.seed")
        self.refused(lambda: world.fork(7), "fork_world.name")
        self.refused(lambda: world.history(first=0.5), "get_history.first_generation")
        self.refused(lambda: world.export("lineage", of=(1, -1, 2)), "export_run.of.island")
        self.refused(lambda: world.snapshots(region=(0, 0, "1", 1)), "view.region.width_px")
        self.refused(lambda: world.snapshots(bytes_per_s_max=-1), "view.bytes_per_s_max")
        with self.assertRaisesRegex(evod.Error, "NOT_FOUND: there is no world 'nowhere'; the worlds are: default"):
            self.lab.world("nowhere")
        with self.assertRaises(evod.Error) as raised:
            world.organism(12)
        self.assertEqual(raised.exception.code_name, "NOT_FOUND")
        with self.assertRaisesRegex(evod.Error, "FAILED_PRECONDITION") as raised:
            world.resume()
        self.assertEqual(raised.exception.reason, c.REASON_NOTHING_TO_RESUME)
        self.assertEqual([info.name for info in self.lab.worlds()], ["default"])

    def test_a_local_server_keeps_its_runs_while_it_is_there(self):
        with evod.local(seed=3, experiment={"population_size": 20, "generation_s": 1}) as lab:
            world = lab.create_world("other", {"population_size": 20, "generation_s": 1})
            self.assertTrue(world.info().speed.max, "worlds that are created have the speed of local(), too")
            world.run(generations=3).wait()
            with world.open_replay(generation=2) as past:
                self.assertEqual(past.info().generation, 2)
            self.assertEqual(world.fork("twin", at_generation=2).info().generation, 2)
            self.assertEqual(len(world.table("generations")), 3)
            folder = next(line.split(" kept in ")[1] for line in lab.log.splitlines() if " kept in " in line)
            self.assertTrue(os.path.isdir(folder))
        self.assertFalse(os.path.exists(folder))

    def test_a_world_begins_with_the_population_it_is_given(self):
        genes = numpy.linspace(90, 110, 4 * 6).reshape(4, 6)
        world = self.lab.create_world("given", {"population_size": 4}, population=[genes])
        numpy.testing.assert_array_equal(world.population().genes, genes.astype("f4"))
        world.delete()
        self.refused(lambda: self.lab.create_world("given", {"population_size": 4}, population=[genes[:3]]),
                     "create_world.population[0]")

    def test_many_threads_share_a_connection(self):
        world = self.lab.create_world("shared", speed="max")
        with world.snapshots(rate_hz=120) as snapshots, concurrent.futures.ThreadPoolExecutor(8) as pool:
            run = world.run()
            seen = pool.submit(lambda: [next(snapshots).tick for _ in range(20)])
            ended = pool.submit(lambda: [next(run).number for _ in range(20)])
            asked = [pool.submit(world.organism, i % 50) for i in range(300)]
            self.assertEqual([answer.result().id for answer in asked], [i % 50 for i in range(300)])
            self.assertEqual(ended.result(), list(range(1, 21)))
            self.assertEqual(seen.result(), sorted(seen.result()))
        world.delete()

    def test_files_with_large_numbers_are_no_matter(self):
        limits = resource.getrlimit(resource.RLIMIT_NOFILE)
        resource.setrlimit(resource.RLIMIT_NOFILE, (min(2000, limits[1]), limits[1]))
        self.addCleanup(resource.setrlimit, resource.RLIMIT_NOFILE, limits)
        with contextlib.ExitStack() as files:
            for _ in range(1100):
                files.enter_context(open("/dev/null"))
            with evod.connect(self.lab.address) as lab:
                self.assertEqual([info.name for info in lab.worlds()], ["default"])

    def test_an_interrupt_leaves_the_connection_whole(self):
        events = self.lab.world().events()
        for _ in range(3):
            def interrupt():
                until(lambda: self.lab._link._inner._waiters, "it waits")
                os.kill(os.getpid(), SIGINT)

            waits = threading.Thread(target=interrupt)
            waits.start()
            with self.assertRaises(KeyboardInterrupt):
                next(events)
            waits.join()
            self.assertEqual([info.name for info in self.lab.worlds()], ["default"])
        events.close()

    def test_closing_ends_what_waits(self):
        lab = evod.connect(self.lab.address)
        events, failures = lab.world().events(), []

        def wait():
            try:
                next(events)
            except evod.NoConnection as error:
                failures.append(error.message)

        waiting = threading.Thread(target=wait)
        waiting.start()
        until(lambda: lab._link._inner._waiters, "it waits")
        lab.close()
        waiting.join()
        self.assertEqual(failures, ["the connection was closed here"])
        with self.assertRaisesRegex(evod.NoConnection, "closed here"):
            lab.worlds()
        lab.close()


class Reaching(unittest.TestCase):
    def test_addresses(self):
        for text, host, port in (("lab", "lab", 7744), ("lab:1", "lab", 1), ("::1", "::1", 7744), ("[::1]:65535", "::1", 65535)):
            self.assertEqual(Endpoint.parse(text), Endpoint(host, port))
        for text in ("", ":1", "lab:", "lab:0", "lab:65536", "lab:x", "lab:1²", "[::1", "[::1]x", "[::1]:"):
            with self.assertRaisesRegex(evod.Error, "server: got .*, allowed HOST, HOST:PORT"):
                Endpoint.parse(text)

    def test_no_server_and_no_evod(self):
        with self.assertRaisesRegex(evod.NoConnection, "no server at 127.0.0.1:1: start one with `evod`"):
            evod.connect("127.0.0.1:1")
        with self.assertRaisesRegex(evod.Error, "there is no program no-such-evod"):
            evod.local(program="no-such-evod")
        with self.assertRaisesRegex(evod.Error, "evod did not start: .*population_size"):
            evod.local(experiment={"population_size": 0})

    def test_what_is_no_evod_is_told_of_and_not_tried_again(self):
        with socket.create_server(("127.0.0.1", 0)) as other:
            def greet():
                with other.accept()[0] as line:
                    line.sendall(b"220 mail.example ESMTP\r\n")
                    line.recv(100)
            threading.Thread(target=greet).start()
            with self.assertRaisesRegex(evod.DamagedData, "is not an evod server: a frame begins with 32 32, not with 45 56"):
                evod.connect("127.0.0.1:%d" % other.getsockname()[1])

    def test_a_local_server_ends_with_its_program_however_that_ends(self):
        script = ("import evod, os, signal; lab = evod.local(); print(lab.address, flush=True); "
                  "os.kill(os.getpid(), signal.SIGKILL)")
        done = subprocess.run(["/usr/bin/python3", "-c", script], capture_output=True, text=True)
        until(lambda: self.is_gone(done.stdout.strip()), "the server is gone")

    def test_a_local_server_that_is_forgotten_ends_but_not_before(self):
        lab = evod.local(experiment={"population_size": numpy.int64(7)})
        address, run = lab.address, lab.world().run(1)
        del lab
        self.assertEqual(next(run).organism_count, 7)
        self.assertFalse(self.is_gone(address))
        del run
        until(lambda: self.is_gone(address), "the server is gone")

    def is_gone(self, address):
        try:
            evod.connect(address).close()
        except evod.NoConnection:
            return True
        return False


class Access(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)
        self.options = ["--data", str(self.folder)]

    def token(self, name, role):
        command = [PROGRAM, "token", "add", name, "--role", role, *self.options]
        return subprocess.run(command, capture_output=True, text=True, check=True).stdout.split()[-1]

    def serve(self, *options):
        server = Server(*self.options, *options)
        self.addCleanup(server.kill)
        return f"localhost:{server.port}"

    def test_tokens(self):
        viewer = self.token("anna", "viewer")
        address = self.serve("--require-token")
        with evod.connect(address, token=viewer) as lab:
            self.assertEqual((lab.role, lab.welcome.user), ("viewer", "anna"))
            with self.assertRaisesRegex(evod.Error, "PERMISSION_DENIED"):
                lab.world().run()
        file = self.folder / "token"
        file.write_text(viewer + "\n")
        file.chmod(0o600)
        evod.connect(address, token_file=str(file)).close()
        file.chmod(0o644)
        with self.assertRaisesRegex(evod.Error, "other users can read it: chmod 600 it"):
            evod.connect(address, token_file=str(file))
        os.environ["EVOD_TOKEN"] = viewer
        self.addCleanup(os.environ.pop, "EVOD_TOKEN")
        evod.connect(address).close()
        with self.assertRaises(evod.NoConnection) as raised:
            evod.connect(address, token="")
        self.assertEqual(raised.exception.code_name, "UNAUTHENTICATED")

    def test_a_token_that_is_revoked_ends_what_waits(self):
        token = self.token("otto", "admin")
        lab = evod.connect(self.serve("--require-token"), token=token)
        self.addCleanup(lab.close)
        waiting = lab.world().events()
        subprocess.run([PROGRAM, "token", "revoke", "otto", *self.options], check=True, capture_output=True)
        with self.assertRaises(evod.NoConnection) as raised:
            next(waiting)
        self.assertEqual(raised.exception.code_name, "UNAUTHENTICATED")

    def test_a_local_server_needs_none_of_it(self):
        with mock.patch.dict(os.environ, EVOD_TOKEN="wrong", EVOD_CA="/no/such.pem"):
            evod.local().close()

    def test_tls_and_certificates_of_both_ends(self):
        subprocess.run([PROGRAM, "certificate", "localhost"], cwd=self.folder, check=True, capture_output=True)
        ca, key = str(self.folder / "evod.crt"), str(self.folder / "evod.key")
        secured = ["--tls-cert", ca, "--tls-key", key]
        address = self.serve(*secured, "--seed", "1")
        with evod.connect(address, ca=ca) as lab, lab.world().snapshots() as snapshots:
            self.assertEqual(len(next(snapshots).organisms), 50)
        with mock.patch.dict(os.environ, EVOD_CA=ca):
            evod.connect(address).close()
        with self.assertRaisesRegex(evod.NoConnection, "its certificate is not trusted"):
            evod.connect(address, tls=True)
        with self.assertRaisesRegex(evod.Error, "no-such.pem cannot be used for TLS: No such file"):
            evod.connect(address, ca="no-such.pem")
        with self.assertRaisesRegex(evod.Error, "key is given without cert"):
            evod.connect(address, key=key)
        with self.assertRaises(evod.NoConnection):
            evod.connect(address)
        with evod.local() as clear, self.assertRaisesRegex(evod.NoConnection, "no TLS with .*: wrong version number"):
            evod.connect(clear.address, tls=True)

    def test_a_server_that_wants_a_certificate(self):
        subprocess.run([PROGRAM, "certificate", "localhost"], cwd=self.folder, check=True, capture_output=True)
        ca, key = str(self.folder / "evod.crt"), str(self.folder / "evod.key")
        address = self.serve("--tls-cert", ca, "--tls-key", key, "--tls-client-ca", ca)
        evod.connect(address, ca=ca, cert=ca, key=key).close()
        with self.assertRaises(evod.NoConnection):
            evod.connect(address, ca=ca)


if __name__ == "__main__":
    unittest.main()
