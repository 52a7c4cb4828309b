"""Monitoring of a server: /metrics and /healthz over HTTP, GetMetrics, evoctl top and the log. EVOD and EVOCTL name the
programs, MESSAGES the folder of the message classes."""
import contextlib
import ctypes
import http.client
import json
import os
import pathlib
import re
import resource
import signal
import socket
import subprocess
import sys
import time
import unittest

import access_test as access
import past_test as past
import waiting
from past_test import EVOD, EVOCTL, c, plain

SIMULATION_S = 3  # the simulation must respond within this time, else /healthz fails
OPERATIONS = pathlib.Path(__file__).resolve().parents[2] / "docs" / "OPERATIONS.md"
NAME, UNESCAPED = r"[a-zA-Z_:][a-zA-Z0-9_:]*", {r"\\": "\\", r"\"": '"', r"\n": "\n"}
LABEL = rf'({NAME})="((?:[^"\\\n]|\\[\\"n])*)"'


class Metrics:
    """Strictly parses a page in Prometheus's text format 0.0.4."""

    def __init__(self, page):
        self.types, self.help, self.samples = {}, {}, {}
        assert page.endswith("\n")
        for line in page.splitlines():
            if answer := re.fullmatch(rf"# (HELP|TYPE) ({NAME}) (.*)", line):
                where = self.help if answer[1] == "HELP" else self.types
                assert answer[2] not in where, line
                where[answer[2]] = answer[3]
                continue
            sample = re.fullmatch(rf"({NAME})(?:{{({LABEL}(?:,{LABEL})*)}})? (\S+)", line)
            assert sample, line
            family = sample[1] if sample[1] in self.types else re.sub("_(bucket|sum|count)$", "", sample[1])
            assert family in self.types and (family == sample[1] or self.types[family] == "histogram"), line
            labels = frozenset((name, re.sub(r'\\[\\"n]', lambda e: UNESCAPED[e[0]], value))
                               for name, value in re.findall(LABEL, sample[2] or ""))
            assert (sample[1], labels) not in self.samples, line
            self.samples[sample[1], labels] = float(sample[sample.re.groups])

    def __call__(self, name, **labels):
        return self.samples[name, frozenset(labels.items())]

    def names(self):
        return set(self.types)


class Case(past.Case):
    def serve(self, *options, **popen):
        return self.server("--data", self.folder, "--http-port", "0", *options, **popen)

    def http(self, server):
        if not hasattr(server, "http_port"):
            server.http_port = int(re.search(r"http://127\.0\.0\.1:(\d+)/metrics", server.output())[1])
        return http.client.HTTPConnection("127.0.0.1", server.http_port, timeout=waiting.LONGEST_S)

    def get(self, server, path="/metrics", method="GET", **arguments):
        """Returns the answer; repeats the request if the server closes the connection without one.

        The server does so after http_request_timeout_s, which a stall of the machine can exceed, and while the
        connections of a crowd end.
        """
        arguments.setdefault("headers", {"Authorization": f"Bearer {server.token}"} if hasattr(server, "token") else {})

        def answer():
            with contextlib.suppress(ConnectionError), contextlib.closing(self.http(server)) as connection:
                connection.request(method, path, **arguments)
                answer = connection.getresponse()
                answer.text = answer.read().decode()
                return answer
        return plain.until(answer, f"an answer to {method} {path}")

    def metrics(self, server):
        answer = self.get(server)
        self.assertEqual((answer.status, answer.headers["Content-Type"]),
                         (200, "text/plain; version=0.0.4; charset=utf-8"))
        return Metrics(answer.text)

    def wait_well(self, server):
        """Waits for health: after a stall of the machine by SIMULATION_S a server is briefly unhealthy."""
        plain.until(lambda: self.get(server, "/healthz").status == 200, "health")

    def wait(self, server, condition, what):
        def look():
            metrics = self.metrics(server)
            with contextlib.suppress(KeyError):  # not there yet
                return metrics if condition(metrics) else None
        return plain.until(look, what)

    def raw(self, server, data):
        self.http(server)
        connection = socket.create_connection(("127.0.0.1", server.http_port))
        self.addCleanup(connection.close)
        connection.settimeout(waiting.LONGEST_S)
        connection.sendall(data)
        return connection

    def evoctl(self, server, *words, status=0):
        done = waiting.run([EVOCTL, "--server", f"127.0.0.1:{server.port}", *waiting.PATIENT, *words],
                           capture_output=True, text=True)
        self.assertEqual(done.returncode, status, done.stdout + done.stderr)
        return done.stdout


