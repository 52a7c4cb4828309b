"""Tokens, roles and TLS over real sockets. EVOD and EVOCTL name the programs, MESSAGES
the folder of the message classes."""
import csv
import io
import json
import os
import pathlib
import pty
import re
import shutil
import signal
import socket
import ssl
import stat
import struct
import subprocess
import sys
import termios
import time
import unittest

import past_test as past
import waiting
from past_test import EVOD, EVOCTL, c, plain

from evod.v1 import session_pb2, world_pb2 as w  # noqa: E402  (its folder is in sys.path now)

VIEWER, TEACHER, CONTROLLER, ADMIN = c.ROLE_VIEWER, c.ROLE_TEACHER, c.ROLE_CONTROLLER, c.ROLE_ADMIN
PERMISSION_DENIED, RESOURCE_EXHAUSTED, UNAUTHENTICATED = 7, 8, 16

# The lowest role of every request, stated independently of commands.proto. Add new requests here, too.
LEAST = {
    "create_world": ADMIN, "delete_world": ADMIN, "fork_world": ADMIN, "shut_down": ADMIN,
    "reset_world": CONTROLLER, "release_lease": CONTROLLER, "renew_lease": CONTROLLER, "run": CONTROLLER,
         "run_until_tick": CONTROLLER, "pause": CONTROLLER,
    "resume": CONTROLLER, "set_speed": CONTROLLER, "set_parameters": CONTROLLER, "cancel_change": CONTROLLER,
         "place": CONTROLLER, "remove": CONTROLLER, "set_fitness": CONTROLLER, "seek": CONTROLLER,
    "close_replay": CONTROLLER,
    "list_worlds": VIEWER, "get_parameters": VIEWER, "get_statistics": VIEWER, "get_history": VIEWER,
    "get_organism": VIEWER, "describe": VIEWER, "get_metrics": VIEWER, "get_breeding": VIEWER,
    "get_population": VIEWER, "get_motion": VIEWER, "subscribe_snapshots": VIEWER, "subscribe_events": VIEWER,
    "unsubscribe": VIEWER, "request_keyframe": VIEWER, "open_replay": VIEWER, "export_run": VIEWER,
         "continue_export": VIEWER,
    "set_view": VIEWER, "observe": VIEWER,
    "for_each_world": TEACHER, "create_class": TEACHER, "update_class": TEACHER, "delete_class": TEACHER,
    "list_classes": TEACHER, "add_members": TEACHER, "change_member": TEACHER, "make_qr_codes": TEACHER,
    "add_note": CONTROLLER,
}
NAMES = {VIEWER: "viewer", TEACHER: "teacher", CONTROLLER: "controller", ADMIN: "admin"}  # each includes those before
# How a request is refused that the owner of a world may send: the fields are checked before the owner is known.
REFUSED = {3, PERMISSION_DENIED, 9}


def includes(role, other):
    return list(NAMES).index(role) >= list(NAMES).index(other)


def is_for_owners(request):
    return c.Request.DESCRIPTOR.fields_by_name[request].GetOptions().Extensions[c.rules].by_owner


def token_command(*words, data, status=0):
    done = waiting.run([EVOD, "token", *words, "--data", data], capture_output=True, text=True)
    assert done.returncode == status, done
    return done.stdout if status == 0 else done.stderr


class Client(past.Client):
    """token: sent in the Hello. come_from: an address of this machine. tls: a context; None: without TLS."""

    def __init__(self, server, token="", come_from="127.0.0.1", tls=None, host="localhost"):
        over = self.connected(server, come_from)
        if tls:
            over = tls.wrap_socket(over, server_hostname=host)
        super().__init__(server, hello=False, over=over)
        self.hello(token=token)
        self.first = self.control()
        self.welcome = self.first.welcome if self.first.HasField("welcome") else None
        self.refusal = self.first.goodbye.status if self.first.HasField("goodbye") else None


