"""Classes of students over real sockets, with clients made from the .proto files. EVOD and EVOCTL name the programs,
MESSAGES the folder of the message classes."""
import os
import random
import re
import shutil
import sqlite3
import stat
import sys
import threading
import time
import unittest

import past_test as past
import waiting
from past_test import EVOD, c, plain, w

from evod.v1 import session_pb2  # noqa: E402  (its folder is in sys.path now)

PERMISSION_DENIED, RESOURCE_EXHAUSTED, UNAUTHENTICATED = 7, 8, 16
TEACHER = c.ROLE_TEACHER
SMALL = c.CreateWorld(seed=7, parameters=plain.assignments(population_size=12, generation_s=2.0))


class Guest(past.Client):
    """A client with any Hello. first: the server's first message. Reads no farther than that."""

    def __init__(self, server, come_from="127.0.0.1", **hello):
        over = self.connected(server, come_from)
        super().__init__(server, hello=False, over=over)
        self.hello(**hello)
        self.first = self.control()
        self.welcome = self.first.welcome if self.first.HasField("welcome") else None
        self.refusal = self.first.goodbye.status if self.first.HasField("goodbye") else None

    @property
    def member(self):
        return self.welcome.membership


class Case(past.Case):
    def setUp(self):
        super().setUp()
        self.tokens = {}
        for name, role in (("frau_k", "teacher"), ("herr_b", "teacher"), ("root", "admin"), ("eve", "viewer")):
            done = waiting.run([EVOD, "token", "add", name, "--role", role, "--data", self.folder],
                               capture_output=True, text=True)
            self.tokens[name] = done.stdout.strip()
            self.assertEqual(done.returncode, 0, done.stderr)

    def serve(self, *options):
        return self.server("--data", self.folder, "--require-token", *options)

    def guest(self, server, **hello):
        guest = Guest(server, **hello)
        self.addCleanup(guest.socket.close)
        return guest

    def user(self, server, name):
        return self.guest(server, token=self.tokens[name])

    def join(self, server, code, name="", **options):
        return self.guest(server, join=session_pb2.Join(code=code, name=name), **options)

    def refused(self, guest, reason, code=UNAUTHENTICATED):
        self.assertIsNone(guest.welcome, guest.first)
        self.assertEqual((guest.refusal.reason, guest.refusal.code), (reason, code), guest.refusal)
        guest.assert_closed()
        return guest.refusal

    def create(self, teacher, name="bio2", **fields):
        return teacher.call(create_class=c.CreateClass(name=name, **{"template": SMALL, **fields})).class_info

    @staticmethod
    def info(teacher, name="bio2"):
        classes = teacher.call(list_classes=c.ListClasses()).classes.classes
        return next((one for one in classes if one.name == name), None)


