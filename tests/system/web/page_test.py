"""The page in a real Chromium against a real evod: what it shows is what the server says, and what it does happens
once.

EVOD and EVOCTL name the programs, MESSAGES the folder of the message classes; EVOVIEW, if it is set, the viewer. Each
class below is one subject, and one test of ctest, with a browser of its own. Waits are for conditions, as waiting.py
describes; nothing here measures time or frames.
"""
import json
import os
import pathlib
import signal
import sys
import unittest

HERE = pathlib.Path(__file__).resolve().parent
sys.path[:0] = [str(HERE), str(HERE.parent)]

import numpy  # noqa: E402

import access_test as access  # noqa: E402
import contrast  # noqa: E402
import metrics_test as metrics  # noqa: E402
import png  # noqa: E402
import waiting  # noqa: E402
from browser import Browser, Keys  # noqa: E402
from metrics_test import EVOD, c, plain  # noqa: E402

w = plain.w
PAGE = HERE.parents[2] / "client" / "web"
REQUESTS_MAX, BYTES_MAX = 8, 130_000  # of the first load
SHOWN_PANELS = "[...document.querySelectorAll('[role=tabpanel]')].filter((panel) => panel.checkVisibility())"
HOSTILE = "<img src=x onerror=alert(1)>"
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


class Roles(Case):
    def setUp(self):
        super().setUp()
        self.viewer, self.controller = self.token("vera", access.VIEWER), self.token("carl", access.CONTROLLER)
        self.admin_secret = self.token("ada", access.ADMIN)
        self.served = self.start("--require-token")
        self.admin = self.come(self.served, self.admin_secret)

    def enter(self, secret):
        self.browser.open(self.page(self.served, f"#world=default&token={secret}"))

    def test_a_token_leaves_the_address_and_stays_in_the_tab(self):
        browser = self.browser
        self.enter(self.controller)
        self.assertNotIn("token", browser.driver.current_url)
        self.assertNotIn(self.controller, browser.value("document.documentElement.outerHTML"))
        self.assertEqual(browser.value("document.cookie"), "")
        browser.reload()
        self.assertEqual(browser.value("evod.server.role"), "ROLE_CONTROLLER")
        self.assertEqual(browser.value("evod.server.state.welcome.user"), "carl")
        for url in browser.requested():
            self.assertNotIn(self.controller, url)
        self.assertNotIn(self.controller, self.served.output())

    def follow(self, fragment):
        """Follows a link to the page that is open."""
        self.browser.run("location.hash = arguments[0]", fragment)

    def test_the_page_shows_who_the_user_is(self):
        self.enter(self.viewer)
        self.browser.wait_for_text("vera (viewer)", ".session")

    def test_a_link_does_not_replace_a_token_unasked(self):
        browser = self.browser
        self.enter(self.controller)
        self.follow(f"#world=default&token={self.viewer}")
        browser.wait_for_text("The link contains another token. You are connected as carl (controller).", ".banners")
        self.assertNotIn("token", browser.driver.current_url)
        browser.press("Keep mine")
        browser.wait("!document.querySelector('.banners').textContent.includes('token')", "no question")
        browser.wait_for_text("carl (controller)", ".session")
        self.follow(f"#token={self.viewer}")
        browser.press("Use the token of the link")
        browser.wait_for_text("vera (viewer)", ".session")
        browser.driver.get("about:blank")
        self.enter(self.controller)
        browser.wait_for_text("You are connected as vera (viewer).", ".banners")
        browser.reload()
        browser.wait_for_text("vera (viewer)", ".session")

    def test_a_viewer_changes_nothing(self):
        browser = self.browser
        self.enter(self.viewer)
        browser.wait_for_text("You are a viewer: read-only.")
        self.assertFalse(browser.element("input[role=switch]").is_enabled())
        before = self.admin.world()
        run = browser.button("Run")
        self.assertEqual(run.get_attribute("aria-disabled"), "true")
        self.assertEqual(run.get_attribute("title"), "You are connected as a viewer: read-only.")
        browser.click(run)
        browser.wait_for_text("You are connected as a viewer: read-only.", ".notices")
        browser.panel("Parameters")
        browser.wait_for_text("You are connected as a viewer: read-only.", "[data-panel=parameters]")
        enabled = ("[...document.querySelectorAll('[data-panel=parameters] [data-parameter]')]"
                   ".filter((e) => !e.disabled)")
        self.assertEqual(browser.value(f"{enabled}.length"), 0)
        half = {"name": "mutation_chance", "value": {"real": 0.5}}
        for kind, fields in (("run", {"world": "default"}), ("set_parameters",
                                                             {"world": "default", "parameters": [half]}),
                             ("delete_world", {"world": "default"}), ("shut_down", {})):
            answer = browser.request(kind, **fields)
            self.assertEqual(answer.get("code"), "CODE_PERMISSION_DENIED", answer)
        self.assertEqual(self.admin.world(), before)

    def test_a_controller_can(self):
        self.enter(self.controller)
        self.browser.take_part()
        self.browser.press("One generation")
        self.admin.wait_world(lambda world: world.tick == 120 and world.state == w.RUN_STATE_WAITING, "default")
        new = self.browser.button("New …")
        self.assertEqual(new.get_attribute("title"), "Only the role admin may create and delete worlds.")
        self.browser.take_part(False)

    def test_a_wrong_token_asks_for_the_right_one(self):
        browser = self.browser
        browser.open(self.page(self.served, "#token=evod_" + "0" * 64), wait=False)
        browser.wait("document.querySelector('#token')?.checkVisibility()", "the field for a token")
        browser.wait("document.querySelector('.start [role=status]').textContent.includes('token')", "the reason")
        browser.element("#token").send_keys(self.viewer, Keys.ENTER)
        browser.wait_for_snapshot()
        self.assertEqual(browser.value("evod.server.role"), "ROLE_VIEWER")

    def test_without_a_token_the_page_asks_for_one(self):
        browser = self.browser
        browser.open(self.page(self.served), wait=False)
        browser.run("sessionStorage.clear()")
        browser.driver.refresh()
        browser.wait_for_text("The server requires a token.")
        self.assertEqual(browser.value("document.activeElement.id"), "token")


