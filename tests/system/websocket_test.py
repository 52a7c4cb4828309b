"""The server's side of the browser viewer: the page over HTTP, sessions in WebSockets, and who may open them. EVOD and
EVOCTL name the programs, MESSAGES the folder of the message classes."""
import contextlib
import gzip
import http.client
import math
import os
import pathlib
import re
import signal
import socket
import ssl
import struct
import subprocess
import sys
import threading
import time
import unittest

import access_test as access
import metrics_test as metrics
import waiting
import websocket_client as ws
from metrics_test import EVOD, c, plain
from websocket_client import WebSocket, frame, handshake

NORMAL, GOING_AWAY, PROTOCOL_ERROR, UNSUPPORTED, POLICY, TOO_BIG = 1000, 1001, 1002, 1003, 1008, 1009
INVALID, EXHAUSTED = plain.INVALID, plain.EXHAUSTED
SECURITY = {"X-Content-Type-Options": "nosniff", "Cross-Origin-Opener-Policy": "same-origin",
            "Cross-Origin-Resource-Policy": "same-origin", "Referrer-Policy": "no-referrer"}
MEMORY_BYTES = math.inf if os.environ.get("SANITIZED") else 8 << 20  # a sanitizer keeps freed memory
PAGES = ("/", "/page.js", "/worker.js", "/app.css")


def hello_frame(**fields):
    body = plain.session_pb2.ClientMessage(hello=plain.session_pb2.Hello(protocol_version=1,
                                                                         **fields)).SerializeToString()
    return protocol_frame(body)


def protocol_frame(body):
    return b"EV\x01\x01" + struct.pack("<I", len(body)) + body


class Case(metrics.Case):
    def port(self, server):
        self.http(server)
        return server.http_port

    def open(self, server, **options):
        socket_ = WebSocket.connected(self.port(server), **options)
        self.addCleanup(socket_.close)
        return socket_

    def over(self, socket_, hello=True):
        client = plain.Client(None, hello=False, over=socket_)
        if hello:
            client.hello()
            client.welcome = client.control().welcome
        return client

    def session(self, server, **options):
        """A client that speaks over a WebSocket."""
        return self.over(self.open(server, **options))

    def answer(self, server, data):
        """The status and the text of the answer to bytes, which ask the server to close the connection."""
        text = metrics.read_all(self.raw(server, data)).decode()
        return int(re.match(r"HTTP/1\.1 (\d+) ", text)[1]), text

    def refused(self, server, data, code, words=None):
        """Sends bytes after the handshake; the server says goodbye and closes with the code."""
        client = self.over(self.open(server), hello=False)
        client.socket.send_raw(data)
        if words:
            self.assertIn(words, client.goodbye().message)
        self.assertEqual(client.socket.at_end(), code)


