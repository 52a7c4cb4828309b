"""Sessions of the protocol: handshake, requests, start and end, and what docs/PROTOCOL.md shows.

Arguments as in plain_client.py.
"""
import contextlib
import os
import re
import resource
import select
import signal
import socket
import struct
import subprocess
import sys
import tempfile
import time
import unittest

from google.protobuf import descriptor_pb2

from delta_decoder import Decoder
import waiting
from plain_client import (
    EXHAUSTED, INVALID, NOT_FOUND, OK, PRECONDITION, UNIMPLEMENTED, Client, columns, evod_path,
    protocol_path, Server, set_parameters, WithServer, c, session_pb2, stream_pb2, w,
)
from waiting import until


class Handshake(WithServer):
    def refused(self, client, code, words):
        message = client.control()
        self.assertEqual(message.goodbye.status.code, code)
        self.assertIn(words, message.goodbye.status.message)
        client.assert_closed()
        return message.goodbye.status

    def raw(self, data):
        client = self.enterContext(Client(self.server, hello=False))
        client.socket.sendall(data)
        return client

    def test_welcome_identifies_the_server(self):
        welcome = self.client.welcome
        self.assertEqual(welcome.protocol_version, 1)
        self.assertRegex(welcome.server_version, r"^\d+\.\d+\.\d+$")
        self.assertRegex(welcome.instance_id, r"^[0-9a-f]{32}$")
        self.assertLessEqual({"codec:plain", "codec:delta", "compression:zstd", "acknowledgements", "view"},
                             set(welcome.features))
        for field, limit in welcome.limits.ListFields():
            self.assertGreater(limit, 0, field.name)
        self.assertEqual(len(welcome.limits.ListFields()), len(c.Limits.DESCRIPTOR.fields))

    def test_a_hello_may_come_byte_by_byte(self):
        client = self.enterContext(Client(self.server, hello=False))
        client.socket.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
        body = session_pb2.ClientMessage(hello=session_pb2.Hello(protocol_version=1)).SerializeToString()
        for byte in b"EV\x01\x01" + struct.pack("<I", len(body)) + body:
            client.socket.sendall(bytes([byte]))
        self.assertEqual(client.control().welcome.protocol_version, 1)

    def test_other_protocols_get_a_goodbye(self):
        self.refused(self.raw(b"GET / HTTP/1.1\r\nHost: evod\r\n\r\n"), INVALID, "'EV'")

    def test_requests_before_a_damaged_frame_are_answered(self):
        world = self.new_world(population_size=20)
        for _ in range(20):
            client = self.enterContext(Client(self.server))
            requests = [dict(run=c.Run(world=world)), dict(get_statistics=c.GetStatistics(world=world)),
                        dict(pause=c.Pause(world=world))]
            messages = [session_pb2.ClientMessage(request=c.Request(request_id=id, client_key="damaged", **request))
                        for id, request in enumerate(requests, 1)]
            client.socket.sendall(b"".join(b"EV\x01\x01" + struct.pack("<I", m.ByteSize()) + m.SerializeToString()
                                           for m in messages) + b"no frame")
            for id in range(1, len(requests) + 1):
                self.assertEqual(client.response(id).status.code, 0)
            self.refused(client, INVALID, "'EV'")

    def test_a_request_before_the_hello_is_refused(self):
        client = self.enterContext(Client(self.server, hello=False))
        client.ask(list_worlds=c.ListWorlds())
        self.refused(client, PRECONDITION, "Hello")

    def test_another_protocol_version_is_refused(self):
        client = self.enterContext(Client(self.server, hello=False))
        client.hello(protocol_version=2)
        status = self.refused(client, PRECONDITION, "version")
        self.assertEqual([(v.field, v.allowed, v.got) for v in status.violations],
                         [("hello.protocol_version", "1", "2")])

    def test_frames_respect_the_clients_size_limit(self):
        small = self.enterContext(Client(self.server, hello=False))
        small.hello(frame_bytes_max=65535)
        status = self.refused(small, INVALID, "frame_bytes_max")
        self.assertEqual([v.field for v in status.violations], ["hello.frame_bytes_max"])
        client = self.enterContext(Client(self.server, hello=False))
        client.hello(frame_bytes_max=65536)
        self.assertTrue(client.control().HasField("welcome"))
        world = self.new_world(population_size=2000, island_width_px=6000.0, island_height_px=6000.0)
        refused = client.call(EXHAUSTED, get_population=c.GetPopulation(world=world))
        self.assertIn("the client accepts only 65536", refused.status.message)
        self.assertEqual(refused.status.reason, c.REASON_ANSWER_TOO_LARGE)
        client.call(subscribe_snapshots=c.SubscribeSnapshots(world=world, rate_hz=60))
        large = self.new_world(population_size=20_000, island_width_px=20_000.0, island_height_px=20_000.0)
        client.call(subscribe_snapshots=c.SubscribeSnapshots(world=large, rate_hz=60))
        self.assertEqual(client.next_snapshot().world, world)
        self.client.call(run_until_tick=c.RunUntilTick(world=large, tick=5))
        self.client.wait_world(lambda x: x.tick == 5, large)
        self.client.call(run_until_tick=c.RunUntilTick(world=world, tick=5))
        client.next_snapshot(lambda p: p.world == world and p.tick == 5)
        self.assertEqual([p for p in client.snapshots if p.world == large], [])
        client.call(list_worlds=c.ListWorlds())  # the session continues

    def test_a_second_hello_is_refused_and_the_session_lives(self):
        self.client.hello()
        response = self.client.control().response
        self.assertEqual((response.request_id, response.status.code), (0, PRECONDITION))
        self.client.call(list_worlds=c.ListWorlds())

    def test_a_dense_sequence_of_frames_is_not_late(self):
        body = session_pb2.ClientMessage(request=c.Request(request_id=1,
                                                           list_worlds=c.ListWorlds())).SerializeToString()
        frame = b"EV\x01\x01" + struct.pack("<I", len(body)) + body
        limit_s = self.client.welcome.limits.frame_timeout_s

        def go_on(lap):
            with Client(self.server) as client:
                client.socket.sendall(frame[:5])
                end = time.monotonic() + limit_s + 1
                while time.monotonic() < end:  # a frame is incomplete at every moment
                    client.socket.sendall(frame[5:] + frame[:5])
                    client.response(1)
                    lap()
        waiting.quicker_than(limit_s, go_on)

    def admitted(self):
        with Client(self.server, hello=False) as client:
            client.hello()
            return client.control().HasField("welcome")