def read_all(connection):
    """Sends until the server closes the connection, perhaps within a request."""
    data = b""
    with contextlib.suppress(ConnectionResetError):
        while more := waiting.receive(connection, 65536):
            data += more
    return data


def catches(process, number):
    caught = re.search(r"^SigCgt:\s+([0-9a-f]+)", pathlib.Path(f"/proc/{process}/status").read_text(), re.M)[1]
    return bool(int(caught, 16) >> (number - 1) & 1)


@contextlib.contextmanager
def stopped(thread):
    """Stops one thread of a child with ptrace; skips the test if that is not allowed."""
    libc, seize, interrupt, detach = ctypes.CDLL(None, use_errno=True), 0x4206, 0x4207, 17

    def ptrace(request):
        return libc.ptrace(ctypes.c_long(request), ctypes.c_long(thread), None, None)
    if ptrace(seize) != 0 or ptrace(interrupt) != 0:
        raise unittest.SkipTest("no thread may be stopped here: " + os.strerror(ctypes.get_errno()))
    os.waitpid(thread, 0x40000000)  # __WALL
    try:
        yield
    finally:
        ptrace(detach)


class Counts(Case):
    def test_a_world_that_runs(self):
        server = self.serve("--speed", "max", "--start")
        first = self.wait(server, lambda m: m("evod_ticks_per_second", world="default") > 0, "a figure")
        self.assertEqual(first.types["evod_tick_seconds"], "histogram")
        self.assertEqual(first("evod_worlds"), 1)
        last = self.wait(server, lambda m: m("evod_ticks_total", world="default") >
                         first("evod_ticks_total", world="default"), "more ticks")
        buckets = sorted((float(dict(labels)["le"]), value) for (name, labels), value in last.samples.items()
                         if name == "evod_tick_seconds_bucket")
        self.assertEqual((len(buckets), buckets[-1][0]), (23, float("inf")))
        self.assertEqual([value for _, value in buckets], sorted(value for _, value in buckets))
        self.assertEqual(buckets[-1][1], last("evod_tick_seconds_count", world="default"))
        self.assertGreater(last("evod_tick_seconds_sum", world="default"), 0)
        with self.client(server) as client:
            client.call(pause=c.Pause())
            ticks = client.world().tick
            at_rest = self.wait(server, lambda m: m("evod_ticks_per_second", world="default") == 0, "rest")
            self.assertEqual(at_rest("evod_ticks_total", world="default"), ticks)

    def test_the_species_of_a_colony(self):
        experiment = pathlib.Path(self.folder) / "default.json"
        experiment.write_text(json.dumps({"reproduction": "births", "births": "asexual", "population_size": 40,
                                          "predator_count": 6, "birth_health": 120, "food_count": 60,
                                          "generation_s": 2}))
        server = self.serve("--experiment", str(experiment), "--seed", "1")
        self.assertNotIn("evod_colony_organisms", {name for name, _ in self.metrics(server).samples})
        with self.client(server) as client:
            client.run_to(3 * 120)
            last = client.call(get_statistics=c.GetStatistics(world="default")).statistics.last[0]
            history = client.call(get_history=c.GetHistory(world="default")).history.generations
        metrics = self.wait(server, lambda m: m("evod_ticks_total", world="default") == 360, "all ticks")
        for species, of in (("prey", last), ("predators", last.predators)):
            self.assertEqual(metrics("evod_colony_organisms", world="default", species=species), of.alive_count)
        self.assertEqual(metrics("evod_colony_births_total", world="default", species="prey"),
                         sum(one.colony.born_count for one in history))

    def test_snapshots_that_are_given_away(self):
        server = self.serve("--speed", "max", "--start")
        with self.client(server) as client:
            before = self.wait(server, lambda m: m("evod_ticks_total", world="default") > 0, "a tick")
            self.assertEqual(before("evod_snapshot_seconds_count", world="default"), 0)
            client.call(subscribe_snapshots=c.SubscribeSnapshots(world="default", rate_hz=20))
            after = self.wait(server, lambda m: m("evod_snapshot_seconds_count", world="default") > 3, "snapshots")
            self.assertEqual(after.types["evod_snapshot_seconds"], "histogram")
            self.assertGreater(after("evod_snapshot_seconds_sum", world="default"), 0)

    def test_worlds_come_and_go(self):
        server = self.serve()
        with self.client(server) as client:
            client.call(create_world=c.CreateWorld(name="lesson"))
            client.call(run_until_tick=c.RunUntilTick(world="lesson", tick=5))
            self.wait(server, lambda m: m("evod_worlds") == 2 and m("evod_ticks_total", world="lesson") == 5, "a world")
            client.call(delete_world=c.DeleteWorld(world="lesson"))
            gone = self.wait(server, lambda m: m("evod_worlds") == 1, "one less")
            self.assertNotIn(("evod_ticks_total", frozenset({("world", "lesson")})), gone.samples)

    def test_looks_at_the_past_are_no_worlds(self):
        server = self.serve("--speed", "max")
        with self.client(server) as client:
            client.call(run_until_tick=c.RunUntilTick(tick=100))
            plain.until(lambda: client.world().tick == 100, "ticks")
            client.call(open_replay=c.OpenReplay())
            self.assertEqual(self.metrics(server)("evod_worlds"), 1)

    def test_the_traffic_of_subscribers_is_counted(self):
        crowd = pathlib.Path(self.folder) / "crowd.json"
        crowd.write_text('{"population_size": 3000, "scale_with_population": true, "reference_population": 50}')
        server = self.serve("--experiment", str(crowd), "--speed", "max", "--start")
        before = self.metrics(server)
        with self.client(server) as reads, self.client(server) as sleeps:
            reads.call(subscribe_snapshots=c.SubscribeSnapshots(rate_hz=30))
            for _ in range(5):
                reads.next_snapshot()
            taken = self.metrics(server)
            self.assertGreaterEqual(taken("evod_snapshots_sent_total"), 5)
            self.assertEqual(taken("evod_subscriptions", to="snapshots"), 1)
            for name, labels in (("evod_sent_bytes_total", {"channel": "stream"}), ("evod_received_bytes_total", {}),
                                 ("evod_sent_bytes_total", {"channel": "control"}), ("evod_requests_total", {})):
                self.assertGreater(taken(name, **labels), before(name, **labels), name)
            self.assertGreater(taken("evod_sent_bytes_total", channel="stream"), 5 * 3000)
            reads.socket.close()
            # A generation per tick causes many events, and many islands make them long.
            made = plain.set_parameters(population_size=5, island_count=16, fitness="gene_sum").parameters
            sleeps.call(create_world=c.CreateWorld(name="events", parameters=made))
            sleeps.call(set_speed=c.SetSpeed(world="events", speed=plain.w.Speed(max=True)))
            sleeps.call(subscribe_snapshots=c.SubscribeSnapshots(world="crowd", rate_hz=120))
            sleeps.call(subscribe_events=c.SubscribeEvents())
            sleeps.ask(run=c.Run(world="events"))
            dropped = self.wait(server, lambda m: m("evod_snapshots_dropped_total") > 100 and
                                m("evod_events_dropped_total") > 0, "drops")
            self.assertGreater(dropped("evod_client_buffer_bytes"), 0)
            self.assertEqual(dropped("evod_subscriptions", to="events"), 1)

    def test_the_disk(self):
        server = self.serve("--speed", "max", "--start")
        metrics = self.wait(server, lambda m: m("evod_storage_state", state="keeps_up") == 1 and
                            m("evod_journal_lag_seconds") > 0, "something on its way to the disk")
        self.assertEqual(metrics("evod_journal_waiting_bytes_max"), 64 << 20)
        self.assertEqual(sum(value for (name, _), value in metrics.samples.items() if name == "evod_storage_state"), 1)
        with self.client(server) as client:
            def command():
                client.call(set_parameters=plain.set_parameters(mutation_chance=0.3))
            command()  # the commands of the start are on the disk before this one
            before = self.metrics(server)
            for _ in range(3):
                command()
        after = self.metrics(server)
        self.assertEqual(after("evod_journal_wait_seconds_count"), before("evod_journal_wait_seconds_count") + 3)
        self.assertGreaterEqual(after("evod_journal_commit_seconds_count"),
                                before("evod_journal_commit_seconds_count") + 3)
        self.assertGreater(after("evod_journal_wait_seconds_sum"), before("evod_journal_wait_seconds_sum"))
        keeps_nothing = self.server("--keep-nothing", "--http-port", "0")
        self.assertNotIn("evod_storage_state", self.metrics(keeps_nothing).names())

    def test_the_process(self):
        server = self.serve(env=os.environ | {"EVOD_INSTRUCTIONS": "baseline"})
        metrics = self.metrics(server)
        status = pathlib.Path(f"/proc/{server.process.pid}/status").read_text()
        resident = int(re.search(r"VmRSS:\s+(\d+) kB", status)[1]) * 1024
        self.assertLess(abs(metrics("process_resident_memory_bytes") - resident), resident / 2)
        self.assertLess(abs(metrics("process_start_time_seconds") - time.time()), 3600)
        # Listing the descriptors opens one more, and a new server opens and closes files.
        self.wait(server, lambda m: abs(m("process_open_fds") - len(os.listdir(f"/proc/{server.process.pid}/fd"))) < 4,
                  "as many as are open")
        threads = [value for (name, _), value in metrics.samples.items() if name == "evod_thread_cpu_seconds_total"]
        self.assertEqual(len(threads), 5)  # network, simulation, replays, storage, packing
        self.assertLessEqual(max(threads), metrics("process_cpu_seconds_total") + 1)
        version = waiting.run([EVOD, "--version"], capture_output=True, text=True).stdout.split()[1]
        self.assertEqual(metrics("evod_build_info", version=version, instructions="baseline"), 1)

    def test_a_replay_has_metrics_too(self):
        server = self.serve("--speed", "max")
        with self.client(server) as client:
            client.call(run_until_tick=c.RunUntilTick(tick=100))
            plain.until(lambda: client.world().tick == 100, "ticks")
        server.end()
        replay = self.server("replay", f"{self.folder}/default.evod", "--http-port", "0")
        self.wait_well(replay)
        with self.client(replay) as client:
            client.call(run_until_tick=c.RunUntilTick(tick=50))
            self.wait(replay, lambda m: m("evod_ticks_total", world="default") == 50, "ticks of the replay")

    def test_the_documentation_lists_every_metric(self):
        listed = dict(re.findall(r"^\| `([a-z_]+)` \| (counter|gauge|histogram) \|", OPERATIONS.read_text(), re.M))
        self.assertEqual(listed, self.metrics(self.serve()).types)