class WithoutTokens(Case):
    def test_a_link_with_a_token_does_not_lock_the_tab_out(self):
        browser, served = self.browser, self.start()
        browser.open(self.page(served, "#token=abc"), wait=False)
        browser.wait("document.querySelector('#token')?.checkVisibility()", "the field for a token")
        browser.press("Connect")
        browser.wait_for_snapshot()
        browser.wait_for_text("no token (admin)", ".session")
        browser.run("location.hash = '#token=abc'")
        browser.press("Use the token of the link")
        browser.wait_for_text("token", ".notices")  # the reason of the server
        browser.wait_for_text("no token (admin)", ".session")
        browser.reload()
        browser.wait_for_text("no token (admin)", ".session")


class Controls(Case):
    def setUp(self):
        super().setUp()
        self.served = self.start()
        self.control = self.client(self.served)
        self.control.call(subscribe_events=c.SubscribeEvents())
        self.browser.open(self.page(self.served))

    def field(self, name, kind="field"):
        """The field or the slider of a parameter that can be seen."""
        return self.browser.wait("[...document.querySelectorAll(arguments[0])].find((e) => e.checkVisibility())", name,
                                 f"[data-panel=parameters] .{kind}[data-parameter={name}]")

    def wait_enabled(self, name, enabled=True):
        self.browser.wait("document.querySelector(arguments[0])?.disabled === arguments[1]",
                          f"{name} enabled: {enabled}",
                          f".parameters [data-parameter={name}]", not enabled)

    def wait_value(self, name, text):
        """Waits until the field of a parameter contains the text."""
        self.browser.wait("document.querySelector(arguments[0]).value === arguments[1]", f"{name} {text}",
                          f".parameters .field[data-parameter={name}]", text)

    def changed(self, name):
        """The value of a parameter in the next event about it."""
        event = self.control.next_event("parameters_changed",
                                        lambda event: event.parameters_changed.changed[0].name == name)
        state = event.parameters_changed.changed[0]
        value = state.pending if state.HasField("pending") else state.value
        return getattr(value, value.WhichOneof("kind"))

    def test_the_page_opens_watching(self):
        browser = self.browser
        before = self.control.world()
        self.assertFalse(browser.value("evod.server.taking_part"))
        browser.panel("Parameters")
        browser.wait_for_text("You are watching. Turn on “Take part” to change worlds.", "[data-panel=parameters]")
        self.assertFalse(self.field("mutation_chance").is_enabled())
        for label in ("Run", "One generation"):
            browser.click(label)
            browser.wait_for_text("Turn on “Take part”", ".notices")
        browser.element("body").send_keys(Keys.SPACE)
        self.assertEqual(self.control.world(), before)
        browser.take_part()
        self.wait_enabled("mutation_chance")
        browser.take_part(False)
        self.wait_enabled("mutation_chance", False)

    def test_a_field_and_a_slider_change_the_server(self):
        browser = self.browser
        browser.take_part()
        browser.panel("Parameters")
        self.wait_enabled("mutation_chance")
        browser.type_into(self.field("mutation_chance"), "0.25")
        browser.press("Apply")
        self.assertEqual(self.changed("mutation_chance"), 0.25)
        browser.wait_for_text("no edits", "[data-panel=parameters]")
        browser.click(browser.value("document.querySelector('.parameters .check input')"))  # apply at once
        self.field("mutation_chance", "parameter-slider").send_keys(Keys.ARROW_RIGHT)
        moved = self.changed("mutation_chance")
        self.assertGreater(moved, 0.25)
        self.assertEqual(self.value_of(self.control, "mutation_chance"), moved)
        browser.press("Undo")
        self.assertEqual(self.changed("mutation_chance"), 0.25)

    def test_undo_reverses_changes_and_placings(self):
        browser = self.browser
        browser.take_part()
        browser.press("Food")
        left, top, width, height = browser.canvas()
        browser.click_at(left + width / 4, top + height / 3)
        placed = self.control.next_event("placed").placed
        browser.wait("evod.app.world().undo.next_undo === 'placed 1 food'", "the placed food in the history")
        browser.panel("Parameters")
        self.wait_enabled("mutation_chance")
        before = self.value_of(self.control, "mutation_chance")
        browser.type_into(self.field("mutation_chance"), "0.25")
        self.field("mutation_chance").send_keys(Keys.CONTROL, "z")  # the field undoes its own text
        browser.type_into(self.field("mutation_chance"), "0.25")
        browser.press("Apply")
        self.assertEqual(self.changed("mutation_chance"), 0.25)
        browser.wait("evod.app.world().undo.next_undo === 'Mutation chance'", "the change in the history")
        browser.element("body").send_keys(Keys.CONTROL, "z")
        self.assertEqual(self.changed("mutation_chance"), before)
        browser.wait("evod.app.world().undo.next_undo === 'placed 1 food'", "the end of the first undo")
        browser.press("Undo", ".tools")
        self.assertEqual(self.control.next_event("removed").removed.food, placed.food)
        browser.wait("evod.app.world().undo.next_redo === 'placed 1 food'", "the end of the second undo")
        browser.element("body").send_keys(Keys.CONTROL, Keys.SHIFT, "z")
        self.assertEqual(len(self.control.next_event("placed").placed.food), 1)
        browser.wait("evod.app.world().undo.next_redo === 'Mutation chance'", "the end of the redo")
        browser.element("body").send_keys(Keys.CONTROL, "y")
        self.assertEqual(self.changed("mutation_chance"), 0.25)

    def test_the_run_bar_controls_the_world(self):
        browser = self.browser
        browser.take_part()
        browser.press("Max")
        self.control.wait_world(lambda world: world.speed.max, "default")
        browser.wait("evod.app.world().control.speed?.max", "the maximum speed")
        browser.press("One generation")
        self.control.wait_world(lambda world: world.tick == 120 and world.state == w.RUN_STATE_WAITING, "default")
        self.shown_tick(120)
        browser.press("Max")
        self.control.wait_world(lambda world: world.speed.real_time_factor == 1, "default")
        browser.press("Double the speed")
        self.control.wait_world(lambda world: world.speed.real_time_factor == 2, "default")
        browser.wait("document.querySelector('.run-bar .run').textContent !== 'Pause'", "a stopped world")
        browser.press(browser.text(".run-bar .run"), ".run-bar")
        self.control.wait_world(lambda world: world.state == w.RUN_STATE_RUNNING, "default")
        browser.wait_for_text("Pause", ".run-bar")
        browser.press("Pause")
        self.control.wait_world(lambda world: world.state == w.RUN_STATE_PAUSED, "default")
        browser.wait_for_text("Resume", ".run-bar")

    def test_a_refused_value_is_explained_at_its_field(self):
        browser = self.browser
        browser.take_part()
        browser.panel("Parameters")
        self.wait_enabled("mutation_chance")
        browser.type_into(browser.element(".parameters [type=search]"), "spawn margin")
        browser.type_into(self.field("spawn_margin_px"), "300")
        refused = self.control.call(plain.INVALID, set_parameters=plain.set_parameters("default",
                                                                                       spawn_margin_px=300.0)).status
        self.assertEqual(refused.violations[0].got, "300")
        browser.press("Apply")
        allowed = refused.violations[0].allowed
        browser.wait_for_text(f"got 300, allowed {allowed}", ".parameter[data-name=spawn_margin_px] .error")
        self.assertNotEqual(self.value_of(self.control, "spawn_margin_px"), 300)
        self.assertEqual(self.field("spawn_margin_px").get_attribute("aria-invalid"), "true")

    def test_two_pages_see_each_others_changes(self):
        browser, first = self.browser, self.browser.driver.current_window_handle
        browser.take_part()
        browser.panel("Parameters")
        self.wait_enabled("mutation_step")
        browser.driver.switch_to.new_window("window")
        second = browser.driver.current_window_handle
        try:
            browser.resize(800, 700)
            browser.open(self.page(self.served))
            browser.take_part()
            browser.panel("Parameters")
            self.wait_enabled("mutation_step")
            browser.type_into(self.field("mutation_step"), "21")
            browser.press("Apply")
            self.assertEqual(self.changed("mutation_step"), 21)
            browser.driver.switch_to.window(first)
            self.wait_value("mutation_step", "21")
            browser.wait_for_text("set mutation_step to 21", ".notices")
            browser.type_into(self.field("mutation_step"), "22")
            browser.press("Apply")
            self.assertEqual(self.changed("mutation_step"), 22)
            browser.driver.switch_to.window(second)
            self.wait_value("mutation_step", "22")
        finally:
            for handle in browser.driver.window_handles:
                if handle != first:
                    browser.driver.switch_to.window(handle)
                    browser.driver.close()
            browser.driver.switch_to.window(first)