class Requests(WithServer):
    def test_an_unknown_request_does_not_end_the_session(self):
        body = session_pb2.ClientMessage(request=c.Request(request_id=7, client_key="k")).SerializeToString()
        unknown = b"\xfa\x3e\x02\x08\x01"  # field 1007, two bytes
        inner = c.Request(request_id=7, client_key="k").SerializeToString() + unknown
        self.client.send_body(b"\x12" + bytes([len(inner)]) + inner)
        self.assertEqual(self.client.response(7).status.code, UNIMPLEMENTED)
        self.client.send_body(body)  # without a request
        self.assertEqual(self.client.response(7).status.code, UNIMPLEMENTED)
        self.client.send_body(unknown)  # an unknown message
        self.assertEqual(self.client.response(0).status.code, UNIMPLEMENTED)
        self.client.call(list_worlds=c.ListWorlds())

    def test_refusals_have_a_reason_for_programs(self):
        world = self.new_world(generation_limit=1)
        nowhere = "no_such_world"
        for reason, request in (
                ("FIELD_INVALID", {"run": c.Run(world=world, generations=0)}),
                ("FIELD_INVALID", {"reset_world": c.ResetWorld()}),
                ("WORLD_NOT_FOUND", {"pause": c.Pause(world=nowhere)}),
                ("WORLD_NOT_FOUND", {"get_parameters": c.GetParameters(world=nowhere)}),
                ("WORLD_EXISTS", {"create_world": c.CreateWorld(name=world)}),
                ("NOTHING_TO_RESUME", {"resume": c.Resume(world=world)}),
                ("REVISION_CHANGED", {"set_parameters": set_parameters(world, expected_revision=99, food_health=1.0)}),
                ("PLANNED_CHANGE_NOT_FOUND", {"cancel_change": c.CancelChange(world=world, id=5)}),
                ("NO_LEASE", {"renew_lease": c.RenewLease(world=world)}),
                ("ISLAND_NOT_FOUND", {"get_motion": c.GetMotion(world=world, island=9)}),
                ("ORGANISM_NOT_FOUND", {"get_organism": c.GetOrganism(world=world, organism=10**6)}),
                ("WORLD_IS_LIVE", {"seek": c.Seek(world=world, to=c.RunMoment(tick=1))}),
                ("SUBSCRIPTION_NOT_FOUND", {"unsubscribe": c.Unsubscribe(subscription_id=77)}),
                ("EXPORT_NOT_FOUND", {"continue_export": c.ContinueExport(export_id=3)})):
            status = self.client.response(self.client.ask(**request)).status
            self.assertEqual(c.Reason.Name(status.reason), "REASON_" + reason, status)
        self.client.call(set_speed=c.SetSpeed(world=world, speed=w.Speed(max=True)))
        self.client.call(run=c.Run(world=world))
        self.client.wait_world(lambda x: x.state == w.RUN_STATE_TERMINATED, world)
        status = self.client.call(PRECONDITION, run=c.Run(world=world)).status
        self.assertEqual(status.reason, c.REASON_RUN_ENDED)
        self.client.send_body(b"\xff\xff\xff")
        self.assertEqual(self.client.response(0).status.reason, c.REASON_MESSAGE_UNREADABLE)

    def test_an_unknown_field_refuses_a_command_and_no_query(self):
        world = self.new_world()
        unknown = b"\xfa\x3e\x02\x08\x01"  # field 1007, two bytes
        pause = c.Pause(world=world).SerializeToString() + unknown
        head = c.Request(request_id=7, client_key="k").SerializeToString()
        inner = head + b"\x7a" + bytes([len(pause)]) + pause  # 15: pause
        self.client.send_body(b"\x12" + bytes([len(inner)]) + inner)
        status = self.client.response(7).status
        self.assertEqual((status.code, [v.field for v in status.violations]), (UNIMPLEMENTED, ["pause.1007"]))
        query = c.Request(request_id=8, list_worlds=c.ListWorlds()).SerializeToString() + unknown
        self.client.send_body(b"\x12" + bytes([len(query)]) + query)
        self.assertEqual(self.client.response(8).status.code, OK)

    def test_an_invalid_body_does_not_end_the_session(self):
        for body in (b"\xff\xff\xff", b"\x12\x7f", os.urandom(100), b"\x12\x06\x12\x04\xff\xfe\xfd\xfc"):
            self.client.send_body(body)
            self.client.responses.clear()
            self.assertIn(self.client.response(0).status.code, (INVALID, UNIMPLEMENTED))
        self.client.call(list_worlds=c.ListWorlds())
        self.assertNotIn("libprotobuf", self.server.output())  # otherwise clients could fill the log

    def test_requests_are_answered_in_order(self):
        ids = [self.client.ask(run_until_tick=c.RunUntilTick(tick=0)) for _ in range(20)]
        order = []
        while len(order) < len(ids):
            order.append(self.client.control().response.request_id)
        self.assertEqual(order, ids)

    def test_a_half_closed_client_still_gets_its_answers(self):
        ids = [self.client.ask(get_parameters=c.GetParameters()) for _ in range(20)]
        self.client.socket.shutdown(socket.SHUT_WR)
        for i in ids:
            self.assertEqual(self.client.response(i).status.code, OK)
        self.client.assert_closed()

    def test_describe_has_messages_parameters_and_limits(self):
        description = self.client.call(describe=c.Describe()).description
        files = descriptor_pb2.FileDescriptorSet.FromString(description.file_descriptor_set)
        names = [f.name for f in files.file]
        self.assertEqual(sorted(names), ["evod/v1/commands.proto", "evod/v1/session.proto", "evod/v1/stream.proto",
                                         "evod/v1/world.proto", "google/protobuf/descriptor.proto"])
        for index, file in enumerate(files.file):  # a file after its imports
            self.assertLessEqual(set(file.dependency), set(names[:index]))
        self.assertEqual(description.limits, self.client.welcome.limits)
        self.assertGreater(len(description.parameters), 60)
        for p in description.parameters:
            self.assertTrue(p.name and p.help and p.kind and p.effect, p.name)

    def test_an_unknown_world_is_not_found_by_any_request(self):
        for field in c.Request.DESCRIPTOR.oneofs_by_name["kind"].fields:
            kind = getattr(c, field.message_type.name)
            if "world" not in kind.DESCRIPTOR.fields_by_name:
                continue
            extra = {"set_speed": {"speed": w.Speed(max=True)}, "subscribe_snapshots": {"rate_hz": 1},
                     "place": {"items": [c.PlacedItem(kind=c.ITEM_KIND_FOOD, x_px=640, y_px=360)]},
                     "remove": {"food": [0]}, "set_fitness": {"fitness": [0]}, "fork_world": {"name": "new"},
                     "seek": {"to": c.RunMoment(tick=1)},
                     "add_note": {"kind": "note", "text": "x"}, "observe": {"expressions": ["mean(fitness_mean)"]},
                     "export_run": {"table": c.RUN_TABLE_EVENTS, "format": c.TEXT_FORMAT_CSV}}
            for world in ("nowhere", "no\nwhere", "ü" * 1000):
                request = {field.name: kind(world=world, **extra.get(field.name, {}))}
                status = self.client.call(NOT_FOUND, **request).status
                self.assertEqual([v.field for v in status.violations], [field.name + ".world"])