class Sessions(Case):
    def setUp(self):
        super().setUp()
        self.served = self.serve()

    def test_the_handshake_is_answered(self):
        key = "dGhlIHNhbXBsZSBub25jZQ=="  # of RFC 6455
        answer = self.open(self.served, key=key).answer
        self.assertIn("\r\nSec-WebSocket-Accept: s3pPLMBiTxaQ9kYGzzhZRbK+xOo=", answer)
        self.assertEqual(ws.accept_of(key), "s3pPLMBiTxaQ9kYGzzhZRbK+xOo=")
        self.assertNotIn("Sec-WebSocket-Extensions", answer)

    def test_requests_commands_and_events_work(self):
        client = self.session(self.served)
        self.assertEqual(client.welcome.role, access.ADMIN)
        description = client.call(describe=c.Describe()).description
        page = self.get_bytes(self.served, "/protocol.bin")
        self.assertEqual(page, description.file_descriptor_set)
        client.call(subscribe_events=c.SubscribeEvents())
        client.call(create_world=c.CreateWorld(name="lesson"))
        self.assertEqual(client.next_event("world_created").world_created.world.name, "lesson")
        self.assertEqual(client.run_to(5, "lesson").tick, 5)

    def get_bytes(self, server, path):
        with contextlib.closing(self.http(server)) as connection:
            connection.request("GET", path)
            return connection.getresponse().read()

    def test_snapshots_equal_those_over_tcp(self):
        control = self.client(self.served)
        crowd = plain.set_parameters(population_size=3000, scale_with_population=True).parameters
        control.call(create_world=c.CreateWorld(name="w", seed=1, parameters=crowd))
        watchers = [self.client(self.served), self.session(self.served)]
        for watcher in watchers:
            watcher.call(subscribe_snapshots=c.SubscribeSnapshots(world="w", rate_hz=120))
        for tick in range(1, 30):
            control.run_to(tick, "w")
            seen = [watcher.next_snapshot(lambda snapshot: snapshot.tick == tick) for watcher in watchers]
            for snapshot in seen:
                snapshot.ClearField("sequence"), snapshot.ClearField("dropped_count")
                snapshot.ClearField("subscription_id")
            self.assertEqual(seen[0].plain.SerializeToString(), seen[1].plain.SerializeToString())
            self.assertEqual(seen[0].state_hash, seen[1].state_hash)

    def test_a_ping_is_answered_with_its_payload(self):
        client = self.session(self.served)
        for payload in (b"", b"x", bytes(125)):
            client.socket.send_raw(frame(payload, ws.PING))
            client.call(list_worlds=c.ListWorlds())
            plain.until(lambda: (ws.PONG, payload) in client.socket.controls
                        or client.call(list_worlds=c.ListWorlds()) is None,
                        "a pong")

    def test_a_close_frame_is_answered(self):
        for payload in (b"", struct.pack(">H", NORMAL), struct.pack(">H", 4321) + b"reason"):
            client = self.session(self.served)
            client.socket.send_raw(frame(payload, ws.CLOSE))
            self.assertEqual(client.socket.at_end(), NORMAL)

    def test_answers_come_before_the_close_frame(self):
        client = self.session(self.served)
        ids = [client.ask(list_worlds=c.ListWorlds()) for _ in range(20)]
        client.socket.send_raw(frame(struct.pack(">H", NORMAL), ws.CLOSE))
        for number in ids:
            self.assertEqual(client.response(number).status.code, plain.OK)
        self.assertEqual(client.socket.at_end(), NORMAL)

    def test_text_messages_are_refused(self):
        self.refused(self.served, frame(b"hello", ws.TEXT), UNSUPPORTED, "allowed are binary messages")
        client = self.session(self.served)
        number = client.ask(list_worlds=c.ListWorlds())
        client.socket.send_raw(frame(b"hello", ws.TEXT))
        self.assertEqual(client.response(number).status.code, plain.OK)
        self.assertEqual(client.goodbye().code, INVALID)
        self.assertEqual(client.socket.at_end(), UNSUPPORTED)

    def test_invalid_frames_are_refused(self):
        for data in (frame(b"x", mask=b""), frame(b"x", reserved=4), frame(b"x", opcode=3), frame(b"x", opcode=11),
                     frame(b"x", ws.CONTINUATION), frame(b"E", final=False) + frame(b"V"),
                     frame(b"x", ws.PING, final=False),
                     frame(bytes(126), ws.PING), b"\x82\xfe\x00\x05" + bytes(9), b"\x82\xff" + b"\xff" * 8 + bytes(4),
                     frame(b"x", ws.CLOSE), frame(struct.pack(">H", 1005), ws.CLOSE),
                     frame(struct.pack(">H", 99), ws.CLOSE)):
            self.refused(self.served, data, PROTOCOL_ERROR, "WebSocket")

    def test_a_ping_does_not_cut_the_goodbye(self):
        for _ in range(20):
            self.refused(self.served, frame(b"EV\x09\x09") + frame(b"x" * 100, ws.PING) * 200, POLICY, "version")

    def test_refusals_have_their_close_code(self):
        self.refused(self.served, frame(hello_frame(client_name="n" * 65)), POLICY, "client_name")
        self.refused(self.served, frame(b"EV\x01\x01\xff\xff\xff\x7f"), TOO_BIG, "bytes")

    def test_reset_connections_become_no_sessions(self):
        server = self.server("--keep-nothing", "--http-port", "0", "--log-level", "debug")
        port = self.port(server)
        server.process.send_signal(signal.SIGSTOP)
        for number in range(20):
            to, data = (port, handshake(port) + frame(hello_frame())) if number % 2 else (server.port, hello_frame())
            connection = socket.create_connection(("127.0.0.1", to))
            connection.sendall(data)
            connection.setsockopt(socket.SOL_SOCKET, socket.SO_LINGER, struct.pack("ii", 1, 0))
            connection.close()
        server.process.send_signal(signal.SIGCONT)
        self.session(server).call(list_worlds=c.ListWorlds())
        self.client(server).call(list_worlds=c.ListWorlds())
        self.assertEqual(server.output().count("connected as admin"), 2, "without an address")

    def test_a_frame_in_time_is_not_late(self):
        client = self.session(self.served)
        data = protocol_frame(plain.session_pb2.ClientMessage(request=c.Request(
            request_id=1, client_key="k", list_worlds=c.ListWorlds())).SerializeToString())
        client.socket.sendall(data[:5])
        self.client(self.served).call(list_worlds=c.ListWorlds())
        late = time.monotonic() + plain.limit("frame_timeout_s") + 0.5
        self.served.process.send_signal(signal.SIGSTOP)  # the time limit passes while the server does not run
        client.socket.sendall(data[5:])
        plain.until(lambda: time.monotonic() > late, "the time limit")
        self.served.process.send_signal(signal.SIGCONT)
        self.assertEqual(client.response(1).status.code, plain.OK)

    def test_a_shutdown_is_announced(self):
        client = self.session(self.served)
        waits = self.over(self.open(self.served), hello=False)
        self.served.end()
        self.assertEqual(client.socket.at_end(), GOING_AWAY)
        self.assertEqual(waits.socket.at_end(), GOING_AWAY)

    def test_sessions_are_counted_as_sessions(self):
        before = self.metrics(self.served)
        # of two addresses, because each may have half of the sessions
        sockets = [self.session(self.served, come_from=f"127.0.0.{1 + i % 2}")
                   for i in range(plain.limit("http_connections_max") + 5)]
        after = self.metrics(self.served)  # there is still room for HTTP
        self.assertEqual(after("evod_sessions", role="admin"), len(sockets))
        self.assertEqual(after("evod_websockets_total") - before("evod_websockets_total"), len(sockets))
        self.assertEqual(after("evod_limit_reached_total", limit="http_connections_max"), 0)

    def test_a_slow_reader_gets_fewer_snapshots(self):
        control = self.client(self.served)
        crowd = plain.set_parameters(population_size=5000, scale_with_population=True).parameters
        control.call(create_world=c.CreateWorld(name="w", seed=1, parameters=crowd))
        slow = self.session(self.served)
        slow.call(subscribe_snapshots=c.SubscribeSnapshots(world="w", rate_hz=120))
        control.call(set_speed=c.SetSpeed(world="w", speed=plain.w.Speed(max=True)))
        control.ask(run=c.Run(world="w"))

        def read_slowly(_):
            dropped = self.wait(self.served, lambda m: m("evod_snapshots_dropped_total") > 20, "drops")
            self.assertLess(dropped("evod_client_buffer_bytes"), 16 << 20)
            return slow.next_snapshot(lambda snapshot: snapshot.dropped_count > 0)
        waiting.quicker_than(plain.limit("stalled_timeout_s"), read_slowly)
        control.call(pause=c.Pause(world="w"))
        tick = control.world("w").tick
        self.assertEqual(slow.next_snapshot(lambda snapshot: snapshot.tick == tick).world, "w")


