"""Real servers with too little memory or file size. EVOD and MESSAGES as recovery_test has them."""
import os
import resource
import tempfile
import unittest

import waiting
from recovery_test import Client, Server, c, evod, journal, session_pb2, set_parameter, until, w

RESOURCE_EXHAUSTED, UNAVAILABLE = 8, 14
OUT_OF_MEMORY = 3  # the exit status of evod


class ResourceLimits(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.data, self.servers = folder.name, []

    def tearDown(self):
        for server in self.servers:
            if server.process.poll() is None:
                server.kill()
            server.log.close()

    def serve(self, *options, **popen):
        self.servers.append(Server("--data", self.data, *options, **popen))
        return self.servers[-1]

    def verify(self, world="default"):
        done = waiting.run([evod, "verify", f"{self.data}/{world}.evod"], capture_output=True, text=True)
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)

    def allow_memory(self, server, more_bytes):
        """Limits the memory to so many bytes above the current use."""
        with open(f"/proc/{server.process.pid}/statm") as statm:
            present = int(statm.read().split()[0]) * resource.getpagesize()
        resource.prlimit(server.process.pid, resource.RLIMIT_AS, (present + more_bytes, resource.RLIM_INFINITY))

    @staticmethod
    def crowd(name, organisms):
        def number(name, value):
            return w.ParameterAssignment(name=name, value=w.ParameterValue(count=value))
        return {"create_world": c.CreateWorld(name=name, seed=1, parameters=[
            number("population_size", organisms), number("reference_population", 50),
            w.ParameterAssignment(name="scale_with_population", value=w.ParameterValue(flag=True))])}

    def test_a_world_without_memory_for_it_is_refused(self):
        server = self.serve("--seed", "5", "--speed", "max")
        with Client(server, "k") as client:
            client.call(1, run_until_tick=c.RunUntilTick(tick=500))
            until(lambda: client.world().tick == 500, "tick 500")
            before = client.world()
            self.allow_memory(server, 100 << 20)
            refused = client.call(2, **self.crowd("crowd", 4_000_000))
            self.assertEqual(refused.status.code, RESOURCE_EXHAUSTED, refused)
            self.assertIn("not enough memory: nothing was changed", refused.status.message)
            self.assertIsNone(client.world("crowd"))
            now = client.world()
            self.assertEqual((now.tick, now.state_hash), (before.tick, before.state_hash))
            self.assertEqual(client.call(3, **set_parameter("food_health", 7)).status.code, 0)
            self.assertEqual(client.call(4, fork_world=c.ForkWorld(world="default", name="fork")).status.code, 0)
        server.end()
        self.verify()
        self.verify("fork")

    def test_out_of_memory_a_server_exits_and_resumes_later(self):
        server = self.serve("--seed", "5")
        with Client(server, "k") as client:
            self.assertEqual(client.call(1, **set_parameter("food_health", 7)).status.code, 0)
            self.assertEqual(client.call(2, **self.crowd("crowd", 400_000)).status.code, 0)
            client.call(3, set_speed=c.SetSpeed(world="crowd", speed=w.Speed(max=True)))
            self.allow_memory(server, 0)
            client.send(session_pb2.ClientMessage(request=c.Request(
                request_id=4, client_key=client.key, run=c.Run(world="crowd"))))
            self.assertEqual(waiting.ended(server.process), OUT_OF_MEMORY, server.output())
        self.assertRegex(server.output(), r"error.* out of memory.*: evod is shutting down; restart it to resume the "
                                          r"runs")
        server = self.serve()
        with Client(server, "k") as client:
            self.assertEqual(client.call(1, **set_parameter("food_health", 7)).status.code, 0)
            self.assertEqual(client.world("crowd").name, "crowd")
        server.end()
        self.assertEqual([row[3] for row in journal(self.data) if row[2] == "k"], [1])
        self.verify("crowd")

    def test_a_file_that_may_not_grow_is_a_disk_that_fails(self):
        bytes_max = 512 << 10
        server = self.serve("--seed", "5", "--speed", "max", preexec_fn=lambda: resource.setrlimit(
            resource.RLIMIT_FSIZE, (bytes_max, resource.RLIM_INFINITY)))
        with Client(server, "k") as client:
            self.assertEqual(client.call(1, run=c.Run()).status.code, 0)
            until(lambda: "commands are refused until the file can be written again" in server.output(), "trouble")
            self.assertEqual(client.call(2, **set_parameter("food_health", 7)).status.code, UNAVAILABLE)
            self.assertIn(client.world().storage.state, (w.STORAGE_STATE_FAILING, w.STORAGE_STATE_STALLED))
            resource.prlimit(server.process.pid, resource.RLIMIT_FSIZE,
                             (resource.RLIM_INFINITY, resource.RLIM_INFINITY))
            until(lambda: "run files can be written again" in server.output(), "the end of the trouble")
            self.assertEqual(client.call(2, **set_parameter("food_health", 7)).status.code, 0)
            self.assertEqual(client.call(3, pause=c.Pause()).status.code, 0)
            last = client.world()
        server.end()
        self.verify()
        server = self.serve()
        with Client(server, "k") as client:
            now = client.world()
            self.assertEqual((now.tick, now.state_hash), (last.tick, last.state_hash))
        server.end()


if __name__ == "__main__":
    unittest.main()