class StartAndEnd(unittest.TestCase):
    def file(self, text):
        path = os.path.join(self.enter(tempfile.TemporaryDirectory()), "two_islands.json")
        with open(path, "w") as file:
            file.write(text)
        return path

    def enter(self, context):
        result = context.__enter__()
        self.addCleanup(context.__exit__, None, None, None)
        return result

    def serve(self, *options, **popen):
        server = Server(*options, **popen)
        self.addCleanup(server.end)
        return server

    def test_an_experiment_defines_the_first_world(self):
        path = self.file('{"seed": 77, "island_count": 2, "description": "two"}')
        server = self.serve("--experiment", path, "--speed", "max", "--start")
        self.assertEqual((server.world, server.seed), ("two_islands", 77))
        with Client(server) as client:
            world = client.world()
            self.assertEqual((world.name, world.seed, world.island_count, world.speed.max, world.state),
                             ("two_islands", 77, 2, True, w.RUN_STATE_RUNNING))
            client.wait_world(lambda x: x.tick > 10)
        self.assertEqual(self.serve("--experiment", path, "--seed", "78").seed, 78)

    def test_sigterm_and_sigint_send_a_goodbye(self):
        for how in (signal.SIGTERM, signal.SIGINT):
            def end(lap):
                server = Server("--start", "--speed", "max")
                with Client(server) as client, Client(server) as deaf, Client(server, hello=False):
                    client.call(subscribe_snapshots=c.SubscribeSnapshots(rate_hz=60))
                    deaf.call(subscribe_snapshots=c.SubscribeSnapshots(rate_hz=120))
                    client.next_snapshot(lambda p: p.tick > 0)
                    server.process.send_signal(how)
                    client.next_event("server_going_away")
                    client.assert_closed()
                    lap()
                    began = time.monotonic()
                    server.end(how)
                    self.assertLess(time.monotonic() - began, 10)
            waiting.quicker_than(10, end)

    def test_it_outlives_the_reader_of_its_log(self):
        process = subprocess.Popen([evod_path, "--port", "0", "--keep-nothing"], stderr=subprocess.PIPE, text=True)
        self.addCleanup(waiting.ended, process)
        self.addCleanup(process.terminate)
        address = None
        while address is None:
            address = re.search(r":(\d+), world", process.stderr.readline())
        process.stderr.close()
        server = lambda: None  # the parts of a Server that a Client needs
        server.port = int(address[1])
        for _ in range(3):  # each is logged
            with Client(server) as client:
                client.call(list_worlds=c.ListWorlds())
        self.assertIsNone(process.poll())

    def test_repeated_signals_end_the_server(self):
        server = Server("--start", "--speed", "max")
        for _ in range(5):
            with contextlib.suppress(ProcessLookupError):
                server.process.send_signal(signal.SIGTERM)
        # The second signal ends the server at once, unless the first has already ended it.
        self.assertIn(waiting.ended(server.process), (0, -signal.SIGTERM))

    @unittest.skipIf(b"__ubsan_handle_dynamic_type" in open(evod_path, "rb").read(),
                     "UndefinedBehaviorSanitizer needs file descriptors to look at an object, and takes it for wrong")
    def test_it_accepts_again_when_descriptors_are_free(self):
        server = self.serve(preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_NOFILE, (40, 40)))

        def run_out_of_them(lap):
            with contextlib.ExitStack() as stack:
                first = stack.enter_context(Client(server))
                for _ in range(60):
                    stack.enter_context(Client(server, hello=False))
                until(lambda: "cannot accept a connection" in server.output(), "it runs out of them")
                used_s, began = waiting.processor_time_s(server.process.pid), time.monotonic()
                for _ in range(20):
                    first.call(list_worlds=c.ListWorlds())
                until(lambda: time.monotonic() - began > 0.5, "some time to spin in")
                self.assertLess(waiting.processor_time_s(server.process.pid) - used_s, 0.4)
            lap()
            began = time.monotonic()
            until(lambda: self.admitted(server), "it takes connections again")
            self.assertLess(time.monotonic() - began, 1)
        waiting.quicker_than(1, run_out_of_them)

    def admitted(self, server):
        with Client(server, hello=False) as client:
            client.hello()
            readable, _, _ = select.select([client.socket], [], [], 1)
            return bool(readable) and client.control().HasField("welcome")