class Access(past.Case):
    def setUp(self):
        super().setUp()
        self.secrets = {}

    def token(self, name, role):
        secret = token_command("add", name, "--role", NAMES[role], data=self.folder).strip()
        self.assertRegex(secret, r"^evod_[0-9a-f]{64}$")
        self.secrets[name] = secret
        return secret

    def serve(self, *options):
        return self.server("--data", self.folder, *options)

    def come(self, server, *arguments, **options):
        client = Client(server, *arguments, **options)
        self.addCleanup(client.socket.close)
        return client

    def evoctl(self, *words, server, status=0, environment=None, **options):
        done = waiting.run([EVOCTL, "--server", f"localhost:{server.port}", *waiting.PATIENT, *words],
                           capture_output=True, text=True, env={**os.environ, **(environment or {})}, **options)
        self.assertEqual(done.returncode, status, done.stdout + done.stderr)
        return done.stdout + done.stderr


class Roles(Access):
    def test_every_request_has_its_least_role(self):
        requests = [field.name for field in c.Request.DESCRIPTOR.oneofs_by_name["kind"].fields]
        self.assertEqual(sorted(requests), sorted(LEAST))
        for role, name in NAMES.items():
            self.token(name, role)
        server = self.serve("--require-token")
        for role, name in NAMES.items():
            client = self.come(server, self.secrets[name])
            self.assertEqual((client.welcome.role, client.welcome.user), (role, NAMES[role]))
            # ShutDown ends the server. An empty request does nothing, or is refused for missing fields.
            for request in sorted(requests, key="shut_down".__eq__):
                if request == "shut_down" and role == ADMIN:
                    continue
                message = type(getattr(c.Request(), request))()
                status = client.response(client.ask(**{request: message})).status
                denied = not includes(role, LEAST[request])
                if denied and is_for_owners(request):
                    self.assertIn(status.code, REFUSED, f"{request} as {NAMES[role]}: {status}")
                    continue
                self.assertEqual(status.code == PERMISSION_DENIED, denied, f"{request} as {NAMES[role]}: {status}")
                if denied:
                    self.assertIn(f"needs the role {NAMES[LEAST[request]]}", status.message)
        admin = self.come(server, self.secrets["admin"])
        admin.call(shut_down=c.ShutDown())
        self.assertEqual(waiting.ended(server.process), 0)

    def test_a_client_key_belongs_to_its_user(self):
        ada, bob, eve = self.token("ada", ADMIN), self.token("bob", CONTROLLER), self.token("eve", VIEWER)
        server = self.serve("--require-token")
        paused = {}
        for restarted in (False, True):
            admin, other, viewer = (self.come(server, secret) for secret in (ada, bob, eve))
            sent = dict(client_key="k", request_id=1, run_until_tick=c.RunUntilTick(tick=7))
            first = admin.call(**sent)
            self.assertEqual(paused.setdefault("first", first), first)
            other.call(client_key="k", request_id=2 if restarted else 1,
                       set_speed=c.SetSpeed(speed=plain.w.Speed(max=True)))
            other.call(client_key="k", request_id=2**63, pause=c.Pause())
            self.assertEqual(admin.call(**sent), first)
            admin.call(client_key="k", request_id=3 if restarted else 2, pause=c.Pause())
            # Those who see programs and addresses in events and in the history see them here, too.
            whole = {(user, "plain", "127.0.0.1") for user in ("ada", "bob")}
            for client, clients in ((viewer, {("ada", "", ""), ("bob", "", "")}), (other, whole), (admin, whole)):
                exported = c.ExportRun(table=c.RUN_TABLE_EVENTS, format=c.TEXT_FORMAT_CSV)
                table = list(csv.DictReader(io.StringIO(plain.until(
                    lambda: (lambda part: part.text if part.last
                             else None)(client.call(export_run=exported).export_part),
                    "the whole table").decode())))
                self.assertNotIn("client_key", table[0])
                self.assertNotIn('"k"', "".join(row["request"] for row in table))
                shown = {(row["user"], row["program"], row["address"].rsplit(":", 1)[0])
                         for row in table if row["sender"] == "client"}
                self.assertEqual(shown, clients)
            for client in (admin, other, viewer):
                client.socket.close()
            if not restarted:
                server.kill()
                server = self.serve("--require-token")

    def test_a_viewer_changes_nothing(self):
        secret = self.token("anna", VIEWER)
        viewer = self.come(self.serve("--require-token", "--seed", "4"), secret)
        before = viewer.world()
        for request in [name for name, role in LEAST.items() if role != VIEWER]:
            code = viewer.response(viewer.ask(**{request: type(getattr(c.Request(), request))()})).status.code
            self.assertIn(code, REFUSED if is_for_owners(request) else {PERMISSION_DENIED}, request)
        after = viewer.world()
        self.assertEqual(after.SerializeToString(), before.SerializeToString())

    def test_a_viewer_reads_no_path_of_the_server(self):
        folder = os.path.join(self.folder, "my data")
        os.mkdir(folder)
        start = lambda: self.server("--data", folder, "--http-port", "0")
        token = token_command("add", "v", "--role", "viewer", data=folder).strip()
        admin = token_command("add", "a", "--role", "admin", data=folder).strip()
        server = start()
        self.recorded(self.come(server, token=admin))
        server.end()
        for copy in ("damaged", "missing"):
            shutil.copy(f"{folder}/w.evod", f"{folder}/{copy}.evod")
        with open(f"{folder}/damaged.evod", "r+b") as file:
            file.truncate(5000)
        server = start()
        viewer, admin = self.come(server, token=token), self.come(server, token=admin)
        os.rename(f"{folder}/missing.evod", f"{folder}/moved.evod")
        texts = [str(viewer.call(list_worlds=c.ListWorlds())), str(viewer.call(get_metrics=c.GetMetrics()))]
        self.assertIn("damaged.evod", texts[0])
        tables = [c.RUN_TABLE_POPULATION, c.RUN_TABLE_ORGANISMS]
        requests = [dict(export_run=c.ExportRun(world="w", table=tables[0], format=c.TEXT_FORMAT_CSV, generation=99))]
        for world in ("damaged", "missing"):
            requests += [dict(export_run=c.ExportRun(world=world, table=table, format=c.TEXT_FORMAT_CSV))
                         for table in tables]
            requests += [dict(get_breeding=c.GetBreeding(world=world)), dict(open_replay=c.OpenReplay(world=world))]
        for request in requests:
            texts.append(str(viewer.response(viewer.ask(**request))))
        self.assertIn("w.evod has no such generation", texts[2])
        self.assertRegex("".join(texts[3:]), r"missing\S*\.evod")
        texts.append(str(admin.response(admin.ask(fork_world=c.ForkWorld(world="missing", name="f", at_generation=1)))))
        for text in texts:
            self.assertNotIn(self.folder, text)
            self.assertNotIn("my data", text)
        self.assertIn(folder, server.output())  # the log names the files with their paths

    def test_only_admins_may_send_long_frames(self):
        tokens = {role: self.token(name, role) for name, role in (("ada", ADMIN), ("bob", CONTROLLER), ("eve", VIEWER))}
        server = self.serve("--require-token")
        for role, longest in ((ADMIN, 1 << 20), (CONTROLLER, 1 << 16), (VIEWER, 1 << 16)):
            client = self.come(server, tokens[role])
            self.assertEqual(client.welcome.limits.control_frame_bytes_max, longest)
            self.assertEqual(client.call(describe=c.Describe()).description.limits.control_frame_bytes_max, longest)
            client.socket.sendall(b"EV\x01\x01" + struct.pack("<I", longest + 1))
            self.assertIn(str(longest), client.control().goodbye.status.message)

    def test_a_viewer_plays_the_past_it_has_opened_and_no_other(self):
        karl, anna, otto = self.token("karl", CONTROLLER), self.token("anna", VIEWER), self.token("otto", VIEWER)
        server = self.serve("--require-token", "--speed", "max")
        controller, viewer, other = (self.come(server, secret) for secret in (karl, anna, otto))
        controller.call(run_until_tick=c.RunUntilTick(tick=3000))
        plain.until(lambda: viewer.world().tick == 3000, "ticks")
        past_world = viewer.call(open_replay=c.OpenReplay()).world.name
        for request in ({"run_until_tick": c.RunUntilTick(world=past_world, tick=20)},
                        {"seek": c.Seek(world=past_world, to=c.RunMoment(tick=40))},
                        {"set_speed": c.SetSpeed(world=past_world, speed=plain.w.Speed(max=True))},
                        {"pause": c.Pause(world=past_world)}, {"run": c.Run(world=past_world)},
                        {"resume": c.Resume(world=past_world)}, {"close_replay": c.CloseReplay(world=past_world)}):
            other.call(PERMISSION_DENIED, **request)
            viewer.call(**request)
        viewer.call(PERMISSION_DENIED, run=c.Run(world="default"))

    def test_events_name_their_actor(self):
        karl, anna = self.token("karl", CONTROLLER), self.token("anna", VIEWER)
        server = self.serve("--require-token")
        controller, viewer = self.come(server, karl), self.come(server, anna)
        other = self.come(server, karl)
        for client in (viewer, other):
            client.call(subscribe_events=c.SubscribeEvents())
        controller.call(set_parameters=plain.set_parameters(mutation_chance=0.3))
        event = other.next_event("parameters_changed")
        by = event.parameters_changed.by
        self.assertEqual((by.kind, by.user, by.client), (w.ACTOR_KIND_CLIENT, "karl", "plain"))
        self.assertRegex(by.address, r"^127\.0\.0\.1:\d+$")
        of_karl = w.Actor(kind=w.ACTOR_KIND_CLIENT, user="karl")
        self.assertEqual(event.text, f"karl: plain {by.address} set mutation_chance to 0.3, revision 2")
        event = viewer.next_event("parameters_changed")
        self.assertEqual(event.parameters_changed.by, of_karl)
        self.assertEqual(event.text, "karl set mutation_chance to 0.3, revision 2")
        change = plain.set_parameters(mutation_chance=0.4)
        change.at_generation = 9
        controller.call(set_parameters=change)
        self.assertEqual(viewer.next_event("change_planned").change_planned.change.by, of_karl)
        for client, name in ((viewer, ""), (other, "plain")):
            planned = client.call(get_parameters=c.GetParameters()).parameters.planned
            self.assertEqual((planned[0].by.user, planned[0].by.client), ("karl", name))