class Past(Case):
    def setUp(self):
        super().setUp()
        self.served = self.start()
        self.control = self.client(self.served)
        self.control.call(set_speed=c.SetSpeed(world="default", speed=w.Speed(max=True)))
        self.control.run_to(500)  # in generation 5 of 120 ticks each

    def over_tcp(self, generation, tick):
        """The state hash in a replay of a TCP client."""
        viewer = self.client(self.served)
        past = viewer.call(open_replay=c.OpenReplay(world="default",
                                                    at=c.RunMoment(generation=generation, tick=tick))).world
        viewer.call(close_replay=c.CloseReplay(world=past.name))
        return past.state_hash

    def shown(self, generation, tick):
        self.browser.wait(
            """(({ generation, generation_tick }) => generation === arguments[0] && generation_tick === arguments[1])(
                              evod.app.world().snapshot ?? {})""", f"generation {generation}, tick {tick}", generation,
                              tick)
        return self.browser.snapshot()

    def test_a_link_shows_its_moment(self):
        browser = self.browser
        browser.open(self.page(self.served, "#world=default&generation=3&tick=60"))
        seen = self.shown(3, 60)
        self.assertEqual(seen["state_hash"], self.over_tcp(3, 60))
        browser.wait_for_text("REPLAY of default", ".pane-head")
        browser.wait_for_text("Generation 3", ".pane-head h1")
        self.assertEqual(browser.value("document.querySelector('.banners').innerText"), "")
        browser.press("Live", ".timeline")
        live = self.shown(5, 20)
        self.assertEqual((live["world"], live["state_hash"]), ("default", self.control.world().state_hash))
        self.assertFalse(browser.value("evod.app.world().is_replay"))

    def test_a_wrong_link_says_what_is_wrong(self):
        browser = self.browser
        for fragment, sentence, moment in (
                ("#world=default&generation=3&tick=9e9", "tick: got 9e9, generation 3 has 0 to 120", (3, 120)),
                ("#world=default&generation=77", "generation: got 77, the run has 1 to 5", (5, 20)),
                ("#world=default&generation=x", 'generation: got "x", allowed whole numbers', (5, 20)),
                ("#world=default&island=9", "island: got 9, the world default has only 0", (5, 20)),
                ("#world=mars&generation=1", "world: got mars, this server has default", (5, 20))):
            with self.subTest(fragment):
                browser.open(self.page(self.served, fragment))
                browser.wait_for_text(sentence, ".banners")
                self.shown(*moment)
                browser.press("Close", ".banners")
                self.assertEqual(browser.text(".banners"), "")

    def test_a_typed_generation_is_shown(self):
        browser = self.browser
        browser.open(self.page(self.served))
        field = browser.element(".time-generation")
        browser.type_into(field, "2")
        self.shown(2, 0)
        for wrong in ("0", "9", "x"):
            browser.type_into(field, wrong)
            browser.wait_for_text(f'Generation: got "{wrong}", allowed whole numbers from 1 to 5.',
                                  ".timeline [role=alert]")
        field.send_keys(Keys.ESCAPE)
        self.assertEqual(field.get_attribute("value"), "2")

    def test_the_copied_link_leads_back(self):
        browser = self.browser
        browser.open(self.page(self.served, "#world=default&generation=2&tick=30&island=0&organism=7"))
        before = self.shown(2, 30)
        browser.wait("evod.app.world().selection.id === 7", "the selected organism")
        link = browser.run("""let copied = null;
            navigator.clipboard.writeText = async (text) => { copied = text; };
            arguments[0].click();
            return copied;""", browser.button("Copy link", ".timeline"))
        self.assertEqual(link, self.page(self.served, "#world=default&generation=2&tick=30&island=0&organism=7"))
        browser.open(link)
        self.assertEqual(self.shown(2, 30)["state_hash"], before["state_hash"])

    def test_a_fork_of_the_past_is_shown_beside_its_origin(self):
        browser = self.browser
        browser.open(self.page(self.served, "#world=default&generation=3&tick=60"))
        self.shown(3, 60)
        browser.take_part()
        browser.press("Fork")
        self.control.wait_world(lambda world: world.name == "default-2", "default-2")
        fork = self.control.world("default-2")
        self.assertEqual((fork.generation, fork.generation_tick, fork.state_hash), (3, 60, self.over_tcp(3, 60)))
        browser.wait("evod.app.areas.length === 2", "two worlds")
        browser.wait("evod.app.areas.every((area) => area.world.snapshot?.state_hash === arguments[0])",
                     "both at the same state", fork.state_hash)
        self.assertEqual(browser.value("evod.app.areas.map((area) => area.world.name)"), ["default", "default-2"])