class Documentation(unittest.TestCase):
    """The statements of docs/PROTOCOL.md are true. tests/docs runs its programs."""

    def test_its_example_bytes_are_right(self):
        text = open(protocol_path, encoding="utf-8").read()
        blocks = [bytes.fromhex("".join(line.split("#")[0] for line in block.splitlines()))
                  for block in re.findall(r"```\n(45 56 .*?)```", text, re.S)]
        self.assertEqual(len(blocks), 2)
        self.assertEqual(blocks[0][:8], b"EV\x01\x01\x08\0\0\0")
        hello = session_pb2.ClientMessage.FromString(blocks[0][8:])
        self.assertEqual((hello.hello.protocol_version, hello.hello.client_name), (1, "me"))
        self.assertEqual(blocks[1][:8], b"EV\x01\x02\xe2\0\0\0")
        self.assertEqual(len(blocks[1]), 8 + 0xe2)
        snapshot = stream_pb2.SnapshotFrame.FromString(blocks[1][8:])
        self.assertEqual((snapshot.world, snapshot.tick, snapshot.dropped_count), ("default", 120, 3))
        seen = columns(snapshot)
        self.assertEqual({k: list(v) for k, v in seen["organisms"].items()},
                         {"id": [0, 2], "x": [10.5, 50.25], "y": [20, 30.0625], "radius": [10, 8.5],
                          "health": [100, 42.5]})
        self.assertEqual((seen["food"]["x"][0], seen["poison"]["y"][0], seen["obstacles"]["half_width"][0]),
                         (5, 55, 15))

    def test_its_decoder_is_the_one_tested_here(self):
        text = open(protocol_path, encoding="utf-8").read()
        decoder = re.search(r"### Deltas.*?```python\n(.*?)```", text, re.S)[1]
        self.assertEqual(decoder, open(sys.modules[Decoder.__module__].__file__, encoding="utf-8").read())

    def test_it_mentions_every_request_and_event(self):
        text = open(protocol_path, encoding="utf-8").read()
        for field in c.Request.DESCRIPTOR.oneofs_by_name["kind"].fields:
            self.assertIn(f"`{field.message_type.name}`", text)
        for field in stream_pb2.Event.DESCRIPTOR.oneofs_by_name["kind"].fields:
            self.assertIn(f"`{field.name}`", text)


if __name__ == "__main__":
    unittest.main(argv=[sys.argv[0], *sys.argv[4:]], verbosity=2, warnings="ignore")