class Clients(Case, access.Access):
    def test_sessions_by_role_and_failed_logins(self):
        secrets = {name: self.token(name, role) for role, name in access.NAMES.items()}
        server = self.serve("--require-token")
        server.token = secrets["admin"]
        came = [self.come(server, secrets[name]) for name in ("viewer", "viewer", "controller", "admin")]

        def stay_silent(_):
            with socket.create_connection(("127.0.0.1", server.port)):
                return self.wait(server, lambda m: m("evod_sessions", role="none") == 1, "one who says nothing")
        metrics = waiting.quicker_than(came[0].welcome.limits.hello_timeout_s, stay_silent)
        self.assertEqual({role: metrics("evod_sessions", role=role) for role in secrets},
                         {"viewer": 2, "teacher": 0, "controller": 1, "admin": 1})
        self.assertEqual(metrics("evod_logins_failed_total"), 0)
        self.come(server, "evod_" + "0" * 64, come_from="127.0.0.2")
        self.come(server, come_from="127.0.0.3")  # a missing token is not a failed login
        self.assertEqual(self.wait(server, lambda m: m("evod_logins_failed_total") > 0,
                                   "it")("evod_logins_failed_total"), 1)

    def test_a_viewer_may_query_metrics(self):
        secret = self.token("anna", access.VIEWER)
        server = self.serve("--require-token")
        server.token = secret
        viewer = self.come(server, secret)
        answer = viewer.call(get_metrics=c.GetMetrics()).metrics
        page = self.metrics(server)
        self.assertEqual({family.name for family in answer.families}, page.names())
        for family in answer.families:
            self.assertEqual(family.help, page.help[family.name])
            for sample in family.samples:
                if family.kind == c.METRIC_KIND_HISTOGRAM:
                    self.assertEqual(len(sample.histogram.counts), len(sample.histogram.bounds) + 1)
        self.assertNotIn("anna", self.get(server).text)