class Connection(Case):
    def setUp(self):
        super().setUp()
        self.served = self.start("--speed", "max")
        self.address = self.page(self.served)
        self.browser.open(self.address)
        self.browser.take_part()

    def restart(self):
        """Another server with the same data and the same address of the page."""
        self.served = self.server("--data", self.folder, "--http-port", str(self.served.http_port))
        self.http(self.served)

    def journal(self, kind):
        """How many commands of a kind the run file contains."""
        files = [str(file) for file in pathlib.Path(self.folder).glob("default*.evod")]
        self.assertEqual(len(files), 1)
        exported = waiting.run([EVOD, "export", files[0], "--what", "events", "--format", "jsonl"], capture_output=True,
                               text=True, check=True)
        return sum(f'"{kind}"' in line for line in exported.stdout.splitlines())

    def test_the_page_carries_on_after_a_kill(self):
        browser = self.browser
        self.client(self.served).run_to(130)
        self.shown_tick(130)
        self.served.kill()
        browser.wait_for_text("Trying again", ".banners")
        browser.wait_for_text("not connected", ".pane-state")
        self.assertEqual(browser.snapshot()["tick"], 130)  # the last image stays
        browser.run("""globalThis.answered = null;
            evod.app.world().control.run_until_tick(200)
                .then(() => answered = "yes", (error) => answered = error.message);""")
        self.restart()
        browser.wait("answered", "the answer of the new server")
        self.assertEqual(browser.value("answered"), "yes")
        self.shown_tick(200)
        self.assertEqual(browser.text(".banners"), "")
        self.assertEqual(self.client(self.served).world().tick, 200)
        self.served.process.terminate()
        self.assertEqual(waiting.ended(self.served.process), 0)
        self.assertEqual(self.journal("run_until_tick"), 2)  # one by the TCP client, one by the page

    def test_commands_around_a_kill_happen_once(self):
        browser, count = self.browser, 40
        browser.run("""globalThis.done = [];
            (async () => {
              for (let i = 1; i <= arguments[0]; ++i) {
                const parameters = [{ name: "mutation_step", value: { real: i } }];
                await evod.server.request("set_parameters", { world: "default", parameters })
                  .then(() => done.push(i), (error) => done.push(error.message));
              }
            })();""", count)
        browser.wait("done.length >= 5", "some answers")
        self.served.kill()
        self.restart()
        browser.wait("done.length === arguments[0]", "all answers", count)
        self.assertEqual(browser.value("done"), list(range(1, count + 1)))
        self.assertEqual(self.value_of(self.client(self.served), "mutation_step"), count)
        self.served.process.terminate()
        self.assertEqual(waiting.ended(self.served.process), 0)
        self.assertEqual(self.journal("set_parameters"), count)

    def test_a_hidden_page_gets_no_snapshots(self):
        browser, first = self.browser, self.browser.driver.current_window_handle
        control = self.client(self.served)
        control.call(run=c.Run(world="default"))
        self.wait(self.served, lambda seen: seen("evod_snapshots_sent_total") > 20, "snapshots")
        browser.driver.switch_to.new_window("tab")  # hides the first
        try:
            sent = lambda: self.metrics(self.served)("evod_snapshots_sent_total")

            def stands_still():
                """Whether none is sent during a thousand ticks."""
                before, tick = sent(), control.world().tick
                control.wait_world(lambda world: world.tick > tick + 1000, "default")
                return sent() == before
            plain.until(stands_still, "no further snapshots")
            still = sent()
        finally:
            browser.driver.close()
            browser.driver.switch_to.window(first)
        self.wait(self.served, lambda seen: seen("evod_snapshots_sent_total") > still + 5,
                  "snapshots for the visible page")

    def test_a_shutdown_is_announced(self):
        browser = self.browser
        self.served.process.terminate()
        browser.wait_for_text("The server has shut down. Trying again …", ".banners")
        self.assertEqual(waiting.ended(self.served.process), 0)
        self.restart()
        browser.wait("evod.server.state.phase === 'open' && document.querySelector('.banners').innerText === ''",
                     "a session")


