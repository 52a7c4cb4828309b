"""Every scalar field of every client message, found in the server's descriptors, with the values
that programs get wrong. Each is done, or refused with the field that is at fault; what is refused has changed nothing,
and afterwards the world is equal to an untouched one. EVOD and EVOCTL name the programs, MESSAGES the folder of the
message classes."""
import math
import pathlib
import re
import struct
import sys
import unittest

import access_test as access
import waiting
from access_test import c, plain

from google.protobuf import descriptor_pb2, descriptor_pool  # noqa: E402
from evod.v1 import session_pb2  # noqa: E402  (its folder is in sys.path now)

OK, INVALID, NOT_FOUND = 0, 3, 5
LONG = 1 << 20  # bytes; together with the rest of the message longer than a frame may be

# Other fields that a request needs for the field under test to matter.
BASE = {
    "create_world": c.CreateWorld(name="made", seed=1),
    "fork_world": c.ForkWorld(name="made"),
    "place": c.Place(items=[c.PlacedItem(kind=c.ITEM_KIND_FOOD, x_px=640, y_px=360)]),
    "remove": c.Remove(food=[0]),
    "set_fitness": c.SetFitness(generation=1, fitness=[0]),
    "set_speed": c.SetSpeed(speed=plain.w.Speed(real_time_factor=1)),
    "subscribe_snapshots": c.SubscribeSnapshots(rate_hz=1),
    "seek": c.Seek(to=c.RunMoment(tick=0)),
    "set_view": c.SetView(view=c.View(detail=1)),
    "add_note": c.AddNote(kind="note", text="a remark"),
    "observe": c.Observe(expressions=["mean(fitness_mean)"]),
    "for_each_world": c.ForEachWorld(**{"class": "bio2"}),
    "create_class": c.CreateClass(name="made"),
    "update_class": c.UpdateClass(**{"class": "bio2"}),
    "delete_class": c.DeleteClass(**{"class": "bio2"}),
    "add_members": c.AddMembers(**{"class": "bio2"}),
    "change_member": c.ChangeMember(**{"class": "bio2", "number": 1}),
    "make_qr_codes": c.MakeQrCodes(texts=["http://lab:7745/#join=KTRMXB"]),
    "export_run": c.ExportRun(table=c.RUN_TABLE_GENERATIONS, format=c.TEXT_FORMAT_CSV),
}
# Fields with their own bounds: the last valid and the first invalid value on either side.
EDGES = {
    "run.generations": ([1], [0]),
    "set_speed.speed.real_time_factor": ([0.001, 10000.0], [0.0009, 10001.0, 0.0, -1.0]),
    "subscribe_snapshots.rate_hz": ([1e-3, 1e9], [0.0, -1.0]),
    "subscribe_snapshots.unacknowledged_max": ([1, 1000], [0, 1001]),
    "subscribe_snapshots.view.bytes_per_s_max": ([1000, 10**12], [0, 999, 10**12 + 1]),
    "set_parameters.at_generation": ([2, 2**64 - 1], [0, 1]),
    "set_parameters.at_tick": ([1, 2**64 - 1], [0]),
    "request_id": ([1, 2**64 - 1], [0]),
}
NAMES = [b"", b"../x", b"/etc/passwd", b"/tmp/x", b"a/b", b"..", b".", b"x\0y", b"x.evod", b"a\n", b"%s%n", b"\xff\xfe",
         b"\xed\xa0\x80", "ä".encode(), b"n" * 300, b"n" * 5000, b"n" * (LONG - 4096)]

F = descriptor_pb2.FieldDescriptorProto
# Other fields needed, by part of a request.
REGION = c.Region(left_px=0, top_px=0, width_px=100, height_px=100)
NEEDED = {"subscribe_snapshots.view": c.SubscribeSnapshots(codec=plain.stream_pb2.CODEC_DELTA),
          "subscribe_snapshots.view.region": c.SubscribeSnapshots(view=c.View(region=REGION)),
          "set_view.view.region": c.SetView(view=c.View(region=REGION)),
          "for_each_world.set_speed": c.ForEachWorld(set_speed=c.SetSpeed(speed=plain.w.Speed(max=True)))}
WHOLE = [0, 1, 2**31 - 1, 2**31, 2**32 - 1, 2**32, 2**63 - 1, 2**63, 2**64 - 1]  # the last is also -1
REAL = [0.0, -0.0, float("nan"), float("inf"), -float("inf"), -1.0, 2.0**63]