class Joining(Case):
    def test_a_member_has_a_world_at_once_and_after_reload(self):
        server = self.serve()
        teacher = self.user(server, "frau_k")
        self.assertEqual(teacher.welcome.role, TEACHER)
        code = self.create(teacher, lesson="drift").code
        self.assertRegex(code, "^[BCDFGHJKLMNPQRSTVWXZ]{6}$")
        anna = self.join(server, f" {code[:3].lower()}-{code[3:]} ", "  Änna   B. ")
        self.assertEqual((anna.welcome.role, anna.welcome.user), (c.ROLE_VIEWER, "bio2/aenna-b"))
        self.assertEqual((anna.member.name, anna.member.world, getattr(anna.member, "class"), anna.member.lesson,
                          anna.member.teacher), ("Änna B.", "bio2_aenna-b", "bio2", "drift", "frau_k"))
        self.assertRegex(anna.member.token, "^evod_[0-9a-f]{64}$")
        world = anna.world(anna.member.world)
        self.assertEqual((world.tick, world.seed), (0, 7))
        # Reload: the same person, with an empty token in the Welcome.
        anna.socket.close()
        again = self.guest(server, token=anna.member.token)
        self.assertEqual((again.welcome.user, again.member.token, again.member.world),
                         ("bio2/aenna-b", "", "bio2_aenna-b"))
        other = self.join(server, code)
        self.assertRegex(other.member.name, "^[a-z]+-[a-z]+$")
        self.assertEqual(other.member.world, "bio2_" + other.member.name)
        self.assertEqual(other.world(other.member.world).seed, 7)
        members = plain.until(lambda: (lambda all: all if sum(m.sessions for m in all) == 2 else None)(
            self.info(teacher).members), "two sessions")
        self.assertEqual([(m.number, m.name, m.user, m.joined, m.removed) for m in members],
                         [(1, "Änna B.", "bio2/aenna-b", True, False),
                          (2, other.member.name, other.welcome.user, True, False)])

    def test_names_that_cannot_be_are_refused(self):
        server = self.serve()
        teacher = self.user(server, "frau_k")
        code = self.create(teacher).code
        self.join(server, code, "Anna")
        for name, reason, status, got in (
                ("aNNA", c.REASON_MEMBER_NAME_TAKEN, c.CODE_ALREADY_EXISTS, "aNNA"),
                ("a" * 25, c.REASON_FIELD_INVALID, c.CODE_INVALID_ARGUMENT, "25 characters"),
                ("a" * 3000, c.REASON_FIELD_INVALID, c.CODE_INVALID_ARGUMENT, "3000 bytes"),
                ("a\u202eb", c.REASON_FIELD_INVALID, c.CODE_INVALID_ARGUMENT, "the character U+202E"),
                ("a\x00b", c.REASON_FIELD_INVALID, c.CODE_INVALID_ARGUMENT, "the character U+0000")):
            refusal = self.refused(self.join(server, code, name), reason, status)
            self.assertEqual((refusal.violations[0].field, refusal.violations[0].got), ("hello.join.name", got))
        # Protobuf itself refuses a string that is not UTF-8.
        raw = Guest.connected(server)
        client = past.Client(server, hello=False, over=raw)
        join = b"\x0a\x06" + code.encode() + b"\x12\x02\xff\xfe"
        client.send_body(b"\x0a" + bytes([len(join) + 4]) + b"\x08\x01" + b"\x42" + bytes([len(join)]) + join)
        first = client.control()
        self.assertTrue(first.HasField("goodbye"), first)
        raw.close()
        self.assertEqual(len(self.info(teacher).members), 1)

    def test_a_class_has_at_most_64_members(self):
        server = self.serve("--worlds-max", "100")
        teacher = self.user(server, "frau_k")
        code = self.create(teacher).code
        names = ["" for _ in range(63)]
        given = teacher.call(add_members=c.AddMembers(**{"class": "bio2"}, names=names)).personal_codes.codes
        self.assertEqual(len({one.code for one in given}), 63)
        self.join(server, code, "Anna")
        self.refused(self.join(server, code, "Ben"), c.REASON_MEMBERS_MAX, RESOURCE_EXHAUSTED)
        self.assertEqual(len(self.info(teacher).members), 64)

    def test_token_and_join_together_are_refused(self):
        server = self.serve()
        code = self.create(self.user(server, "frau_k")).code
        guest = self.guest(server, token=self.tokens["eve"], join=session_pb2.Join(code=code))
        self.refused(guest, c.REASON_FIELD_INVALID, c.CODE_INVALID_ARGUMENT)
        self.assertEqual(guest.refusal.violations[0].field, "hello.join")

    def test_locked_and_unknown_codes_sound_alike(self):
        server = self.serve()
        teacher = self.user(server, "frau_k")
        code = self.create(teacher).code
        anna = self.join(server, code, "Anna")
        self.assertEqual(teacher.call(update_class=c.UpdateClass(**{"class": "bio2"}, open=False)).class_info.code, "")
        words = {self.refused(self.join(server, one), c.REASON_CODE_UNKNOWN).message
                 for one in (code, "BBBBBB", "", "AAAAAA", "BCDFGHJKLM", "x" * 2000, "🦊🦊🦊🦊🦊🦊", "BBB\nBBB", "'; DROP")}
        self.assertEqual(words, {"this class is not open: ask your teacher for a new code"})
        self.assertIsNotNone(self.guest(server, token=anna.member.token).welcome, "members are not locked out")
        opened = teacher.call(update_class=c.UpdateClass(**{"class": "bio2"}, open=True)).class_info
        self.assertNotEqual(opened.code, code)
        self.assertTrue(1100 < opened.code_valid_s <= 1200, opened.code_valid_s)
        self.assertIsNotNone(self.join(server, opened.code).welcome)
        renewed = teacher.call(update_class=c.UpdateClass(**{"class": "bio2"}, new_code=True)).class_info.code
        self.refused(self.join(server, opened.code), c.REASON_CODE_UNKNOWN)
        self.assertIsNotNone(self.join(server, renewed).welcome)
        refused = teacher.call(c.CODE_INVALID_ARGUMENT,
                               update_class=c.UpdateClass(**{"class": "bio2"}, open=False, new_code=True))
        self.assertEqual(refused.status.violations[0].field, "update_class.new_code")

    def test_wrong_codes_are_bounded_but_not_per_address(self):
        server = self.serve()
        teacher = self.user(server, "frau_k")
        teacher.call(subscribe_events=c.SubscribeEvents())
        code = self.create(teacher).code
        reasons = []
        while c.REASON_JOINS_TOO_FAST not in reasons:
            guest = Guest(server, join=session_pb2.Join(code="BBBBBB"))
            reasons.append(guest.refusal.reason)
            if reasons[-1] == c.REASON_JOINS_TOO_FAST:
                self.assertEqual(guest.refusal.code, RESOURCE_EXHAUSTED)
                self.assertEqual([(a.name, a.value) for a in guest.refusal.arguments], [("retry_after_s", "10")])
            guest.socket.close()
            self.assertLess(len(reasons), 2000)
        self.assertGreaterEqual(len(reasons), 51)
        # From the same address and at once: a right code, a personal code and a token.
        self.assertIsNotNone(self.join(server, code, "Anna").welcome)
        self.assertIsNotNone(self.user(server, "eve").welcome)
        teacher.next_event("class_changed", lambda event: self.info(teacher).codes_are_guessed)

    def test_joins_of_a_whole_class_within_a_second(self):
        server = self.serve("--worlds-max", "100")
        teacher = self.user(server, "frau_k")
        code = self.create(teacher, template=c.CreateWorld(), seeds=c.CLASS_SEEDS_OWN).code
        took, seeds, lock = [], {}, threading.Lock()

        def come():
            start = time.monotonic()
            guest = Guest(server, join=session_pb2.Join(code=code))
            guest.call(subscribe_snapshots=c.SubscribeSnapshots(world=guest.member.world, rate_hz=30,
                                                                codec=plain.stream_pb2.CODEC_PLAIN))
            guest.next_snapshot()
            passed, seed = time.monotonic() - start, guest.world(guest.member.world).seed
            with lock:
                took.append(passed)
                seeds[guest.member.world] = seed
            guest.socket.close()

        threads = [threading.Thread(target=come) for _ in range(40)]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join()
        self.assertEqual(len(took), 40)
        print(f"40 joins at once: first snapshot after {sorted(took)[20]:.3f} s (median), {max(took):.3f} s (last)")
        self.assertEqual(len(set(seeds.values())), 40, "seeds of their own")
        self.assertLess(max(took), 20 if os.environ.get("SANITIZED") else 2)


