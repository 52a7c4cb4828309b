"""What the tests of the page in a real Chromium have in common: a browser for each class, and a server for each test.

EVOD and EVOCTL name the programs, MESSAGES the folder of the message classes. Each class of the tests is one subject,
and one test of ctest, with a browser of its own. Waits are for conditions, as waiting.py describes; nothing here
measures time or frames.

A test imports this module first: it adds the folder of the other tests of programs to the path.
"""
import json
import pathlib
import sys

HERE = pathlib.Path(__file__).resolve().parent
sys.path[:0] = [str(HERE), str(HERE.parent)]

import access_test as access  # noqa: E402
import metrics_test as metrics  # noqa: E402
from browser import Browser  # noqa: E402
from metrics_test import c, plain  # noqa: E402

w = plain.w
SHOWN_PANELS = "[...document.querySelectorAll('[role=tabpanel]')].filter((panel) => panel.checkVisibility())"
SMALL = {"population_size": 30, "island_width_px": 720.0, "island_height_px": 450.0, "generation_s": 2.0}


class Case(metrics.Case, access.Access):
    """Starts one browser for a class, and a server for each test."""

    arguments = ()  # of Chromium

    @classmethod
    def setUpClass(cls):
        cls.browser = Browser(*cls.arguments)

    @classmethod
    def tearDownClass(cls):
        cls.browser.close()

    def setUp(self):
        super().setUp()
        self.browser.driver.get("about:blank")  # the page of the test before has lost its server
        self.browser.log()
        self.browser.requested()

    def page(self, server, fragment=""):
        """The address of the page."""
        self.http(server)
        return f"http://127.0.0.1:{server.http_port}/{fragment}"

    def start(self, *options, seed=1, **parameters):
        """A server whose first world, `default`, has these parameters."""
        file = pathlib.Path(self.folder) / "default.json"
        file.write_text(json.dumps({**SMALL, **parameters}))
        return self.serve("--experiment", str(file), "--seed", str(seed), *options)

    def shown_tick(self, tick):
        """Waits until the drawn snapshot is that of a tick."""
        self.browser.wait("evod.app.world().snapshot?.tick === arguments[0]", f"tick {tick} on the canvas", tick)

    def value_of(self, client, name, world="default"):
        found = plain.as_dict(client.call(get_parameters=c.GetParameters(world=world)).parameters)[name].value
        return getattr(found, found.WhichOneof("kind"))