class Keyboard(Case):
    def setUp(self):
        super().setUp()
        self.served = self.start(generation_s=60.0)
        self.control = self.client(self.served)
        self.control.run_to(60)
        self.browser.open(self.page(self.served))
        self.shown_tick(60)

    def test_everything_is_reachable_by_tab(self):
        browser = self.browser
        browser.take_part()
        expected = browser.value("""(() => {
            const all = [...document.querySelectorAll("a[href], button, input, select, textarea, summary, [tabindex]")]
              .filter((e) => e.tabIndex >= 0 && !e.disabled && e.checkVisibility({ checkVisibilityCSS: true }));
            all.forEach((e, i) => e.dataset.reach = i);
            return all.map((e) => `${e.tagName} ${e.getAttribute("aria-label") ?? e.textContent.slice(0, 30)}`);
          })()""")
        self.assertGreater(len(expected), 20)
        browser.run("document.activeElement.blur()")
        reached, unseen = set(), []
        for _ in range(len(expected) + 5):
            browser.driver.switch_to.active_element.send_keys(Keys.TAB)
            number, visible = browser.value("""(() => {
                const e = document.activeElement, style = getComputedStyle(e);
                const mark = document.querySelector(".pane-focus");
                const seen = style.outlineStyle !== "none" && parseFloat(style.outlineWidth) >= 1;
                const of_canvas = e.matches(".pane-canvas") && parseFloat(getComputedStyle(mark).borderTopWidth) >= 1;
                return [e.dataset.reach ?? null, seen || of_canvas];
              })()""")
            if number is None:
                continue
            if int(number) in reached:
                break
            reached.add(int(number))
            if not visible:
                unseen.append(expected[int(number)])
        self.assertEqual([name for i, name in enumerate(expected) if i not in reached], [])
        self.assertEqual(unseen, [])

    def test_the_run_control_works_by_keyboard(self):
        browser = self.browser
        switch = browser.element("input[role=switch]")
        switch.send_keys(Keys.SPACE)
        browser.wait("evod.server.taking_part && !document.querySelector('.run-bar .run').ariaDisabled",
                     "an enabled button")
        browser.element(".run-bar .run").send_keys(Keys.ENTER)
        self.control.wait_world(lambda world: world.state == w.RUN_STATE_RUNNING, "default")
        browser.wait("evod.app.world().control.state === 'RUN_STATE_RUNNING'", "running")
        browser.element(".pane-canvas").send_keys(Keys.SPACE)
        paused = self.control.wait_world(lambda world: world.state == w.RUN_STATE_PAUSED, "default")
        self.shown_tick(paused.tick)
        browser.element(".pane-canvas").send_keys(".")
        self.control.wait_world(lambda world: world.tick == paused.tick + 1 and world.state == w.RUN_STATE_PAUSED,
                                "default")
        browser.element(".pane-canvas").send_keys("?")
        browser.wait_for_text("Keys and gestures", "dialog[open]")
        browser.driver.switch_to.active_element.send_keys(Keys.ESCAPE)
        browser.wait("document.querySelector('dialog[open]') === null", "the closed help")

    def test_every_control_has_a_name(self):
        browser = self.browser
        browser.take_part()
        browser.cdp("Accessibility.enable")
        roles = {"button", "link", "textbox", "searchbox", "slider", "spinbutton", "checkbox", "switch", "combobox",
                 "listbox",
                 "radio", "tab", "tabpanel", "dialog", "application", "image", "grid"}
        for title in browser.panels():
            browser.panel(title)
            browser.wait(f"{SHOWN_PANELS}.some((panel) => panel.innerText !== '')", title)
            nodes = browser.cdp("Accessibility.getFullAXTree")["nodes"]
            controls = [node for node in nodes if not node["ignored"] and node["role"]["value"] in roles]
            self.assertGreater(len(controls), 20)
            nameless = [node for node in controls if not node.get("name", {}).get("value", "").strip()]
            self.assertEqual([self.markup(node) for node in nameless], [], title)
        browser.cdp("Accessibility.disable")

    def markup(self, node):
        described = self.browser.cdp("DOM.getOuterHTML", backendNodeId=node["backendDOMNodeId"])
        return described["outerHTML"][:200]

    def test_texts_have_contrast(self):
        sheet = (PAGE / "app.css").read_text()
        texts = ("--text", "--text-2", "--accent", "--food", "--poison", "--good", "--bad", "--warn")
        for theme in (":root", ":root[data-theme=light]", ":root:not([data-theme=dark])"):
            colours = contrast.tokens(sheet, theme)
            pairs = [(text, ground) for text in texts for ground in ("--bg", "--surface", "--surface-2")]
            of_pairs = {pair: contrast.contrast(*(colours[name] for name in pair))
                        for pair in [*pairs, ("--accent-text", "--accent")]}
            self.assertEqual({pair: of for pair, of in of_pairs.items() if of < 4.5}, {}, theme)
        self.assertAlmostEqual(contrast.contrast((255, 255, 255), (0, 0, 0)), 21)
        self.assertAlmostEqual(contrast.contrast((118, 118, 118), (255, 255, 255)), 4.54, places=2)

    def test_a_tap_selects(self):
        browser = self.browser
        organisms = browser.columns()["organisms"]
        left, top, width, height = browser.canvas()
        browser.set_camera(360, 225, 1)
        place = {organism: (left + width / 2 + x / 16 - 360, top + height / 2 + y / 16 - 225)
                 for organism, x, y in zip(organisms["id"], organisms["x"], organisms["y"])}
        distance = lambda one, other: numpy.hypot(place[one][0] - place[other][0], place[one][1] - place[other][1])
        alone = [one for one in place if min(distance(one, other) for other in place if other != one) > 60]
        self.assertGreaterEqual(len(alone), 2)
        for organism in alone[:3]:
            browser.tap(*place[organism])
            browser.wait("evod.app.world().selection.id === arguments[0]", f"organism {organism} selected", organism)
            browser.wait_for_text(f"{organism}", "[data-panel=organism]")