class Health(Case):
    def test_health_fails_while_the_disk_fails(self):
        # A file that must not grow is a failing disk. The signal that comes with it is ignored.
        server = self.serve(restore_signals=False, preexec_fn=lambda: signal.signal(signal.SIGXFSZ, signal.SIG_IGN))
        self.wait_well(server)
        _, hard = resource.prlimit(server.process.pid, resource.RLIMIT_FSIZE)
        resource.prlimit(server.process.pid, resource.RLIMIT_FSIZE, (1, hard))
        with self.client(server) as client:
            client.ask(set_parameters=plain.set_parameters(mutation_chance=0.3))
            ill = plain.until(lambda: (lambda a: a if a.status != 200 else None)(self.get(server, "/healthz")),
                              "illness")
            self.assertEqual(ill.status, 503)
            self.assertRegex(ill.text, r"^runs cannot be written: [^\n]*default\.evod[^\n]*\n$")
            self.assertNotIn(self.folder, ill.text)
            metrics = self.wait(server, lambda m: m("evod_storage_state", state="failing") == 1, "a failing disk")
            first = metrics("evod_journal_lag_seconds")
            self.wait(server, lambda m: m("evod_journal_lag_seconds") > max(first, 0.5), "a growing lag")
            self.assertGreater(metrics("evod_journal_waiting_bytes"), 0)
            self.assertIn("failing", self.evoctl(server, "top", "--once", "--interval", "0.1"))
            resource.prlimit(server.process.pid, resource.RLIMIT_FSIZE, (hard, hard))
            self.wait_well(server)
            self.wait(server, lambda m: m("evod_journal_waiting_bytes") == 0 and
                      m("evod_storage_state", state="keeps_up") == 1, "all is written")

    def test_health_fails_while_the_simulation_is_stuck(self):
        server = self.serve()
        waiting.quicker_than(SIMULATION_S, lambda _: self.assertEqual(self.get(server, "/healthz").text, "ok\n"))
        threads = {pathlib.Path(task, "comm").read_text().strip(): int(task.name)
                   for task in pathlib.Path(f"/proc/{server.process.pid}/task").iterdir()}
        with stopped(threads["simulation"]):
            answer = self.get(server, "/healthz")
            self.assertEqual((answer.status, answer.text), (503,
                                                            f"the simulation has not responded for {SIMULATION_S} s\n"))
            self.assertEqual(self.get(server).status, 200)
        self.wait_well(server)