class Tokens(Access):
    def test_on_loopback_a_token_is_optional_but_respected(self):
        server = self.serve()
        self.assertEqual(self.come(server).welcome.role, ADMIN)
        self.assertEqual(self.come(server).welcome.user, "")
        secret = self.token("anna", VIEWER)
        plain.until(lambda: Client(server, secret, come_from="127.0.0.3").welcome, "the server has seen the file")
        client = self.come(server, secret)
        self.assertEqual((client.welcome.role, client.welcome.user), (VIEWER, "anna"))
        self.assertEqual(self.come(server, "evod_nonsense").refusal.code, UNAUTHENTICATED)

    def test_a_client_may_have_any_name(self):
        server = self.serve()
        watches = self.come(server)
        watches.call(subscribe_events=c.SubscribeEvents())
        names = ("ada:", "a: b", ": ", "evod", "ada: evod", "127.0.0.1:1", " ", "a:b:")
        for name in names:
            client = plain.Client(server, hello=False)
            self.addCleanup(client.socket.close)
            client.hello(client_name=name)
            client.control()
            client.call(set_parameters=plain.set_parameters(mutation_chance=0.3))
            by = watches.next_event("parameters_changed").parameters_changed.by
            self.assertEqual((by.kind, by.user, by.client), (w.ACTOR_KIND_CLIENT, "", name))
            client.call(client_key="again", request_id=1, pause=c.Pause())
            client.call(client_key="again", request_id=1, pause=c.Pause())
        exported = c.ExportRun(table=c.RUN_TABLE_EVENTS, format=c.TEXT_FORMAT_JSON_LINES)
        table = plain.until(lambda: (lambda part: part.text if part.last else None)(
            watches.call(export_run=exported).export_part), "the whole table").decode().splitlines()
        rows = [row for row in map(json.loads, table) if row["kind"] == "set_parameters"]
        self.assertEqual([(row["sender"], row["user"], row["program"]) for row in rows],
                         [("client", "", name) for name in names])

    def test_on_other_interfaces_a_token_must_exist(self):
        done = waiting.run([EVOD, "--bind", "0.0.0.0", "--port", "0", "--data", self.folder], capture_output=True,
                           text=True)
        self.assertEqual(done.returncode, 1)
        self.assertIn(f"evod token add NAME --role admin --data {self.folder}", done.stderr)

    def test_a_missing_or_wrong_token_is_refused(self):
        self.token("anna", VIEWER)
        server = self.serve("--require-token")
        self.assertEqual(self.come(server).refusal.code, UNAUTHENTICATED)
        for wrong in ("evod_" + "0" * 64, self.secrets["anna"][:-1], self.secrets["anna"].upper(), "x" * 3000):
            client = self.come(server, wrong)
            self.assertIn(client.refusal.code, (UNAUTHENTICATED, RESOURCE_EXHAUSTED))
            client.assert_closed()

    def test_a_revoked_token_ends_its_sessions(self):
        karl = self.token("karl", CONTROLLER)
        server = self.serve("--require-token")
        stays = self.come(server, karl)

        def revoke(lap):
            anna = self.token("anna", VIEWER)
            goes = plain.until(lambda: (lambda came: came if came.welcome else None)(self.come(server, anna)),
                               "admission")
            token_command("revoke", "anna", data=self.folder)
            lap()
            revoked = time.monotonic()
            message = goes.control()
            self.assertEqual(message.goodbye.status.code, UNAUTHENTICATED)
            goes.assert_closed()
            self.assertLess(time.monotonic() - revoked, 2)
            return anna
        anna = waiting.quicker_than(2, revoke)
        stays.call(list_worlds=c.ListWorlds())
        self.assertEqual(self.come(server, anna, come_from="127.0.0.2").refusal.code, UNAUTHENTICATED)

    def test_no_secret_is_written_anywhere(self):
        secret = self.token("anna", ADMIN)
        server = self.serve("--require-token")
        client = self.come(server, secret)
        client.call(set_parameters=plain.set_parameters(mutation_chance=0.3))
        # Sends a token in every message that may contain one, with everything else wrong, to see what gets logged.
        refusals = [self.come(server, secret[:-1] + "x", come_from="127.0.0.3").refusal]
        for hello in (dict(protocol_version=2), dict(client_version="v" * 65), dict(client_name="n" * 65)):
            with plain.Client(server, hello=False) as stranger:
                stranger.hello(token=secret, **hello)
                refusals.append(stranger.control().goodbye.status)
        client.hello(token=secret)
        refusals.append(client.response(0).status)
        body = session_pb2.ClientMessage(hello=session_pb2.Hello(token=secret)).SerializeToString()
        for damaged in (body[:-1], body + b"\xff", b"\x12" + body):
            client.send_body(damaged)
            refusals.append(client.response(0).status)
        client.socket.sendall(body)  # without its header
        refusals.append(client.goodbye())
        client.assert_closed()
        for refusal in refusals:
            self.assertTrue(refusal.message)
            self.assertNotIn(secret[5:37], str(refusal))
        refused = self.evoctl("worlds", server=server, environment={"EVOD_TOKEN": secret[:-1]}, status=4)
        self.assertNotIn(secret[5:37], refused)
        token_command("revoke", "anna", data=self.folder)
        plain.until(lambda: Client(server, secret, come_from="127.0.0.9").refusal, "it is revoked")
        server.end()
        for digits in (secret[5:], secret[5:37]):
            self.assertNotIn(digits, server.output())
            for path in pathlib.Path(self.folder).iterdir():
                self.assertNotIn(digits.encode(), path.read_bytes(), path)

    def test_evoctl_reads_a_token_from_env_file_or_terminal(self):
        secret = self.token("anna", VIEWER)
        server = self.serve("--require-token")
        self.assertIn("default", self.evoctl("worlds", server=server, environment={"EVOD_TOKEN": secret}))
        path = pathlib.Path(self.folder) / "my-token"
        path.write_text(secret + "\n")
        path.chmod(0o644)
        self.assertIn("chmod 600", self.evoctl("--token-file", str(path), "worlds", server=server, status=2))
        path.chmod(0o600)
        self.assertIn("default", self.evoctl("--token-file", str(path), "worlds", server=server))
        self.assertIn("requires a token", self.evoctl("worlds", server=server, status=4, stdin=subprocess.DEVNULL))
        self.assertIn("needs the role controller",
                      self.evoctl("pause", server=server, environment={"EVOD_TOKEN": secret}, status=1))
        terminal, side = pty.openpty()
        with subprocess.Popen([EVOCTL, "--server", f"localhost:{server.port}", "worlds"], stdin=side, stderr=side,
                              stdout=subprocess.PIPE, text=True) as asking:
            os.close(side)
            shown = b""
            while b"token for" not in shown:
                shown += os.read(terminal, 1000)
            os.write(terminal, secret.encode() + b"\n")
            self.assertEqual(asking.stdout.read(), "default\n")
            self.assertEqual(waiting.ended(asking), 0)
            self.assertNotIn(secret[5:].encode(), shown)
        os.close(terminal)

    def test_a_signal_at_the_prompt_restores_the_terminal(self):
        self.token("otto", VIEWER)
        server = self.serve("--require-token")
        for number in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP):
            terminal, side = pty.openpty()
            before = termios.tcgetattr(side)
            with subprocess.Popen([EVOCTL, "--server", f"localhost:{server.port}", "worlds"], stdin=side,
                                  stderr=side) as asking:
                shown = b""
                while b"token for" not in shown:
                    shown += os.read(terminal, 1000)
                self.assertFalse(termios.tcgetattr(side)[3] & termios.ECHO)
                asking.send_signal(number)
                self.assertEqual(waiting.ended(asking), -number)
            self.assertEqual(termios.tcgetattr(side), before)
            os.close(side)
            os.close(terminal)

    def test_connections_without_hello_do_not_fill_the_log(self):
        server = self.serve()
        for _ in range(200):
            with socket.create_connection(("127.0.0.1", server.port)) as stranger:
                stranger.sendall(b"GET / HTTP/1.1\r\n\r\n")
                while stranger.recv(1000):
                    pass
        self.assertLess(server.output().count(" closed: "), 150)

        def another():
            with socket.create_connection(("127.0.0.1", server.port)) as stranger:
                stranger.sendall(b"GET / HTTP/1.1\r\n\r\n")
                while stranger.recv(1000):
                    pass
            return "earlier connections were not logged" in server.output()
        plain.until(another, "how many were left out")

    def test_local_clients_are_logged_at_level_debug(self):
        for options, logged in (((), False), (("--log-level", "debug"), True)):
            server = self.serve(*options)
            self.come(server).world()
            server.end()
            self.assertEqual(("connected as admin" in server.output(), "disconnected" in server.output()),
                             (logged, logged))


