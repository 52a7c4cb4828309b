"""Connecting: addresses, missing servers, servers that are not evod, and the life of private servers."""
import asyncio
import socket
import subprocess
import threading
import unittest
import weakref

import numpy

import evod
from evod.endpoint import Endpoint
from support import until


class Connect(unittest.TestCase):
    def test_addresses_are_parsed(self):
        for text, host, port in (("lab", "lab", 7744), ("lab:1", "lab", 1), ("::1", "::1", 7744),
                                 ("[::1]:65535", "::1", 65535)):
            self.assertEqual(Endpoint.parse(text), Endpoint(host, port))
        for text in ("", ":1", "lab:", "lab:0", "lab:65536", "lab:x", "lab:1²", "[::1", "[::1]x", "[::1]:"):
            with self.assertRaisesRegex(evod.Error, "server: got .*, allowed HOST, HOST:PORT"):
                Endpoint.parse(text)

    def test_missing_servers_and_programs_are_reported(self):
        with self.assertRaisesRegex(evod.NoConnection, "no server at 127.0.0.1:1: start one with `evod`"):
            evod.connect("127.0.0.1:1")
        with self.assertRaisesRegex(evod.Error, "the program no-such-evod was not found"):
            evod.local(program="no-such-evod")
        with self.assertRaisesRegex(evod.Error, "invalid experiment\n  population_size: got 0, allowed a whole number"):
            evod.local(experiment={"population_size": 0})

    def test_another_protocol_is_refused_at_once(self):
        with socket.create_server(("127.0.0.1", 0)) as other:
            def greet():
                with other.accept()[0] as connection:
                    connection.sendall(b"220 mail.example ESMTP\r\n")
                    connection.recv(100)
            threading.Thread(target=greet).start()
            with self.assertRaisesRegex(evod.DamagedData, "is not an evod server: a frame begins with 32 32, not with "
                                                          "45 56"):
                evod.connect("127.0.0.1:%d" % other.getsockname()[1])

    def test_a_local_server_ends_with_a_killed_program(self):
        script = ("import evod, os, signal; lab = evod.local(); print(lab.address, flush=True); "
                  "os.kill(os.getpid(), signal.SIGKILL)")
        done = subprocess.run(["/usr/bin/python3", "-c", script], capture_output=True, text=True)
        until(lambda: self.has_ended(done.stdout.strip()), "the server has ended")

    def test_a_garbage_collected_local_server_ends(self):
        lab = evod.local(experiment={"population_size": numpy.int64(7)})
        address, run = lab.address, lab.world().run(1)
        del lab
        self.assertEqual(next(run).organism_count, 7)
        self.assertFalse(self.has_ended(address))
        del run
        until(lambda: self.has_ended(address), "the server has ended")

    def test_it_works_inside_a_running_event_loop(self):
        async def cell():  # as a notebook runs it
            with evod.local(seed=1) as lab:
                return len(lab.world().population())

        self.assertEqual(asyncio.run(cell()), 50)

    def test_a_program_ends_with_open_connections(self):
        # In development mode asyncio warns of steps that a busy machine made slow.
        program = ("import logging; logging.getLogger('asyncio').setLevel(logging.ERROR); "
                   "import evod; lab = evod.local(); other = evod.connect(lab.address); events = other.events(); "
                   "snapshots = lab.world().snapshots(); print(len(next(snapshots).organisms))")
        # Python 3.13 warns of a deprecation in protobuf 3.21.
        command = ["/usr/bin/python3", "-X", "dev", "-W", "ignore::DeprecationWarning", "-c", program]
        done = subprocess.run(command, capture_output=True, text=True, timeout=120)
        self.assertEqual((done.returncode, done.stdout, done.stderr), (0, "50\n", ""))

    def test_the_garbage_collector_closes_a_connection(self):
        with evod.local() as server:
            lab = evod.connect(server.address)
            link = weakref.ref(lab._link)
            threads = {thread for thread in threading.enumerate() if thread.name == "evod connection"}
            del lab
            self.assertIsNone(link())
            self.assertEqual(sum(thread.is_alive() for thread in threads), 1)  # the server's own lab

    def has_ended(self, address):
        try:
            evod.connect(address).close()
        except evod.NoConnection:
            return True
        return False


if __name__ == "__main__":
    unittest.main()
