"""Links to the page: Python and evoctl print the same. EVOCTL names the other program."""
import contextlib
import io
import os
import re
import subprocess
import tempfile
import unittest
import urllib.request
import warnings
from unittest import mock

import evod
from evod import notebook, page_link
from evod.endpoint import Endpoint
from evod.v1 import session_pb2, world_pb2
from support import Server


class Form(unittest.TestCase):
    """The same cases as in tests/unit/core/page_link_test.cpp."""

    def test_the_page_has_the_host_of_server_or_client(self):
        for fields, server, tls, page in (({}, Endpoint("lab"), False, "http://lab:7745/"),
                                          ({}, Endpoint("::1"), True, "https://[::1]:7745/"),
                                          ({"page_host": "192.0.2.1"}, Endpoint("lab"), False,
                                           "http://192.0.2.1:7745/")):
            self.assertEqual(page_link.page_of(session_pb2.Welcome(page_port=7745, **fields), server, tls), page)

    def test_another_host_causes_a_warning(self):
        with self.assertWarnsRegex(UserWarning, "at another host: 192.0.2.1"):
            page_link.warn_of_other_host(session_pb2.Welcome(page_port=7745, page_host="192.0.2.1"), Endpoint("lab"))
        with warnings.catch_warnings(record=True) as seen:
            for host, server in ("", "lab"), ("lab", "lab"), ("127.0.0.1", "localhost"):
                page_link.warn_of_other_host(session_pb2.Welcome(page_port=7745, page_host=host), Endpoint(server))
        self.assertEqual(seen, [])

    def test_names_of_the_server_cannot_leave_the_url(self):
        for host in "\x1b]8;;x\x07", "a/b", "a@b", "\u202elab":
            with self.assertRaises(evod.DamagedData):
                page_link.page_of(session_pb2.Welcome(page_port=7745, page_host=host), Endpoint("lab"), False)
        with self.assertRaises(evod.DamagedData):
            page_link.link_of("http://x/", world_pb2.WorldInfo(name="\x1b[2J", generation=3), None, None, None, None,
                              live=False)

    def test_a_replay_is_a_moment_of_its_original(self):
        info = world_pb2.WorldInfo(name="a.replay", generation=3, generation_tick=40)
        info.replay.replay_of = "a"
        self.assertEqual(page_link.link_of("http://x/", info, None, None, None, None, live=False),
                         "http://x/#world=a&generation=3&tick=40")

    def test_mistakes_are_named(self):
        info = world_pb2.WorldInfo(name="a", generation=3)
        for arguments, words in (((9, None), "generation: got 9, allowed 1 to 3"),
                                 ((None, 9), "tick is given without generation")):
            with self.assertRaisesRegex(evod.InvalidArgument, words):
                page_link.link_of("http://x/", info, *arguments, None, None, live=False)
        for page in "lab", "http://a/#b", 'http://a/"', "ftp://a/":
            with self.assertRaisesRegex(evod.InvalidArgument, "page: got '.*', allowed a URL without #"):
                page_link.link_of(page, info, None, None, None, None, live=False)


class Links(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.TemporaryDirectory()
        cls.addClassCleanup(cls.folder.cleanup)
        cls.server = Server("--data", cls.folder.name, "--web", "--http-port", "0", "--seed", "1")
        cls.addClassCleanup(cls.server.end)
        cls.page = re.search(r"page at (http://127\.0\.0\.1:\d+/)\n", cls.server.output())
        cls.lab = cls.enterClassContext(evod.connect(f"localhost:{cls.server.port}"))

    def evoctl(self, *words):
        command = [os.environ["EVOCTL"], "--server", f"localhost:{self.server.port}", "link", *words]
        return subprocess.run(command, capture_output=True, text=True, check=True).stdout.removesuffix("\n")

    def test_python_and_evoctl_print_the_same(self):
        self.assertIsNotNone(self.page, self.server.output())
        world = self.lab.world()
        world.set_speed("max")
        list(world.run(generations=2))
        world.run_until_tick(world.info().tick + 70)
        world.wait()
        page = self.page[1]
        for arguments, words, end in (
                ({}, [], "#world=default&generation=3&tick=70"),
                ({"generation": 2, "tick": 5}, ["--generation", "2", "--tick", "5"],
                 "#world=default&generation=2&tick=5"),
                ({"generation": 1, "organism": 7}, ["--generation", "1", "--organism", "7"],
                 "#world=default&generation=1&tick=0&island=0&organism=7"),
                ({"live": True, "island": 0}, ["--live", "--island", "0"], "#world=default&island=0")):
            with self.subTest(end):
                self.assertEqual(world.link(**arguments), page + end)
                self.assertEqual(self.evoctl(*words), page + end)
        self.assertEqual(world.link(live=True, page="https://x.example/evod"), "https://x.example/evod/#world=default")
        self.assertEqual(self.evoctl("--live", "--page", "https://x.example/evod"),
                         "https://x.example/evod/#world=default")

    def test_a_server_without_a_page_is_named(self):
        server = Server("--keep-nothing")
        self.addCleanup(server.end)
        with evod.connect(f"localhost:{server.port}") as lab, self.assertRaisesRegex(
                evod.FailedPrecondition, "has no page .*: start it with --web"):
            lab.world().link()


class Notebooks(unittest.TestCase):
    def policy(self, lab):
        """What the private server answers about its page."""
        request = urllib.request.Request(lab.world().link(live=True), headers={"Accept-Encoding": "gzip"})
        with urllib.request.urlopen(request) as answer:
            return answer.headers["Content-Security-Policy"]

    def test_only_notebooks_embed_the_page_of_their_server(self):
        with evod.local() as lab:
            self.assertIn("frame-ancestors 'none'", self.policy(lab))
        with mock.patch("evod.local_server.in_notebook", return_value=True), evod.local() as lab:
            self.assertIn("frame-ancestors http://localhost:* http://127.0.0.1:*;", self.policy(lab))

    def test_a_world_is_shown_in_a_frame(self):
        with evod.local(seed=1, speed=10) as lab:
            world = lab.world()
            with mock.patch("evod.lab.in_notebook", return_value=True):
                frame = world.show(width=800, height="30em")
            self.assertEqual(repr(frame), world.link(live=True))
            self.assertIn(f'<iframe src="{frame.link}" width="800" height="30em"', frame._repr_html_())
            world.run(generations=2).wait()
            with world.open_replay(1, 5) as replay, contextlib.redirect_stdout(io.StringIO()) as printed:
                html = replay.show()._repr_html_()
            self.assertRegex(printed.getvalue(), "#world=default&generation=1&tick=5\n$")
            self.assertIn("#world=default&amp;generation=1&amp;tick=5", html)

    def test_the_kernel_of_a_notebook_is_recognised(self):
        self.assertFalse(notebook.in_notebook())
        for shell, is_notebook in ((None, False), (mock.Mock(spec=[]), False), (mock.Mock(spec=["kernel"]), True)):
            with mock.patch.dict("sys.modules", IPython=mock.Mock(get_ipython=lambda shell=shell: shell)):
                self.assertEqual(notebook.in_notebook(), is_notebook)


if __name__ == "__main__":
    unittest.main()