class Http(Case):
    def test_only_existing_pages_can_be_read(self):
        server = self.serve()
        lost = self.get(server, "/nowhere")
        self.assertEqual(lost.status, 404)
        self.assertRegex(lost.text, r"^no such page; available: .*/protocol.bin, /healthz, /metrics, /session\n$")
        for method in ("POST", "PUT", "DELETE", "OPTIONS", "PATCH"):
            refused = self.get(server, method=method, body=b"x" * 100_000 if method in ("POST", "PUT") else None)
            self.assertEqual((refused.status, refused.headers["Allow"]), (405, "GET, HEAD"), method)
            self.assertIn("use GET or HEAD", refused.text)
        plain.until(lambda: self.get(server, "/healthz?full=1").status == 200, "health")
        self.assertEqual(self.get(server, "/healthz", body=b"hello").status, 400)
        head, get = self.get(server, "/healthz", method="HEAD"), self.get(server, "/healthz")
        self.assertEqual((head.status, head.text, head.headers["Content-Length"]),
                         (200, "", get.headers["Content-Length"]))

    def test_a_connection_is_used_again(self):
        server = self.serve()
        with contextlib.closing(self.http(server)) as connection:
            for path in ("/metrics", "/healthz", "/metrics", "/nowhere", "/healthz"):
                connection.request("HEAD" if path == "/nowhere" else "GET", path)
                if path == "/metrics":
                    first = connection.sock
                self.assertIs(connection.sock, first)
                answer = connection.getresponse()
                answer.read()

    def test_pipelined_requests_are_answered_in_order(self):
        server = self.serve()

        def ask(_):
            pipeline = self.raw(server, b"GET /healthz HTTP/1.1\r\nHost: localhost\r\n\r\n" * 20 +
                                b"GET /nowhere HTTP/1.0\r\nHost: localhost\r\n\r\n" +
                                b"GET /healthz HTTP/1.1\r\nHost: localhost\r\n\r\n")
            text = read_all(pipeline)
            self.assertEqual(re.findall(rb"^HTTP/1\.[01] (\d+)", text, re.M), [b"200"] * 20 + [b"404"])
        waiting.quicker_than(SIMULATION_S, ask)

    def test_an_invalid_request_is_answered_and_closed(self):
        server = self.serve()
        for data, status in ((b"\x00\x01\x02\xff" * 100 + b"\r\n\r\n", b"400"),
                             (b"EV\x01\x01\x08\0\0\0abcdefgh\r\n\r\n", b"400"),
                             (b"GET /metrics HTTP/9.9\r\n\r\n", b"400"), (b"GET\r\n\r\n", b"400"),
                             (b"GET /metrics HTTP/1.1\r\nbad header\r\n\r\n", b"400"),
                             (b"GET /metrics HTTP/1.1\r\nContent-Length: -1\r\n\r\n", b"400"),
                             (b"GET /" + b"a" * 20_000 + b" HTTP/1.1\r\n\r\n", b"431"),
                             (b"GET / HTTP/1.1\r\n" + b"x: " + b"y" * 9000 + b"\r\n\r\n", b"431"),
                             (b"GET / HTTP/1.1\r\n" + b"a: b\r\n" * 3000 + b"\r\n", b"431")):
            answer = read_all(self.raw(server, data))
            self.assertRegex(answer, rb"^HTTP/1\.1 " + status, data[:40])
            self.assertTrue(answer.endswith(b"\n") and b"\r\n\r\n" in answer)
            self.wait_well(server)

    def test_no_body_is_read_as_a_request(self):
        server = self.serve()
        inner = b"GET /metrics HTTP/1.1\r\nHost: localhost\r\n\r\n"
        chunked = b"%x\r\n%s\r\n0\r\n\r\n" % (len(inner), inner)
        for fields, body in (("Transfer-Encoding: identity", inner), ("Transfer-Encoding: xchunked", inner),
                             ("Transfer-Encoding: chunked, identity", inner), ("Transfer-Encoding: chunked", chunked),
                             ("transfer-encoding:\tchunked", chunked), ("Transfer-Encoding:", inner),
                             ("Transfer-Encoding: gzip\r\nTransfer-Encoding: identity", inner),
                             (f"Content-Length: {len(inner)}", inner),
                             (f"Content-Length: {len(inner)}\r\nExpect: 100-continue", inner),
                             (f"Content-Length: 0\r\nContent-Length: {len(inner)}", inner),
                             (f"Content-Length: 0, {len(inner)}", inner),
                             ("Content-Length: 0\r\nTransfer-Encoding: chunked", chunked)):
            for path in ("/healthz", "/session", "/nowhere"):
                with self.subTest(fields=fields, path=path):
                    answer = read_all(self.raw(server,
                                               f"GET {path} HTTP/1.1\r\nHost: localhost\r\n{fields}\r\n\r\n".encode() +
                                               body))
                    self.assertEqual(re.findall(rb"^HTTP/1\.[01] (\d+)", answer, re.M), [b"400"])
        # An empty body is none.
        answer = read_all(self.raw(server, b"GET /nowhere HTTP/1.1\r\nHost: localhost\r\nContent-Length: 0\r\nExpect: "
                                           b"100-continue\r\n"
                                           b"Connection: close\r\n\r\n"))
        self.assertEqual(re.findall(rb"^HTTP/1\.[01] (\d+)", answer, re.M), [b"404"])

    @contextlib.contextmanager
    def meets(self, server, limit, at_least=1):
        """The block, given the limit's value, reaches this limit so often."""
        before = self.metrics(server)("evod_limit_reached_total", limit=limit)
        yield plain.limit(limit)
        self.wait(server, lambda m: m("evod_limit_reached_total", limit=limit) >= before + at_least, limit)

    def test_a_header_is_as_long_as_it_may_be(self):
        server = self.serve()

        def status_of(size):
            begin = b"GET /healthz HTTP/1.1\r\nHost: localhost\r\nConnection: close\r\nx: "
            answer = read_all(self.raw(server, begin + b"y" * (size - len(begin) - 4) + b"\r\n\r\n"))
            return int(re.match(rb"HTTP/1\.1 (\d+) ", answer)[1])
        with self.meets(server, "http_header_bytes_max") as limit:
            plain.until(lambda: status_of(limit) == 200, "health")
            self.assertEqual(status_of(limit + 1), 431)

    def test_an_incomplete_request_is_closed(self):
        server = self.serve()
        with self.meets(server, "http_request_timeout_s", 3) as limit:
            began = time.monotonic()
            begun = [self.raw(server, data) for data in (b"", b"GET /metr",
                                                         b"GET /metrics HTTP/1.1\r\nHost: localhost\r\n")]
            for connection in begun:
                self.assertEqual(read_all(connection), b"")
            self.assertGreater(time.monotonic() - began, limit - 0.5)

    def test_too_many_connections_get_503(self):
        server = self.serve()
        self.wait_well(server)  # the threads do not all exist yet when the server listens
        threads = {pathlib.Path(task, "comm").read_text().strip(): int(task.name)
                   for task in pathlib.Path(f"/proc/{server.process.pid}/task").iterdir()}
        request = b"GET /healthz HTTP/1.1\r\nHost: localhost\r\n\r\n"

        def crowd(_):
            self.wait_well(server)
            with self.meets(server, "http_connections_max") as limit, contextlib.ExitStack() as stack:
                def come(count):
                    return [stack.enter_context(contextlib.closing(self.raw(server, request))) for _ in range(count)]
                with stopped(threads["simulation"]):  # so that answers take SIMULATION_S
                    come(limit)
                    text = plain.until(lambda: (lambda one: one if b" 503 " in one and b"open already" in one
                                                else None)(
                        waiting.receive(come(1)[0], 65536)), "too many").decode()
                    self.assertIn(f"{limit} connections are open already", text)
                    plain.until(lambda: read_all(come(1)[0]) == b"", "one is closed at once")
                stack.close()
                self.wait_well(server)
        waiting.quicker_than(plain.limit("http_request_timeout_s"), crowd)

    def test_it_is_closed_with_the_server(self):
        server = self.serve()
        self.raw(server, b"GET /metrics HTTP/1.1\r\n")
        with contextlib.closing(self.http(server)) as connection:
            connection.request("GET", "/healthz")
            connection.getresponse().read()
            server.end()

    def test_it_is_there_only_if_it_was_asked_for(self):
        server = self.server("--data", self.folder)
        self.assertNotIn("http", server.output())
        for words, status, why in ((["--http-bind", "127.0.0.1"], 2, "--http-port"),
                                   (["--http-port", "70000"], 2, "70000"),
                                   (["--http-port", "0", "--http-bind", "here"], 1,
                                    "allowed the IP address of an interface"),
                                   (["--http-port", str(server.port)], 1, "choose another port with --http-port")):
            done = waiting.run([EVOD, "--keep-nothing", "--port", "0", *words], capture_output=True, text=True)
            self.assertEqual(done.returncode, status, done.stderr)
            self.assertIn(why, done.stderr + done.stdout)