@unittest.skipUnless("EVOVIEW" in os.environ, "evoview is not built")
class SamePlace(Case):
    """evoview and the page draw the same moment of a world."""

    def test_organisms_are_at_the_same_place(self):
        server = self.start(generation_s=60.0, population_size=15, food_count=0, poison_count=0)
        control = self.client(server)
        control.run_to(120)
        file = pathlib.Path(self.folder) / "evoview.png"
        under_xvfb = HERE.parent / "viewer" / "under_xvfb.sh"
        done = waiting.run([str(under_xvfb), os.environ["EVOVIEW"], "--server", f"127.0.0.1:{server.port}", "--skin",
                            "classic",
                            "--size", "1280x720", "--screenshot", str(file), "--at-tick", "120", "--timeout", "600"],
                           capture_output=True, text=True)
        if done.returncode == 77:
            self.skipTest(done.stdout)
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
        browser = self.browser
        browser.open(self.page(server))
        self.shown_tick(120)
        browser.run("evod.app.world().set_look({ skin: 'classic', trails: false, perception: 'none', minimap: false })")
        organisms = browser.columns()["organisms"]
        x, y, radius = (numpy.array(organisms[name]) / 16 for name in ("x", "y", "radius"))
        of_page = plain.until(lambda: self.centres(browser.pixels(), x, y, radius), "the classic skin", pause_s=0.2)
        of_viewer = self.centres(png.decode(file.read_bytes()), x, y, radius)
        self.assertGreaterEqual(len(of_page), 10)
        self.assertEqual(of_page.keys(), of_viewer.keys())
        for i, place in of_page.items():
            with self.subTest(organism=organisms["id"][i]):
                numpy.testing.assert_allclose(place, of_viewer[i], atol=0.5)
                numpy.testing.assert_allclose(place, (x[i], y[i]), atol=0.5)

    @staticmethod
    def centres(pixels, x, y, radius):
        """Where the rings are of the organisms far from others, in px of the island. None: this is not the classic
        skin."""
        pixels = pixels.astype(float)
        ground, ring = numpy.array([204.0] * 3), numpy.array([104.0, 22, 148])
        inside = (pixels == ground).all(axis=2)
        if inside.mean() < 0.2:
            return None
        columns, rows = numpy.flatnonzero(inside.any(axis=0)), numpy.flatnonzero(inside.any(axis=1))
        left, top = columns[0], rows[0]
        zoom = (columns[-1] + 1 - left) / SMALL["island_width_px"]
        way = ring - ground
        share = ((pixels - ground) @ way) / (way @ way)  # of the ring's colour in a pixel
        beside = numpy.abs(pixels - ground - share[:, :, None] * way).max(axis=2)
        share[(beside > 12) | (share < 0.05)] = 0
        found = {}
        for i in range(len(x)):
            reach = radius[i] + 4
            others = numpy.hypot(numpy.delete(x, i) - x[i], numpy.delete(y, i) - y[i]) - numpy.delete(radius, i)
            walls = min(x[i], y[i], SMALL["island_width_px"] - x[i], SMALL["island_height_px"] - y[i])
            if others.min() < 2 * reach or walls < reach:
                continue
            u0, u1 = (int(round(left + (x[i] + side * reach) * zoom)) for side in (-1, 1))
            v0, v1 = (int(round(top + (y[i] + side * reach) * zoom)) for side in (-1, 1))
            part = share[v0:v1, u0:u1]
            v, u = numpy.mgrid[v0:v1, u0:u1] + 0.5
            found[i] = ((part * u).sum() / part.sum() - left) / zoom, ((part * v).sum() / part.sum() - top) / zoom
        return found


if __name__ == "__main__":
    signal.signal(signal.SIGTERM, lambda *_: sys.exit(1))  # closes the browser
    unittest.main(argv=[sys.argv[0], *sys.argv[4:]])