def varint(number):
    encoded = b""
    while number > 127:
        encoded += bytes([number & 127 | 128])
        number >>= 7
    return encoded + bytes([number])


def delimited(number, body):
    return varint(number << 3 | 2) + varint(len(body)) + body


def values_of(field):
    if field.type == F.TYPE_DOUBLE:
        return REAL + [5e-324, 1.7e308]
    if field.type == F.TYPE_FLOAT:
        return REAL + [1e-45, 3.4e38]
    if field.type in (F.TYPE_STRING, F.TYPE_BYTES):
        return NAMES
    return WHOLE


def encoded(field, value):
    if field.type == F.TYPE_DOUBLE:
        return varint(field.number << 3 | 1) + struct.pack("<d", value)
    if field.type == F.TYPE_FLOAT:
        return varint(field.number << 3 | 5) + struct.pack("<f", value)
    if field.type in (F.TYPE_STRING, F.TYPE_BYTES):
        return delimited(field.number, value)
    assert field.type in (F.TYPE_UINT32, F.TYPE_UINT64, F.TYPE_BOOL, F.TYPE_ENUM), field.full_name
    return varint(field.number << 3) + varint(value)


def scalars(message, path=()):
    """Every scalar field of a message at any depth, with its path."""
    for field in message.fields:
        if field.message_type:
            yield from scalars(field.message_type, path + (field,))
        else:
            yield path, field


def server_descriptors(client):
    files = descriptor_pb2.FileDescriptorSet.FromString(
        client.call(describe=c.Describe()).description.file_descriptor_set)
    pool = descriptor_pool.DescriptorPool()
    for file in files.file:
        pool.Add(file)
    return pool