class Top(Case):
    def test_once_is_one_page(self):
        server = self.serve("--speed", "max", "--start")
        world = r"(?m)^default +[1-9]\d* +█+ +\S+ (µs|ms) +\S+ (µs|ms)"  # unless it stalled for these 0.2 s
        page = plain.until(lambda: (lambda one: one if re.search(world, one) else None)(
            self.evoctl(server, "top", "--once", "--interval", "0.2")), "ticks")
        self.assertRegex(page, rf"^evod \d\S* at 127\.0\.0\.1:{server.port}, up ")
        for line in (r"memory +\d+ MiB", r"processor +\d+ %$", r"  network .* \d+ %  simulation .* \d+ %$",
                     r"  replays .* \d+ %  storage .* \d+ %$", r"clients +1: 1 admin",
                     r"logins +0 failed", r"requests +0 of 1024 waiting; \d+/s", r"disk +keeps up; "):
            self.assertRegex(page, f"(?m)^{line}")
        self.assertNotIn("\x1b", page)

    def test_json_contains_the_servers_metrics(self):
        server = self.serve()
        answer = json.loads(self.evoctl(server, "--json", "top", "--once"))
        self.assertEqual({family["name"] for family in answer["families"]}, self.metrics(server).names())

    def test_piped_it_prints_pages_until_interrupted(self):
        server = self.serve()
        top = subprocess.Popen([EVOCTL, "--server", f"127.0.0.1:{server.port}", "--json", "top", "--interval", "0.1"],
                               stdout=subprocess.PIPE, text=True)
        self.addCleanup(top.kill)
        for _ in range(3):
            self.assertIn("families", json.loads(top.stdout.readline()))
        top.send_signal(signal.SIGINT)
        self.assertEqual(waiting.ended(top), 0)
        top.stdout.close()