class Floods(Case):
    def setUp(self):
        super().setUp()
        self.served = self.serve()
        self.control = self.client(self.served)

    def memory_bytes(self):
        status = pathlib.Path(f"/proc/{self.served.process.pid}/status").read_text()
        return int(re.search(r"VmRSS:\s+(\d+) kB", status)[1]) << 10

    def flood(self, client, data):
        """Sends until the server closes the connection."""
        def send():
            with contextlib.suppress(OSError):
                while True:
                    client.socket.send_raw(data)
        thread = threading.Thread(target=send)
        thread.start()
        try:
            self.assertEqual(client.goodbye().code, EXHAUSTED)
            while client.socket.close_code is None:
                with contextlib.suppress(EOFError):
                    client.step()
        finally:
            self.control.call(list_worlds=c.ListWorlds())
            client.socket.connection.shutdown(socket.SHUT_RDWR)
            thread.join()
        self.assertEqual(client.socket.close_code, POLICY)

    def test_frames_without_content_are_limited(self):
        for data in (frame(b"x" * 8, ws.PING) * 100, frame(b"", ws.PONG) * 100, frame() * 100,
                     frame(b"", final=False) + frame(b"", ws.CONTINUATION, final=False) * 99 + frame(b"",
                                                                                                     ws.CONTINUATION)):
            self.flood(self.session(self.served), data)

    def test_some_pings_are_allowed(self):
        client = self.session(self.served)
        for _ in range(5):
            client.socket.send_raw(frame(b"x", ws.PING) * 100)
            client.call(list_worlds=c.ListWorlds())

    def test_an_announced_length_takes_no_memory(self):
        before = self.memory_bytes()
        for _ in range(50):
            client = self.over(self.open(self.served), hello=False)
            client.socket.send_raw(frame(hello_frame(), length=1 << 30))
            self.assertEqual(client.control().welcome.protocol_version, 1)
        self.assertLess(self.memory_bytes() - before, 4 * MEMORY_BYTES)

    def test_fragments_without_end_take_no_memory(self):
        client = self.session(self.served)
        client.socket.send_raw(frame(b"", final=False))
        request = plain.session_pb2.ClientMessage(request=c.Request(list_worlds=c.ListWorlds(), client_key="k"))
        # 60,000 bytes in field 1000, which the server does not know.
        request.request.MergeFromString(b"\xc2\x3e" + b"\xe0\xd4\x03" + bytes(60_000))
        before = self.memory_bytes()
        for number in range(1, 200):
            request.request.request_id = number
            for piece in (lambda data: (data[:5], data[5:]))(protocol_frame(request.SerializeToString())):
                client.socket.send_raw(frame(piece, ws.CONTINUATION, final=False))
            self.assertEqual(client.response(number).status.code, plain.OK)
        self.assertLess(self.memory_bytes() - before, MEMORY_BYTES)

    def test_an_incomplete_frame_is_closed_in_time(self):
        def stop(_):
            client = self.session(self.served)
            client.socket.send_raw(frame(b"EV\x01"))
            self.assertIn("did not arrive completely", client.goodbye().message)
            self.assertEqual(client.socket.at_end(), POLICY)
        stop(None)

    def test_silent_clients_get_a_ping_and_are_closed(self):
        answers, silent = self.session(self.served), self.session(self.served)
        begin = time.monotonic()
        answers.socket.settimeout(1)
        while not answers.socket.controls:
            with contextlib.suppress(TimeoutError):
                self.assertEqual(answers.socket.recv(1), b"content")
        self.assertEqual(answers.socket.controls[0], (ws.PING, b""))
        self.assertGreater(time.monotonic() - begin, 9)
        answers.socket.settimeout(waiting.LONGEST_S)
        answers.socket.send_raw(frame(b"", ws.PONG))
        with self.assertRaises(EOFError):  # it never answers
            while True:
                silent.step()
        self.assertGreater(time.monotonic() - begin, 28)
        self.assertIn("has not answered a ping", self.served.output())
        answers.call(list_worlds=c.ListWorlds())