class Managing(Case):
    def test_kick_and_readmit(self):
        server = self.serve()
        teacher = self.user(server, "frau_k")
        code = self.create(teacher).code
        anna, ben = (self.join(server, code, name) for name in ("Anna", "Ben"))
        personal = teacher.call(change_member=c.ChangeMember(**{"class": "bio2"}, number=2, new_personal_code=True))
        self.assertEqual(ben.goodbye().reason, c.REASON_TOKEN_REVOKED)
        letters = personal.personal_codes.codes[0].code
        self.assertRegex(letters, "^[BCDFGHJKLMNPQRSTVWXZ]{10}$")
        self.assertIsNone(self.guest(server, token=ben.member.token).welcome, "the earlier token")
        ben = self.join(server, letters)
        self.assertEqual((ben.member.name, ben.member.world), ("Ben", "bio2_ben"))
        teacher.call(change_member=c.ChangeMember(**{"class": "bio2"}, number=2, removed=True))
        self.assertEqual(ben.goodbye().reason, c.REASON_MEMBER_REMOVED)
        ben.assert_closed()
        self.refused(self.guest(server, token=ben.member.token), c.REASON_MEMBER_REMOVED)
        self.refused(self.join(server, letters), c.REASON_MEMBER_REMOVED)
        self.refused(self.join(server, code, "Ben"), c.REASON_MEMBER_NAME_TAKEN, c.CODE_ALREADY_EXISTS)
        anna.call(list_worlds=c.ListWorlds())
        teacher.call(change_member=c.ChangeMember(**{"class": "bio2"}, number=2, removed=False, name="Benno"))
        again = self.guest(server, token=ben.member.token)
        self.assertEqual((again.member.name, again.member.world, again.welcome.user), ("Benno", "bio2_ben", "bio2/ben"))
        refused = teacher.call(c.CODE_NOT_FOUND, change_member=c.ChangeMember(**{"class": "bio2"}, number=9))
        self.assertEqual((refused.status.reason, refused.status.violations[0].field),
                         (c.REASON_MEMBER_NOT_FOUND, "change_member.number"))

    def test_a_fourth_session_ends_the_oldest(self):
        server = self.serve()
        code = self.create(self.user(server, "frau_k")).code
        first = self.join(server, code, "Anna")
        others = [self.guest(server, token=first.member.token) for _ in range(3)]
        self.assertEqual(first.goodbye().reason, c.REASON_SESSIONS_MAX)
        for other in others:
            other.call(list_worlds=c.ListWorlds())

    def test_another_teacher_cannot_touch_the_class(self):
        server = self.serve()
        teacher, other, admin, viewer = (self.user(server, name) for name in ("frau_k", "herr_b", "root", "eve"))
        code = self.create(teacher).code
        self.create(other, "bio3")
        student = self.join(server, code, "Anna")
        before = self.info(teacher)
        for request in ({"update_class": c.UpdateClass(**{"class": "bio2"}, frozen=True)},
                        {"delete_class": c.DeleteClass(**{"class": "bio2"})},
                        {"add_members": c.AddMembers(**{"class": "bio2"}, names=["x"])},
                        {"change_member": c.ChangeMember(**{"class": "bio2"}, number=1, removed=True)},
                        {"for_each_world": c.ForEachWorld(**{"class": "bio2"}, pause=c.Pause())}):
            refused = other.call(c.CODE_NOT_FOUND, **request).status
            self.assertEqual((refused.reason, refused.violations[0].field),
                             (c.REASON_CLASS_NOT_FOUND, next(iter(request)) + ".class"))
            missing = {name: type(message).FromString(message.SerializeToString()) for name, message in request.items()}
            setattr(next(iter(missing.values())), "class", "bio4")
            same = other.call(c.CODE_NOT_FOUND, **missing).status
            self.assertEqual(same.message.replace("bio4", "bio2"), refused.message, "as a missing one")
            self.assertIn("did you mean bio3?", refused.violations[0].allowed)
            for lower in (viewer, student):
                lower.call(PERMISSION_DENIED, **request)
        self.assertIsNone(self.info(other))
        self.assertEqual(self.info(admin).name, "bio2")
        after = self.info(teacher)
        after.code_valid_s = before.code_valid_s
        self.assertEqual(after, before)
        exists = other.call(c.CODE_ALREADY_EXISTS, create_class=c.CreateClass(name="bio2")).status
        self.assertEqual(exists.reason, c.REASON_CLASS_EXISTS)

    def test_events_reach_those_who_manage_the_class(self):
        server = self.serve()
        teacher, other, admin, viewer = (self.user(server, name) for name in ("frau_k", "herr_b", "root", "eve"))
        for each in (teacher, other, admin, viewer):
            each.call(subscribe_events=c.SubscribeEvents())
        code = self.create(teacher).code
        for each in (teacher, admin):
            self.assertEqual(getattr(each.next_event("class_changed").class_changed, "class"), "bio2")
        guests = [self.join(server, code) for _ in range(10)]
        teacher.next_event("class_changed", lambda _: sum(m.sessions for m in self.info(teacher).members) == 10)
        for guest in guests:
            guest.socket.close()
        teacher.next_event("class_changed", lambda _: sum(m.sessions for m in self.info(teacher).members) == 0)
        for each in (other, viewer):
            each.call(list_worlds=c.ListWorlds())
            self.assertEqual([e for e in each.events if e.HasField("class_changed")], [])

    def test_every_wrong_field_is_named(self):
        server = self.serve()
        teacher = self.user(server, "frau_k")
        wrong = c.CreateClass(name="2B", seeds=7, member_worlds_max=9, lesson="../x", template=c.CreateWorld(
            name="mine", parameters=plain.assignments(population_size=100_000)), ranges=c.QuotaRanges(
                ranges=[c.QuotaRange(parameter="mutation_chanc", min=0, max=1)]))
        status = teacher.call(c.CODE_INVALID_ARGUMENT, create_class=wrong).status
        self.assertEqual({v.field: v.got for v in status.violations}, {
            "create_class.name": '"2B"', "create_class.seeds": "7", "create_class.member_worlds_max": "9",
            "create_class.lesson": "../x", "create_class.template.name": '"mine"',
            "create_class.template.population_size": "100000",
            "create_class.ranges.mutation_chanc": "an unknown name"})
        status = teacher.call(c.CODE_INVALID_ARGUMENT, create_class=c.CreateClass(name="bio2", template=c.CreateWorld(
            parameters=plain.assignments(population_size=100_000)))).status
        self.assertEqual(status.message, "create_class.template.population_size: got 100000, allowed 1 to 500 "
                                         "(class bio2)")
        status = teacher.call(c.CODE_INVALID_ARGUMENT, create_class=c.CreateClass(name="bio2", template=c.CreateWorld(
            parameters=plain.assignments(mutation_chance=3.0)))).status
        self.assertEqual(status.violations[0].field, "create_class.template.mutation_chance")
        self.create(teacher, ranges=c.QuotaRanges(ranges=[c.QuotaRange(parameter="population_size", min=10, max=20)]))
        ranges = {one.parameter: (one.min, one.max) for one in self.info(teacher).ranges.ranges}
        self.assertEqual((ranges["population_size"], ranges["food_count"]), ((10, 20), (0, 2000)))
        for names, field in (([], "add_members.names"), (["a"] * 65, "add_members.names"),
                             (["a", "b\n"], "add_members.names[1]")):
            status = teacher.call(c.CODE_INVALID_ARGUMENT,
                                  add_members=c.AddMembers(**{"class": "bio2"}, names=names)).status
            self.assertEqual(status.violations[0].field, field)
        status = teacher.call(c.CODE_ALREADY_EXISTS,
                              add_members=c.AddMembers(**{"class": "bio2"}, names=["Anna", "anna"])).status
        self.assertEqual(status.violations[0].field, "add_members.names[1]")
        self.assertEqual(len(self.info(teacher).members), 0, "all or none")

    def test_sixteen_classes_and_no_more(self):
        server = self.serve()
        teacher = self.user(server, "frau_k")
        for number in range(16):
            self.create(teacher, f"c{number}")
        status = teacher.call(RESOURCE_EXHAUSTED, create_class=c.CreateClass(name="c16")).status
        self.assertEqual(status.reason, c.REASON_CLASSES_MAX)
        self.assertEqual(len({one.code for one in teacher.call(list_classes=c.ListClasses()).classes.classes}), 16)

    def test_a_deleted_class_lets_no_member_in(self):
        server = self.serve()
        teacher = self.user(server, "frau_k")
        code = self.create(teacher).code
        anna = self.join(server, code, "Anna")
        teacher.call(delete_class=c.DeleteClass(**{"class": "bio2"}))
        self.assertEqual(anna.goodbye().reason, c.REASON_MEMBER_REMOVED)
        plain.until(lambda: "bio2_anna" not in {x.name for x in
                                                teacher.call(list_worlds=c.ListWorlds()).worlds.worlds}, "no world")
        self.refused(self.join(server, code), c.REASON_CODE_UNKNOWN)
        self.refused(self.guest(server, token=anna.member.token), c.REASON_TOKEN_UNKNOWN)
        self.create(teacher)
        self.assertEqual(len(self.info(teacher).members), 0)

    def test_qr_codes_are_read_by_another_program(self):
        server = self.serve()
        teacher = self.user(server, "frau_k")
        texts = ["http://lab:7745/#join=KTRMXB", "KTRMXB", "x" * 300]
        made = teacher.call(make_qr_codes=c.MakeQrCodes(texts=texts)).qr_codes.codes
        self.assertEqual(len(made), 3)
        try:
            import zbar
        except ImportError:
            self.skipTest("python3-zbar is not installed")
        for text, code in zip(texts, made):
            self.assertEqual(len(code.modules), code.size ** 2)
            side, scale = code.size + 8, 4  # with the quiet zone
            rows = [bytes([255] * side)] * 4
            for row in range(code.size):
                line = code.modules[row * code.size:(row + 1) * code.size]
                rows.append(bytes([255] * 4 + [0 if module else 255 for module in line] + [255] * 4))
            rows += [bytes([255] * side)] * 4
            image = b"".join(b"".join(bytes([value]) * scale for value in row) * scale for row in rows)
            found = zbar.Image(side * scale, side * scale, "Y800", image)
            self.assertEqual(zbar.ImageScanner().scan(found), 1)
            self.assertEqual([symbol.data for symbol in found], [text])
        for texts, field in (([], "make_qr_codes.texts"), (["a"] * 101, "make_qr_codes.texts"),
                             (["a", ""], "make_qr_codes.texts[1]"), (["a" * 301], "make_qr_codes.texts[0]")):
            status = teacher.call(c.CODE_INVALID_ARGUMENT, make_qr_codes=c.MakeQrCodes(texts=texts)).status
            self.assertEqual(status.violations[0].field, field)