class Log(Case):
    def test_json_lines_survive_any_client_name(self):
        server = self.serve("--log-format", "json", "--log-level", "trace")
        names = ['quotes " and \\ and \'', "line\nbreak\r\n", "escape \x1b[2J\x1b]0;title\x07", "nul \0 del \x7f",
                 "csi \u009b31m", "\u2028 é 🦠", '","level":"error","x":"']
        for name in names:
            client = plain.Client(server, hello=False)
            self.addCleanup(client.socket.close)
            client.hello(client_name=name, client_version=name)
            client.control()
            client.call(plain.NOT_FOUND, get_statistics=c.GetStatistics(world=name))
            client.call(plain.INVALID, create_world=c.CreateWorld(name=name))
        server.end()
        raw = os.pread(server.log.fileno(), 1 << 24, 0)
        self.assertFalse(re.search(rb"[\x00-\x09\x0b-\x1f\x7f]|\xc2[\x80-\x9f]", raw))
        lines = [json.loads(line) for line in raw.decode().split("\n")[:-1]]
        for line in lines:
            self.assertRegex(line["time"], r"^\d{4}-\d\d-\d\dT\d\d:\d\d:\d\d\.\d{3}Z$")
            self.assertIn(line["level"], ("trace", "debug", "info", "warn", "error"))
            self.assertTrue(line["message"])
            self.assertLessEqual(set(line), {"time", "level", "message", "session", "client", "world", "code"})
        connected = [line for line in lines if "connected as" in line["message"]]
        self.assertEqual([line["session"] for line in connected], list(range(1, len(names) + 1)))
        for name, line in zip(names, connected):
            self.assertTrue(line["client"].startswith(re.sub(r"[\x00-\x1f\x7f-\x9f\u2028]", "?", name)), line)
        refused = [line for line in lines if line.get("code") == "NOT_FOUND"]
        self.assertEqual((len(refused), {line["level"] for line in refused}), (len(names), {"debug"}))
        asked = [line["message"] for line in lines if line["level"] == "trace"]
        self.assertEqual(sum("sends get_statistics" in message for message in asked), len(names))
        self.assertFalse(any(line["level"] == "error" for line in lines))

    def test_the_log_level_filters_messages(self):
        for level, written in (("info", True), ("warn", False), ("error", False)):
            process = subprocess.Popen([EVOD, "--keep-nothing", "--port", "0", "--log-level", level],
                                       stderr=subprocess.PIPE, text=True)
            self.addCleanup(process.kill)
            plain.until(lambda: catches(process.pid, signal.SIGTERM), "it minds signals")
            process.terminate()
            self.assertEqual("listening on" in waiting.communicate(process)[1], written, level)

    def test_every_refusal_is_in_the_log_of_level_debug(self):
        server = self.serve("--log-level", "debug")
        with self.client(server) as client:
            client.call(plain.NOT_FOUND, pause=c.Pause(world="nowhere"))
            client.call(plain.INVALID, run=c.Run(generations=0))
        plain.until(lambda: "NOT_FOUND" in server.output() and "INVALID_ARGUMENT" in server.output(), "two refusals")
        self.assertRegex(server.output(), r"debug session 1: plain 127\.0\.0\.1:\d+: request 1 is refused: NOT_FOUND: ")


if __name__ == "__main__":
    unittest.main(argv=[sys.argv[0], *sys.argv[4:]])
