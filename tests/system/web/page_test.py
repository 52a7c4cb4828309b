"""The page in a real Chromium against a real evod: what it shows is what the server says."""
import pathlib
import signal
import sys
import unittest

import numpy

from page_case import Case, SHOWN_PANELS, access, c, plain

REQUESTS_MAX, BYTES_MAX = 8, 131_000  # of the first load
HOSTILE = "<img src=x onerror=alert(1)>"
WITHOUT_WEBGL_2 = """
    for (const { prototype } of [HTMLCanvasElement, OffscreenCanvas]) {
      const { getContext } = prototype;
      prototype.getContext = function (kind, ...options) {
        return kind === "webgl2" ? null : getContext.call(this, kind, ...options);
      };
    }"""


class Page(Case):
    def test_the_first_load_is_small(self):
        server = self.start()
        browser = self.browser
        browser.cdp("Network.setCacheDisabled", cacheDisabled=True)
        browser.open(self.page(server))
        sizes = browser.value(
            """[...performance.getEntriesByType("navigation"), ...performance.getEntriesByType("resource")]
            .map((entry) => [entry.name, entry.transferSize])""")
        self.assertLessEqual(len(sizes) + 1, REQUESTS_MAX, sizes)  # and the session
        self.assertLessEqual(sum(size for _, size in sizes), BYTES_MAX, sizes)
        self.assertGreater(min(size for _, size in sizes), 0, sizes)
        asked = [url for url in browser.requested() if not url.startswith(("about:", "data:", "blob:"))]
        self.assertIn(self.page(server), asked)
        for url in asked:
            self.assertRegex(url, rf"^(http|ws)://127\.0\.0\.1:{server.http_port}/")

    def test_the_console_stays_empty(self):
        server = self.start()
        browser = self.browser
        browser.open(self.page(server))
        for title in browser.panels():
            browser.panel(title)
            browser.wait(f"{SHOWN_PANELS}.some((panel) => panel.innerText !== '')", title)
        browser.take_part()
        self.client(server).run_to(130)  # a generation ends
        self.shown_tick(130)
        wrong = [text for level, text in browser.log() if level == "SEVERE" or "Content Security" in text]
        self.assertEqual([text for text in wrong if f":{server.http_port}/" in text], [])

    def test_without_webgl_2_the_page_says_so(self):
        server, browser = self.start(), self.browser
        control = self.client(server)
        script = browser.cdp("Page.addScriptToEvaluateOnNewDocument", source=WITHOUT_WEBGL_2)
        self.addCleanup(browser.cdp, "Page.removeScriptToEvaluateOnNewDocument", **script)
        browser.open(self.page(server))
        browser.wait_for_text("This browser cannot draw the island, because it has no WebGL 2, or WebGL 2 is switched "
                              "off. The panels show the world as usual.", ".pane-note")
        for tick in (130, 260):  # a generation ends before each
            control.run_to(tick)
            self.shown_tick(tick)
        browser.wait_for_text("Generation 3", ".pane-head h1")
        for title in browser.panels():
            browser.panel(title)
            browser.wait(f"{SHOWN_PANELS}.some((panel) => panel.innerText !== '')", title)
        self.assertEqual([text for level, text in browser.log() if level == "SEVERE"], [])

    def test_world_generation_and_tick_are_shown(self):
        server = self.start()
        control = self.client(server)
        control.run_to(200)
        self.browser.open(self.page(server))
        self.shown_tick(200)
        self.assertEqual(self.browser.driver.title, "default – evod")
        self.browser.wait_for_text("Generation 2", ".pane-head h1")
        self.browser.wait_for_text("default", ".pane-place")
        self.browser.wait_for_text("tick 200", ".pane-foot")
        self.browser.wait_for_text("paused", ".pane-state")
        world = control.world()
        shown = self.browser.snapshot()
        self.assertEqual((shown["state_hash"], shown["run_id"], shown["generation"], shown["generation_tick"]),
                         (world.state_hash, world.run_id, world.generation, world.generation_tick))

    def test_a_damaged_world_shows_its_reason(self):
        pathlib.Path(self.folder, "broken.evod").write_bytes(b"x" * 5000)
        server = self.serve()
        self.browser.open(self.page(server), wait=False)
        self.browser.wait_for_text("the world does not run: ", ".worlds")  # it is the only one
        self.browser.wait_for_text("broken.evod is damaged or is not a run file: ", ".worlds")
        self.browser.panel("Worlds")
        self.browser.wait_for_text("damaged", ".panel-worlds td")

    def over_tcp(self, server, client, world="default"):
        """The entities as the server sends them to a TCP client, and the health as GetPopulation answers."""
        client.call(subscribe_snapshots=c.SubscribeSnapshots(world=world, rate_hz=30))
        snapshot = client.next_snapshot()
        life = client.call(get_population=c.GetPopulation(world=world, with_life=True)).population
        return snapshot, plain.columns(snapshot), numpy.frombuffer(life.health, "<f4")

    def test_columns_equal_those_over_tcp(self):
        server = self.start(crate_count=3)
        control = self.client(server)
        self.browser.open(self.page(server))
        for tick in (0, 90, 150):
            control.run_to(tick)
            self.shown_tick(tick)
            snapshot, columns, health = self.over_tcp(server, self.client(server))
            shown = self.browser.columns()
            self.assertEqual(shown["info"]["tick"], tick)
            self.assertEqual(snapshot.tick, tick)
            for kind, fields in columns.items():
                for field, column in fields.items():
                    expected = column if field == "id" else 16 * column
                    numpy.testing.assert_array_equal(shown[kind][field], expected, f"{kind} {field} at tick {tick}")
            of_population = health[shown["organisms"]["id"]]
            numpy.testing.assert_allclose(numpy.array(shown["organisms"]["health"]) / 16, of_population, atol=1 / 16)

    def test_every_organism_is_at_its_place(self):
        server = self.start(generation_s=60.0, population_size=30)
        control = self.client(server)
        control.run_to(300)
        browser = self.browser
        browser.open(self.page(server))
        self.shown_tick(300)
        _, columns, _ = self.over_tcp(server, self.client(server))
        organisms = columns["organisms"]
        count = len(organisms["id"])
        self.assertGreaterEqual(count, 25)
        browser.set_camera(360, 225, 1)
        _, _, width, height = browser.canvas()
        x, y = (numpy.round(organisms[axis] - middle + size / 2 - 0.5).astype(int)
                for axis, middle, size in (("x", 360, width), ("y", 225, height)))
        expected = self.body_colours(organisms["health"])
        covered = self.covered(organisms)

        def right():
            """How many centres have their colour."""
            pixels = browser.pixels()
            return sum(covered[i] or bool((abs(pixels[y[i], x[i]].astype(int) - expected[i]) <= 3).all())
                       for i in range(count))
        self.assertLess(sum(covered), 4)
        plain.until(lambda: right() >= 0.99 * count, "the colours of the organisms", pause_s=0.2)

    def test_trails_lead_to_their_organisms(self):
        server = self.start(generation_s=60.0, population_size=4)
        control, browser = self.client(server), self.browser
        control.run_to(300)
        browser.open(self.page(server))
        places = []
        for tick in (300, 320, 340, 360):
            control.run_to(tick)
            self.shown_tick(tick)
            organisms = browser.columns()["organisms"]
            places.append(numpy.array([organisms["x"], organisms["y"]]).T / 16)
        browser.set_camera(360, 225, 1)
        browser.run("evod.app.world().set_look({ trails: false })")
        without = plain.until(lambda: self.settled(None), "an image without trails", pause_s=0.2)[0]
        browser.run("evod.app.world().set_look({ trails: true })")
        drawn = plain.until(lambda: self.settled(without), "an image with trails", pause_s=0.2)[0]
        rows, columns = numpy.nonzero((drawn != without).any(axis=2))
        _, _, width, height = browser.canvas()
        changed = numpy.array([columns + 360 - width / 2, rows + 225 - height / 2]).T
        away = numpy.hypot(*(changed[:, None] - numpy.concatenate(places)[None]).transpose(2, 0, 1)).min(axis=1)
        self.assertLess(away.max(), 40)  # px: half of the way in 20 ticks, and the width of a line

    def settled(self, before):
        """What the canvas shows, in a list, once it is the same twice and differs from `before`."""
        one, other = self.browser.pixels(), self.browser.pixels()
        return [one] if (one == other).all() and (before is None or (one != before).any()) else []

    @staticmethod
    def body_colours(health):
        """Of the vivid skin on a dark background: from no to full health. client/viewer/drawing/palette.cpp."""
        low, high = numpy.array([92, 66, 190]), numpy.array([206, 192, 255])
        full = max(100, 100 * int(numpy.ceil(max(health) / 100)))
        return [numpy.round(low + (high - low) * min(each / full, 1)) for each in health]

    @staticmethod
    def covered(organisms):
        """Which centres are below the body or the arc of an organism that is drawn later."""
        x, y, reach = organisms["x"], organisms["y"], organisms["radius"] + 6
        return [bool((numpy.hypot(x[i + 1:] - x[i], y[i + 1:] - y[i]) < reach[i + 1:]).any()) for i in range(len(x))]

    def test_names_of_others_are_only_text(self):
        server = self.start()
        hostile = plain.Client(server, hello=False)
        self.addCleanup(hostile.socket.close)
        hostile.hello(client_name=HOSTILE)
        self.assertEqual(hostile.control().welcome.role, access.ADMIN)
        browser = self.browser
        browser.open(self.page(server))
        hostile.call(set_parameters=plain.set_parameters("default", mutation_chance=0.25))
        browser.wait_for_text(HOSTILE, ".notices")
        browser.panel("Events")
        browser.wait_for_text(HOSTILE, "[data-panel=events]")
        self.assertEqual(browser.value("document.images.length"), 0)


if __name__ == "__main__":
    signal.signal(signal.SIGTERM, lambda *_: sys.exit(1))  # closes the browser
    unittest.main(argv=[sys.argv[0], *sys.argv[4:]])