class Walk(access.Access):
    def setUp(self):
        super().setUp()
        self.server_ = self.serve("--durability", "relaxed")
        self.client = self.come(self.server_)
        self.pool = server_descriptors(self.client)
        self.sent = self.subscription_id = 0
        self.make("walked")
        self.make("untouched")
        self.make_class()
        self.fresh = self.state()

    def tearDown(self):
        """The untouched world and the attacked one end in the same state."""
        self.remake()
        hashes = set()
        for world in ("walked", "untouched"):
            self.client.call(set_speed=c.SetSpeed(world=world, speed=plain.w.Speed(max=True)))
            self.client.call(run_until_tick=c.RunUntilTick(world=world, tick=200))
            hashes.add(plain.until(lambda: (lambda w: w.tick == 200 and w.state_hash)(self.client.world(world)),
                                   "ticks"))
        self.assertEqual(len(hashes), 1)
        self.server_.process.terminate()
        self.assertEqual(waiting.ended(self.server_.process), 0, self.server_.output())
        folder = pathlib.Path(self.folder)
        self.assertLessEqual({path.suffix for path in folder.iterdir()} - {""},
                             {".evod", ".evod-wal", ".evod-shm", ".sqlite", ".sqlite-wal", ".sqlite-shm"})
        for elsewhere in (folder.parent / "x", folder.parent / "x.evod", pathlib.Path("/tmp/x"),
                          pathlib.Path("/tmp/x.evod"), pathlib.Path("/etc/passwd.evod")):
            self.assertFalse(elsewhere.exists(), elsewhere)

    def make(self, name):
        self.client.call(create_world=c.CreateWorld(name=name, seed=5, parameters=plain.assignments(generation_s=1.0)))

    def make_class(self):
        """A class with a member who has not joined, so that there is no world of it."""
        self.client.call(create_class=c.CreateClass(name="bio2", template=c.CreateWorld(seed=1)))
        self.client.call(add_members=c.AddMembers(**{"class": "bio2"}, names=["Ada"]))

    def state(self):
        statistics = self.client.call(get_statistics=c.GetStatistics(world="walked")).statistics
        parameters = self.client.call(get_parameters=c.GetParameters(world="walked")).parameters
        return statistics.world, parameters

    def remake(self):
        """Undoes the effect of a request, if it had one."""
        if self.subscription_id:
            self.client.call(unsubscribe=c.Unsubscribe(subscription_id=self.subscription_id))
            self.subscription_id = 0
        worlds = {world.name for world in self.client.call(list_worlds=c.ListWorlds()).worlds.worlds}
        for name in worlds - {"default", "walked", "untouched"}:
            self.client.call(delete_world=c.DeleteWorld(world=name))
        classes = {one.name for one in self.client.call(list_classes=c.ListClasses()).classes.classes}
        for name in classes:
            self.client.call(delete_class=c.DeleteClass(**{"class": name}))
        self.make_class()
        if "walked" not in worlds or self.state() != self.fresh:
            if "walked" in worlds:
                self.client.call(delete_world=c.DeleteWorld(world="walked"))
            self.make("walked")
            self.fresh = self.state()

    def send(self, body):
        """Sends a request's bytes. Returns the status of the answer, or None if the session was closed as required."""
        self.sent += 1
        message = delimited(2, body)
        self.client.send_body(message)
        if len(message) > self.client.welcome.limits.control_frame_bytes_max:
            self.assertEqual(self.client.goodbye().code, INVALID)
            self.client.assert_closed()
            self.client = self.come(self.server_)
            return None
        while not self.client.responses:
            self.client.step()
        response = self.client.responses.popitem()[1]
        self.subscription_id = response.subscription.subscription_id
        return response.status

    def base(self, name, path=""):
        kind = getattr(c, {f.name: f for f in c.Request.DESCRIPTOR.fields}[name].message_type.name)
        message = kind()
        if "world" in kind.DESCRIPTOR.fields_by_name:
            message.world = "walked"
        message.MergeFrom(BASE.get(name, kind()))
        for part, needed in NEEDED.items():
            if path.startswith(part):
                message.MergeFrom(needed)
        self.client.request_id += 1
        return c.Request(client_key=self.client.key, request_id=self.client.request_id, **{name: message})

    def check(self, path, value, status, refused=None):
        """Whether an answer names the fault. refused: whether it must be a refusal."""
        said = f"{path} = {value[:50] if isinstance(value, bytes) else value}: {status}"
        if status is None:
            return
        self.assertEqual(bool(status.message), status.code != OK, said)
        if refused is not None:
            self.assertEqual(status.code != OK, refused, said)
        if status.code == INVALID and "is not a" not in status.message:  # for messages that can be parsed
            named = [re.sub(r"\[\d+\]", "", violation.field) for violation in status.violations]  # x[2].y: x.y
            # the field is named as the parameter or gene that it sets; an item, organism or free gene may lack others
            if re.search(r"\.(parameters|population|schedule|items|organisms|free_genes|ranges)\.", path):
                self.assertTrue([x for x in named if x.startswith(path.split(".")[0] + ".")], said)
            else:
                self.assertTrue([x for x in named if path == x or path.startswith(x + ".")], said)
            for violation in status.violations:
                self.assertTrue(violation.allowed, said)
                self.assertLess(len(violation.got), 1000, said)

    def walk(self, path, build, values, refused=None):
        for value in values:
            before = self.fresh
            status = self.send(build(value))
            self.check(path, value, status, refused)
            if status is not None and status.code == OK:
                self.remake()
            else:
                self.assertEqual(self.state(), before, f"{path} = {value!r} was refused and has changed something")

    def test_every_field_of_every_request(self):
        request = self.pool.FindMessageTypeByName("evod.v1.Request")
        walked = 0
        for kind in request.oneofs_by_name["kind"].fields:
            if kind.name == "shut_down":
                continue
            for way, field in scalars(kind.message_type, (kind,)):
                path = ".".join(step.name for step in (*way, field))

                def build(value):
                    body = encoded(field, value)
                    for step in reversed(way):
                        body = delimited(step.number, body)
                    return self.base(kind.name, path).SerializeToString() + body
                with self.subTest(path):
                    walked += 1
                    self.walk(path, build, values_of(field))
                    for edges, refused in zip(EDGES.get(path, ()), (False, True)):
                        self.walk(path, build, edges, refused)
        self.assertGreater(walked, 60)

    def test_the_fields_of_the_envelope(self):
        request = self.pool.FindMessageTypeByName("evod.v1.Request")
        for field in request.fields:
            if field.message_type:
                continue
            for name in ("list_worlds", "pause"):
                with self.subTest(field.name, request=name):
                    build = lambda value: self.base(name).SerializeToString() + encoded(field, value)
                    self.walk(field.name, build, values_of(field))
                    for edges, refused in zip(EDGES.get(field.name, ()), (False, True)):
                        self.walk(field.name, build, edges, refused)

    def test_every_parameter(self):
        descriptions = self.client.call(describe=c.Describe()).description.parameters
        kinds = plain.w

        def build(description, dry_run, **value):
            request = self.base("set_parameters")
            request.set_parameters.dry_run = dry_run
            request.set_parameters.parameters.add(name=description.name, value=kinds.ParameterValue(**value))
            return request.SerializeToString()
        for one in descriptions:
            path = "set_parameters." + one.name
            with self.subTest(path):
                outside = []
                if one.kind == kinds.PARAMETER_KIND_COUNT:
                    inside = [dict(count=int(one.min)), dict(count=int(one.max))]
                    outside += [dict(count=int(x)) for x in (one.min - 1, one.max + 1, 2**32 - 1)
                                if 0 <= x < 2**32 and not one.min <= x <= one.max]
                elif one.kind == kinds.PARAMETER_KIND_REAL:
                    inside = [dict(real=one.min), dict(real=one.max)]
                    outside += [dict(real=x) for x in (math.nextafter(one.min, -math.inf),
                                                      math.nextafter(one.max, math.inf), -1e300, 2.0**63)
                                if not one.min <= x <= one.max]
                elif one.kind == kinds.PARAMETER_KIND_CHOICE:
                    inside = [dict(choice=x) for x in one.choices]
                    outside += [dict(choice=x) for x in ("", "nonsense", "x\0y", "n" * (LONG - 4096))] + [dict(count=0)]
                else:
                    inside = [dict(flag=True), dict(flag=False)]
                    outside += [dict(count=1)]
                if one.kind != kinds.PARAMETER_KIND_CHOICE:
                    outside += [dict(choice="1")]
                outside += [dict(real=x) for x in (float("nan"), float("inf"), -float("inf"))] + [{}]
                for value in inside:  # combinations that do not fit are also refused by name
                    status = self.send(build(one, True, **value))
                    self.check("set_parameters.parameters." + one.name, 1, status)
                    self.assertEqual(self.state(), self.fresh)
                for value in outside:
                    status = self.send(build(one, False, **value))
                    self.assertEqual(status.code, INVALID, f"{one.name} {value}")
                    self.assertIn(path, [violation.field for violation in status.violations], f"{value} {status}")
                    self.assertEqual(self.state(), self.fresh)
        minus_zero = [x for x in descriptions if x.kind == kinds.PARAMETER_KIND_REAL and x.min == 0]
        self.assertTrue(minus_zero)
        for one in minus_zero:  # -0 equals 0
            statuses = [self.send(build(one, True, real=zero)) for zero in (0.0, -0.0)]
            self.assertEqual(*[[status.code, *(violation.field for violation in status.violations)]
                               for status in statuses])

    def test_the_fields_of_a_hello_and_of_acknowledgements(self):
        hello = self.pool.FindMessageTypeByName("evod.v1.Hello")
        for way, field in scalars(hello):
            for value in values_of(field):
                with plain.Client(self.server_, hello=False) as stranger:
                    part = encoded(field, value)
                    for step in reversed(way):
                        part = delimited(step.number, part)
                    body = session_pb2.Hello(protocol_version=1).SerializeToString() + part
                    stranger.send_body(delimited(1, body))
                    first = stranger.control()
                    if not first.HasField("welcome"):
                        self.assertTrue(first.goodbye.status.code and first.goodbye.status.message)
                        stranger.assert_closed()
        acknowledgement = self.pool.FindMessageTypeByName("evod.v1.AcknowledgeSnapshot")
        number = {f.name: f for f in self.pool.FindMessageTypeByName(
            "evod.v1.ClientMessage").fields}["acknowledge_snapshot"].number
        subscription = self.client.call(subscribe_snapshots=c.SubscribeSnapshots(
            world="walked", rate_hz=60, unacknowledged_max=2)).subscription.subscription_id
        for field in acknowledgement.fields:
            for value in WHOLE:
                body = session_pb2.AcknowledgeSnapshot(subscription_id=subscription).SerializeToString()
                self.client.send_body(delimited(number, body + encoded(field, value)))
        self.client.call(unsubscribe=c.Unsubscribe(subscription_id=subscription))

    def test_strings_longer_than_a_frame(self):
        for name in ("create_world", "set_parameters", "pause"):
            body = self.base(name).SerializeToString() + delimited(2, b"n" * LONG)
            self.assertIsNone(self.send(body))
        self.assertEqual(self.state(), self.fresh)


if __name__ == "__main__":
    unittest.main(argv=[sys.argv[0], *sys.argv[4:]], verbosity=1)