class Origins(Case):
    def test_only_pages_of_this_server_open_sessions(self):
        server = self.serve()
        port = self.port(server)
        for origin in (None, "null", "http://evil.example", f"https://127.0.0.1:{port}.evil.example",
                       "http://127.0.0.1",
                       f"http://localhost:{port}", f"http://127.0.0.1:{port}/", f"file://127.0.0.1:{port}"):
            status, text = self.answer(server, handshake(port, Origin=origin, Connection="close, Upgrade"))
            self.assertEqual(status, 403, origin)
            self.assertIn("the Origin field must be", text)
        self.assertEqual(self.metrics(server)("evod_http_refused_total", because="origin"), 8)
        self.assertEqual(self.open(server, Host=f"LOCALHOST:{port}", Origin=f"http://localhost:{port}").close(), None)

    def test_only_names_of_this_server_are_served(self):
        server = self.serve()
        port = self.port(server)
        for path in ("/", "/metrics", "/healthz", "/protocol.bin", "/session", "/nowhere"):
            for host in ("evil.example", f"evil.example:{port}", "10.9.8.7", "localhost.evil.example", "[::2]",
                         "localhost:x",
                         "127.0.0.1@evil.example", ""):
                status, text = self.answer(server,
                                           f"GET {path} HTTP/1.1\r\nHost: {host}\r\nConnection: close\r\n\r\n".encode())
                self.assertEqual(status, 403, host)
                self.assertIn("--http-host NAME", text)
        for field in ("", "Host: localhost\r\nHost: localhost\r\n"):
            request = f"GET / HTTP/1.1\r\n{field}Connection: close\r\n\r\n"
            self.assertEqual(self.answer(server, request.encode())[0], 400)
        for host in ("localhost", "localhost:1", "127.0.0.1", f"[::1]:{port}", "LocalHost.", socket.gethostname()):
            status, _ = self.answer(server,
                                    f"GET /metrics HTTP/1.1\r\nHost: {host}\r\nConnection: close\r\n\r\n".encode())
            self.assertEqual(status, 200, host)

    def test_an_incomplete_handshake_is_refused(self):
        server = self.serve()
        port = self.port(server)
        for status, fields in ((426, dict(Upgrade=None)), (426, dict(Connection="close")), (426, dict(Upgrade="h2c")),
                               (426, dict(Sec_WebSocket_Version="12")), (426, dict(Sec_WebSocket_Version=None)),
                               (400, dict(Sec_WebSocket_Key=None)), (400, dict(Sec_WebSocket_Key="short")),
                               (400, dict(Sec_WebSocket_Key="*" * 22 + "=="))):
            fields = {"Connection": "close, Upgrade", **fields}
            data = handshake(port, **fields)
            if fields["Connection"] != "close":
                data += b"GET /nowhere HTTP/1.0\r\nHost: localhost\r\n\r\n"
            self.assertEqual(self.answer(server, data)[0], status, fields)
        self.assertEqual(self.answer(server, handshake(port).replace(b"GET", b"POST"))[0], 405)
        self.open(server, Connection="keep-alive, Upgrade", Upgrade="WebSocket")

    def test_a_host_option_adds_a_name_and_needs_tokens(self):
        done = waiting.run([EVOD, "--data", self.folder, "--port", "0", "--http-port", "0", "--http-host",
                            "lab.example"],
                           capture_output=True, text=True)
        self.assertEqual(done.returncode, 1)
        self.assertIn("evod token add", done.stderr)