class Restarts(Case):
    def test_a_restart_loses_nothing(self):
        server = self.serve()
        teacher = self.user(server, "frau_k")
        code = self.create(teacher).code
        anna, ben = (self.join(server, code, name) for name in ("Anna", "Ben"))
        teacher.call(change_member=c.ChangeMember(**{"class": "bio2"}, number=2, removed=True))
        teacher.call(update_class=c.UpdateClass(**{"class": "bio2"}, lesson="drift", member_worlds_max=5, frozen=True))
        before = self.info(teacher)
        for end in (server.end, None):
            end() if end else server.kill()
            server = self.serve()
            teacher = self.user(server, "frau_k")
            after = self.info(teacher)
            self.assertLessEqual(after.code_valid_s, before.code_valid_s)
            self.assertGreater(after.code_valid_s, 600)
            after.code_valid_s = before.code_valid_s
            for members in (before.members, after.members):
                for member in members:
                    member.sessions = 0
            self.assertEqual(after, before)
            again = self.guest(server, token=anna.member.token)
            self.assertEqual(again.world(again.member.world).seed, 7)
            self.refused(self.guest(server, token=ben.member.token), c.REASON_MEMBER_REMOVED)
            self.assertIsNotNone(self.join(server, code).welcome)
            before = self.info(teacher)
        self.assertEqual(stat.S_IMODE(os.stat(f"{self.folder}/classes.sqlite").st_mode), 0o600)
        self.assertNotIn(code.encode(), anna.member.token.encode())
        with open(f"{self.folder}/classes.sqlite", "rb") as file:
            self.assertNotIn(anna.member.token.encode(), file.read(), "only digests are stored")
        self.assertNotIn(" error ", server.output(), "a world that exists already is normal")

    def test_a_kill_during_forty_joins_mixes_nothing_up(self):
        rounds = int(os.environ.get("KILLS", 3))
        for round_number in range(rounds):
            name = f"k{round_number}"
            server = self.serve("--worlds-max", "200")
            teacher = self.user(server, "frau_k")
            code = self.create(teacher, name).code
            welcomes, lock = {}, threading.Lock()

            def come(number):
                try:
                    guest = Guest(server, join=session_pb2.Join(code=code, name=f"Student {number}"))
                    if guest.welcome:
                        with lock:
                            welcomes[number] = guest.member
                    guest.world(guest.member.world)
                    guest.socket.close()
                except (EOFError, OSError):
                    pass  # the server was killed

            threads = [threading.Thread(target=come, args=(number,)) for number in range(40)]
            for thread in threads:
                thread.start()
            enough = random.Random(round_number).randrange(1, 35)
            plain.until(lambda: len(welcomes) >= enough, "joins")
            server.kill()
            for thread in threads:
                thread.join()
            server = self.serve("--worlds-max", "200")
            teacher = self.user(server, "frau_k")
            members = {member.name: member for member in self.info(teacher, name).members}
            self.assertGreaterEqual(len(members), len(welcomes))
            self.assertEqual(len({member.user for member in members.values()}), len(members))
            for number, membership in welcomes.items():
                again = self.guest(server, token=membership.token)
                self.assertEqual((again.member.name, again.member.world), (f"Student {number}", membership.world))
                self.assertEqual(again.world(again.member.world).tick, 0)
            teacher.call(delete_class=c.DeleteClass(**{"class": name}))
            server.end()

    def test_a_backup_contains_the_classes(self):
        server = self.serve()
        teacher = self.user(server, "frau_k")
        code = self.create(teacher).code
        anna = self.join(server, code, "Anna")
        copy = self.folder + "-copy"
        self.addCleanup(lambda: shutil.rmtree(copy, ignore_errors=True))
        done = waiting.run([EVOD, "backup", copy, "--data", self.folder], capture_output=True, text=True)
        self.assertRegex(done.stdout, "the tokens and the classes, ")
        self.assertEqual(stat.S_IMODE(os.stat(f"{copy}/classes.sqlite").st_mode), 0o600)
        restored = self.server("--data", copy, "--require-token")
        self.assertEqual(self.guest(restored, token=anna.member.token).member.name, "Anna")
        with sqlite3.connect(f"{copy}/classes.sqlite") as file:
            self.assertEqual(file.execute("SELECT name FROM member").fetchall(), [("Anna",)])

    def test_without_a_data_folder_classes_are_in_memory(self):
        server = self.server("--keep-nothing")
        admin = self.guest(server)
        code = self.create(admin).code
        self.assertEqual(self.join(server, code, "Anna").member.world, "bio2_anna")


if __name__ == "__main__":
    unittest.main(argv=[sys.argv[0], *sys.argv[4:]], verbosity=2, warnings="ignore")