class Tls(Access):
    def setUp(self):
        super().setUp()
        self.pair("certificates")

    def pair(self, folder, *hosts):
        path = pathlib.Path(self.folder) / folder
        path.mkdir()
        waiting.run([EVOD, "certificate", *(hosts or ("localhost", "127.0.0.1")), "--folder", path], check=True)
        self.assertEqual(stat.S_IMODE((path / "evod.key").stat().st_mode), 0o600)
        return path

    def files(self, folder="certificates"):
        path = pathlib.Path(self.folder) / folder
        return ["--tls-cert", str(path / "evod.crt"), "--tls-key", str(path / "evod.key")]

    def context(self, folder="certificates"):
        context = ssl.create_default_context(cafile=pathlib.Path(self.folder) / folder / "evod.crt")
        return context

    def test_a_client_that_trusts_the_certificate_connects(self):
        secret = self.token("anna", ADMIN)
        server = self.serve("--require-token", *self.files())
        client = self.come(server, secret, tls=self.context())
        self.assertIn(client.socket.version(), ("TLSv1.2", "TLSv1.3"))
        client.call(subscribe_snapshots=c.SubscribeSnapshots(rate_hz=60))
        client.call(run_until_tick=c.RunUntilTick(tick=30))
        client.next_snapshot(lambda snapshot: snapshot.tick == 30)
        self.assertIsNotNone(self.come(server, secret, tls=self.context(), host="127.0.0.1").welcome)
        server.end()

    def test_the_server_ends_tls_with_close_notify(self):
        server = self.serve(*self.files())
        client, other = self.come(server, tls=self.context()), self.come(server, tls=self.context())
        failing = self.come(server, tls=self.context())
        for one in (client, other, failing):  # a connection cut without close_notify raises an error
            one.socket.suppress_ragged_eofs = False
        failing.socket.sendall(b"not a frame")
        self.assertEqual(failing.control().goodbye.status.code, 3)
        self.assertEqual(failing.socket.recv(1), b"")
        client.call(subscribe_snapshots=c.SubscribeSnapshots(rate_hz=60))
        client.call(shut_down=c.ShutDown())
        for one in (client, other):
            one.next_event("server_going_away")
            one.assert_closed()
        self.assertEqual(waiting.ended(server.process), 0)

    def test_sighup_reloads_the_certificate(self):
        server = self.serve(*self.files())
        old = self.come(server, tls=self.context())
        self.pair("new")
        for name in ("evod.crt", "evod.key"):
            (pathlib.Path(self.folder) / "new" / name).replace(pathlib.Path(self.folder) / "certificates" / name)
        new = self.context()
        server.process.send_signal(signal.SIGHUP)
        plain.until(lambda: "certificate reloaded" in server.output(), "a line in the log")
        self.assertIsNotNone(self.come(server, tls=new).welcome)
        old.call(list_worlds=c.ListWorlds())
        (pathlib.Path(self.folder) / "certificates" / "evod.crt").write_text("nothing")
        server.process.send_signal(signal.SIGHUP)
        plain.until(lambda: "keeping the old certificate: --tls-cert" in server.output(), "a line in the log")
        self.assertIsNotNone(self.come(server, tls=new).welcome)
        server.end()

    def test_old_tls_and_wrong_authority_or_host_are_refused(self):
        server = self.serve(*self.files())
        self.pair("strangers")
        with self.assertRaises(ssl.SSLCertVerificationError):
            self.come(server, tls=self.context("strangers"))
        with self.assertRaises(ssl.SSLCertVerificationError):
            self.come(server, tls=self.context(), host="elsewhere.example")
        old = self.context()
        old.set_ciphers("ALL:@SECLEVEL=0")
        old.minimum_version = ssl.TLSVersion.TLSv1
        old.maximum_version = ssl.TLSVersion.TLSv1_1
        with self.assertRaises(ssl.SSLError):
            self.come(server, tls=old)
        self.assertIsNotNone(self.come(server, tls=self.context()).welcome)

    def test_a_client_without_tls_gets_a_goodbye(self):
        server = self.serve(*self.files())
        self.assertIn("requires TLS", self.come(server).refusal.message)
        self.assertIn("requires TLS", self.evoctl("worlds", server=server, status=3))
        with socket.create_connection(("127.0.0.1", server.port)) as silent:
            self.assertEqual(waiting.receive(silent, 1), b"")  # no Goodbye is possible before TLS has begun
        plain.until(lambda: "no Hello was received within 5 s" in server.output(), "it is logged")
        self.assertNotIn("Operation canceled", server.output())
        for hello in (b"\x16", b"\x16\x03\x01\x00\x05nonsense", b"\x00" * 100):
            with socket.create_connection(("127.0.0.1", server.port)) as rude:
                rude.sendall(hello)
        self.assertIsNotNone(self.come(server, tls=self.context()).welcome)

    def test_evoctl_verifies(self):
        server = self.serve(*self.files())
        self.pair("strangers")
        certificates, strangers = (f"{self.folder}/{name}/evod.crt" for name in ("certificates", "strangers"))
        self.assertIn("default", self.evoctl("--ca", certificates, "worlds", server=server))
        self.assertIn("default", self.evoctl("worlds", server=server, environment={"EVOD_CA": certificates}))
        for words, options in ((f"not trusted: .*{strangers} has not signed it", ["--ca", strangers]),
                               ("not trusted: .*give the server's evod.crt with --ca", ["--tls"]),
                               ("^evoctl: --ca: /nowhere cannot be used for TLS: cannot be read: No such file",
                                ["--ca", "/nowhere"]),
                               (f"^evoctl: --cert: {__file__} cannot be used",
                                ["--ca", certificates, "--cert", __file__]),
                               ("^evoctl: --cert: .*give the key with --key",
                                ["--ca", certificates, "--cert", certificates])):
            self.assertRegex(self.evoctl(*options, "worlds", server=server, status=3), words)
        server.end()
        elsewhere = self.pair("elsewhere", "elsewhere.example")
        self.assertIn("not trusted: it is for other names (elsewhere.example): reach the server by one of them",
                      self.evoctl("--ca", str(elsewhere / "evod.crt"), "worlds", status=3,
                                  server=self.serve(*self.files("elsewhere"))))

    def test_evoctl_says_that_a_server_does_not_speak_tls(self):
        answer = self.evoctl("--ca", f"{self.folder}/certificates/evod.crt", "worlds", server=self.serve(), status=3)
        self.assertRegex(answer, "no TLS with localhost:[0-9]+: it does not use TLS: leave out --ca")

    def test_clients_may_have_to_show_a_certificate(self):
        clients = self.pair("clients", "client")
        server = self.serve(*self.files(), "--tls-client-ca", str(clients / "evod.crt"))
        context = self.context()
        with self.assertRaises((ssl.SSLError, ConnectionError, AssertionError)):
            self.come(server, tls=context)
        trusting = ["--ca", f"{self.folder}/certificates/evod.crt"]
        # The refusal may be lost with the connection.
        lost = "closed the connection: it may require another client certificate, see --cert"
        self.assertRegex(self.evoctl(*trusting, "worlds", server=server, status=3),
                         f"it requires a client certificate: give one with --cert and --key|{lost}")
        other = self.pair("others", "client")
        self.assertRegex(self.evoctl(*trusting, "--cert", str(other / "evod.crt"), "--key", str(other / "evod.key"),
                                     "worlds", server=server, status=3),
                         f"it does not trust the certificate of --cert|{lost}")
        context.load_cert_chain(clients / "evod.crt", clients / "evod.key")
        self.assertIsNotNone(self.come(server, tls=context).welcome)
        self.assertIn("default", self.evoctl("--ca", f"{self.folder}/certificates/evod.crt", "--cert",
                                             str(clients / "evod.crt"), "--key", str(clients / "evod.key"), "worlds",
                                             server=server))

    def test_faults_of_the_certificate_files_are_named(self):
        path = pathlib.Path(self.folder) / "certificates"
        (path / "none.pem").write_text("nothing")
        (path / "none.pem").chmod(0o600)
        other = self.pair("strangers")
        for options, words in ((["--tls-cert", path / "evod.crt"], "--tls-cert requires --tls-key"),
                               (["--tls-cert", path / "none.pem", "--tls-key", path / "evod.key"],
                                "--tls-cert: .*none.pem"),
                               (["--tls-cert", path / "evod.crt", "--tls-key", path / "gone"],
                                "--tls-key: .*gone.*No such"),
                               (["--tls-cert", path / "evod.crt", "--tls-key", path / "none.pem"],
                                "--tls-key: .*none.pem"),
                               (["--tls-cert", path / "evod.crt", "--tls-key", other / "evod.key"], "--tls-key: .*")):
            done = waiting.run([EVOD, "--port", "0", "--data", self.folder, *map(str, options)], capture_output=True,
                               text=True)
            self.assertEqual(done.returncode, 1)
            self.assertTrue(re.search(words, done.stderr), done.stderr)
        (path / "evod.key").chmod(0o644)
        done = waiting.run([EVOD, "--port", "0", "--data", self.folder, *self.files()], capture_output=True, text=True)
        self.assertIn("chmod 600", done.stderr)
        again = waiting.run([EVOD, "certificate", "localhost", "--folder", path], capture_output=True, text=True)
        self.assertEqual(again.returncode, 1)
        self.assertIn("exists already", again.stderr)


if __name__ == "__main__":
    unittest.main(argv=[sys.argv[0], *sys.argv[4:]])