class WithTokens(Case, access.Access):
    def test_a_token_in_the_hello_admits(self):
        secret = self.token("anna", access.VIEWER)
        server = self.serve("--require-token")
        client = self.over(self.open(server), hello=False)
        client.hello(token=secret)
        self.assertEqual(client.control().welcome.user, "anna")
        other = self.over(self.open(server), hello=False)
        other.hello()
        self.assertEqual(other.goodbye().code, access.UNAUTHENTICATED)
        self.assertEqual(other.socket.at_end(), POLICY)

    def status(self, server, authorization=None, path="/metrics", host="127.0.0.1"):
        field = f"Authorization: {authorization}\r\n" if authorization else ""
        return self.answer(server, f"GET {path} HTTP/1.1\r\nHost: {host}\r\n{field}Connection: close\r\n\r\n".encode())

    def test_metrics_need_a_bearer_token(self):
        secret = self.token("anna", access.VIEWER)
        server = self.serve("--http-host", "lab.example")
        self.assertEqual(self.come(server).refusal.code, access.UNAUTHENTICATED)
        status, text = self.status(server)
        self.assertEqual(status, 401)
        self.assertIn('\r\nWWW-Authenticate: Bearer realm="evod"\r\n', text)
        for right in (f"Bearer {secret}", f"bearer  {secret} "):
            self.assertEqual(self.status(server, right, host="lab.example:80")[0], 200)
        self.assertEqual(self.status(server, f"Basic {secret}")[0], 401)
        self.assertEqual(self.status(server, "Bearer evod_" + "0" * 64)[0], 401)
        self.assertEqual(self.status(server, "Bearer evod_" + "1" * 64)[0], 429)
        self.assertEqual(self.status(server, f"Bearer {secret}")[0], 200, "a good token need not wait")
        plain.until(lambda: self.status(server, path="/healthz")[0] == 200, "health needs no token")
        self.assertNotIn(secret[5:], server.output())

    def test_tls_serves_https_and_wss(self):
        key, certificate = f"{self.folder}/key.pem", f"{self.folder}/certificate.pem"
        subprocess.run(["openssl", "req", "-x509", "-newkey", "ec", "-pkeyopt", "ec_paramgen_curve:P-256", "-nodes",
                        "-keyout",
                        key, "-out", certificate, "-days", "2", "-subj", "/CN=localhost", "-addext",
                        "subjectAltName=DNS:localhost,IP:127.0.0.1"], check=True, capture_output=True)
        server = self.server("--keep-nothing", "--http-port", "0", "--tls-cert", certificate, "--tls-key", key)
        port = int(re.search(r"https://[^:/]+:(\d+)/", server.output())[1])
        tls = ssl.create_default_context(cafile=certificate)
        with contextlib.closing(http.client.HTTPSConnection("localhost", port, context=tls)) as connection:
            connection.request("GET", "/metrics")
            answer = connection.getresponse()
            self.assertEqual(answer.status, 200)
            self.assertIn(f"connect-src 'self' wss://localhost:{port};", answer.headers["Content-Security-Policy"])
        with socket.create_connection(("127.0.0.1", port)) as connection:
            connection.sendall(b"GET / HTTP/1.1\r\nHost: localhost\r\n\r\n")
            self.assertRegex(metrics.read_all(connection), rb"(?s)^HTTP/1\.1 400 .*use https://")
        client = self.over(WebSocket.connected(port, tls=tls, Origin=f"https://127.0.0.1:{port}"))
        client.call(subscribe_snapshots=c.SubscribeSnapshots(rate_hz=100))
        client.socket.send_raw(frame(b"over TLS", ws.PING))
        client.run_to(20)
        client.next_snapshot(lambda snapshot: snapshot.tick == 20)
        self.assertIn((ws.PONG, b"over TLS"), client.socket.controls)
        with contextlib.closing(socket.create_connection(("127.0.0.1", port))) as connection:
            over = tls.wrap_socket(connection, server_hostname="localhost")
            over.sendall(handshake(port, Connection="close, Upgrade"))  # with the Origin http://
            self.assertRegex(metrics.read_all(over), rb"^HTTP/1\.1 403 ")
        server.end()
        self.assertEqual(client.socket.at_end(), GOING_AWAY)


class Pages(Case):
    def test_every_answer_has_the_security_fields(self):
        server = self.serve()
        host = f"127.0.0.1:{self.port(server)}"
        for path in (*PAGES, "/metrics", "/healthz", "/protocol.bin", "/nowhere", "/session"):
            answer = self.head(server, path)
            for name, value in SECURITY.items():
                self.assertEqual(answer.headers[name], value, path)
            policy = answer.headers["Content-Security-Policy"].split("; ")
            self.assertIn("default-src 'none'", policy)
            self.assertIn(f"connect-src 'self' ws://{host} wss://{host}", policy)
            self.assertIn("require-trusted-types-for 'script'", policy)

    def test_only_named_origins_may_embed_the_page(self):
        for options, ancestors in (((), "'none'"),
                                   (("--embed-in", "http://localhost:8888"), "http://localhost:8888"),
                                   (("--embed-in", "http://localhost:*", "--embed-in", "https://hub.example"),
                                    "http://localhost:* https://hub.example")):
            server = self.serve(*options)
            self.port(server)
            for path in ("/", "/healthz"):
                policy = self.head(server, path).headers["Content-Security-Policy"].split("; ")
                self.assertIn(f"frame-ancestors {ancestors}", policy)
            server.end()
        done = waiting.run([EVOD, "--web", "--embed-in", "localhost:8888"], capture_output=True, text=True)
        self.assertEqual(done.returncode, 2)
        self.assertIn("--embed-in: got localhost:8888, allowed the origin of a page, such as http://localhost:8888",
                      done.stderr)

    def head(self, server, path, **fields):
        return self.get(server, path, "HEAD", headers=fields)

    def test_the_page_is_compressed_and_revalidated(self):
        server = self.serve()
        for path in (*PAGES, "/protocol.bin") if self.head(server, "/",
                                                           **{"Accept-Encoding": "gzip"}).status == 200 else (
                "/protocol.bin",):  # evod was built without the page
            with contextlib.closing(self.http(server)) as connection:
                connection.request("GET", path, headers={"Accept-Encoding": "br, gzip;q=0.5"})
                answer = connection.getresponse()
                self.assertEqual((answer.status, answer.headers["Content-Encoding"], answer.headers["Cache-Control"]),
                                 (200, "gzip", "no-cache"))
                self.assertTrue(gzip.decompress(answer.read()))
                etag = answer.headers["ETag"]
                for tags, status in ((etag, 304), (f'"other", W/{etag}', 304), ("*", 304), ('"other"', 200)):
                    connection.request("GET", path, headers={"If-None-Match": tags, "Accept-Encoding": "gzip"})
                    again = connection.getresponse()
                    self.assertEqual((again.status, bool(again.read())), (status, status == 200))
                connection.request("GET", path, headers={"Accept-Encoding": "gzip"})
                content = gzip.decompress(connection.getresponse().read())
            for others in ("br", "identity", "gzip;q=0", "*;q=0", "", None):  # None: no field, as curl
                with contextlib.closing(http.client.HTTPConnection("127.0.0.1", server.http_port)) as connection:
                    connection.putrequest("GET", path, skip_accept_encoding=True)
                    if others is not None:
                        connection.putheader("Accept-Encoding", others)
                    connection.endheaders()
                    answer = connection.getresponse()
                    self.assertEqual((answer.status, answer.headers["Content-Encoding"]), (200, None), others)
                    self.assertNotEqual(answer.headers["ETag"], etag)
                    self.assertEqual(answer.read(), content)

    def answers_another_address(self, server):
        """Asserts that the server answers ten requests from an address without other connections."""
        for _ in range(10):
            other = http.client.HTTPConnection("127.0.0.1", server.http_port, source_address=("127.0.0.2", 0))
            with contextlib.closing(other) as connection:
                connection.request("GET", "/metrics")
                answer = connection.getresponse()
                self.assertEqual((answer.status, bool(answer.read())), (200, True))

    def test_silent_connections_lock_no_client_out(self):
        server = self.serve()
        limit = plain.limit("http_connections_max")

        def crowd(_):
            silent = [self.raw(server, b"" if number % 2 else b"GET /healthz HT") for number in range(2 * limit)]
            self.answers_another_address(server)
            # The connections of the other address made room, the oldest first.
            self.assertEqual(metrics.read_all(silent[0]), b"")
        waiting.quicker_than(plain.limit("http_request_timeout_s"), crowd)

    def test_answered_connections_lock_no_client_out(self):
        server = self.serve()
        self.wait_well(server)
        threads = {pathlib.Path(task, "comm").read_text().strip(): int(task.name)
                   for task in pathlib.Path(f"/proc/{server.process.pid}/task").iterdir()}

        def crowd(_):
            # so that answers take SIMULATION_S
            with metrics.stopped(threads["simulation"]), contextlib.ExitStack() as stack:
                for _ in range(2 * plain.limit("http_connections_max")):
                    socket = self.raw(server, b"GET /healthz HTTP/1.1\r\nHost: localhost\r\n\r\n")
                    stack.enter_context(contextlib.closing(socket))
                self.answers_another_address(server)
        waiting.quicker_than(metrics.SIMULATION_S, crowd)

    def test_unread_answers_are_discarded(self):
        server = self.serve()
        port = self.port(server)
        for _ in range(10):
            connection = socket.socket()
            self.addCleanup(connection.close)
            connection.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, 2048)
            connection.connect(("127.0.0.1", port))
            connection.sendall(b"GET /protocol.bin HTTP/1.1\r\nHost: localhost\r\n\r\n" * 60)

        def states():
            """Of the server's ends of the connections, whether or not a process still has them."""
            rows = [line.split() for line in pathlib.Path("/proc/net/tcp").read_text().splitlines()[1:]]
            return {row[3] for row in rows if row[1].endswith(f":{port:04X}")}
        established, fin_wait_1 = "01", "04"
        plain.until(lambda: established in states(), "connections")
        plain.until(lambda: not states() & {established, fin_wait_1}, "no connection")

    def test_two_hundred_connections_at_once_are_served(self):
        server = self.serve()
        port, ok = self.port(server), []

        def load():
            for _ in range(100):
                with contextlib.suppress(OSError, http.client.HTTPException):
                    with contextlib.closing(http.client.HTTPConnection("127.0.0.1", port, timeout=60)) as connection:
                        connection.request("GET", "/protocol.bin")
                        if len(connection.getresponse().read()) > 1000:
                            return ok.append(True)
        threads = [threading.Thread(target=load) for _ in range(200)]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join()
        self.assertEqual(len(ok), 200)


if __name__ == "__main__":
    unittest.main(argv=[sys.argv[0], *sys.argv[4:]], verbosity=2, warnings="ignore")
