"""Two worlds next to each other in a real Chromium: choosing the second one, running both, and evolution: generation 1
next to the present."""
import json
import signal
import sys
import unittest

from page_case import Case, access, c, w
from browser import Keys

BOTH_RUN = "evod.app.areas.every((area) => area.world.control.state === 'RUN_STATE_RUNNING')"
NONE_RUNS = "evod.app.areas.every((area) => area.world.control.state !== 'RUN_STATE_RUNNING')"


class TwoWorlds(Case):
    def setUp(self):
        super().setUp()
        self.served = self.start(generation_s=1.0)
        self.control = self.client(self.served)
        self.speed(max=True)

    def speed(self, **speed):
        self.control.call(set_speed=c.SetSpeed(world="default", speed=w.Speed(**speed)))

    def open(self, part=True):
        self.browser.open(self.page(self.served))
        self.browser.take_part(part)

    def key(self, key):
        self.browser.element("body").send_keys(key)

    def choose(self, text):
        """Chooses an entry of the list of B."""
        self.key("b")
        self.browser.wait_for_text("Show next to this world", "dialog[open]")
        self.browser.click(self.browser.wait(
            """[...document.querySelectorAll("dialog[open] .second-choice")]
               .find((e) => e.innerText.startsWith(arguments[0]))""", f"the entry {text}", text))

    def shown(self):
        return self.browser.value("""evod.app.areas.map(({ world, pane }) => [world.name, world.is_replay,
            JSON.stringify(pane.view.camera), world.selection.id])""")

    # ---- the second world ----

    def test_the_second_world_is_chosen_from_a_list(self):
        browser = self.browser
        self.control.run_to(150)
        for name in ("aaa", "other"):
            self.control.call(create_world=c.CreateWorld(name=name, seed=2))
        self.open()
        self.shown_tick(150)
        browser.set_camera(100, 100, 2)
        browser.run("evod.app.world().selection.select(3)")
        before = self.shown()
        self.choose("other")
        browser.wait("evod.app.areas[1]?.world.snapshot?.world === 'other'", "the second world")
        self.assertEqual(browser.value("evod.app.world().name"), "default")
        self.assertEqual(self.shown()[0], before[0])
        self.assertTrue(browser.value("evod.server.access.taking_part"))
        self.key("x")
        self.assertEqual(browser.value("evod.app.world().name"), "other")
        self.key("b")  # closes the second world, although it has the focus
        browser.wait("evod.app.areas.length === 1", "one world")
        self.assertEqual(self.shown(), before)
        self.assertTrue(browser.value("evod.server.access.taking_part"))

    def test_a_world_alone_offers_its_past(self):
        browser = self.browser
        self.control.run_to(190)  # in generation 4
        self.open(part=False)
        self.key("b")
        browser.wait_for_text("Generation 1 of default", "dialog[open]")
        field = browser.element("dialog[open] .time-generation")
        field.send_keys(Keys.CONTROL, "a")
        field.send_keys("9")
        browser.wait_for_text('Generation: got "9", allowed whole numbers from 1 to 4', "dialog[open]")
        field.send_keys(Keys.CONTROL, "a")
        field.send_keys("2")
        browser.wait_for_text("Generation 2 of default", "dialog[open]")
        field.send_keys(Keys.ENTER)
        browser.wait("evod.app.areas[1]?.world.snapshot?.generation === 2", "generation 2")
        self.assertEqual([one[:2] for one in self.shown()], [["default", False], ["default", True]])

    def test_a_fork_can_be_the_second_world(self):
        self.control.run_to(90)
        self.open()
        self.choose("A fork of default")
        self.browser.wait("evod.app.areas[1]?.world.snapshot?.world === 'default-2'", "the fork")

    # ---- both ----

    def test_both_worlds_run_and_pause_together(self):
        browser = self.browser
        self.speed(real_time_factor=1)
        self.control.call(create_world=c.CreateWorld(name="other", seed=2))
        self.open()
        self.choose("other")
        browser.wait("evod.app.areas[1]?.world.snapshot?.world === 'other'", "the second world")
        browser.press("Run both")
        for world in ("default", "other"):
            self.control.wait_world(lambda one: one.state == w.RUN_STATE_RUNNING, world)
        browser.wait(BOTH_RUN, "both running")
        browser.press("Pause both")
        for world in ("default", "other"):
            self.control.wait_world(lambda one: one.state == w.RUN_STATE_PAUSED, world)

    def test_the_world_that_may_not_run_is_named(self):
        browser = self.browser
        self.control.run_to(190)
        self.open(part=False)
        self.choose("Generation 1 of default")
        browser.wait("evod.app.areas[1]?.world.snapshot?.generation === 1", "generation 1")
        browser.press("Run both")
        browser.wait_for_text("default: You are watching.", ".notices")
        browser.wait("evod.app.areas[1].world.control.state === 'RUN_STATE_RUNNING'", "the replay running")
        self.assertEqual(self.control.world().tick, 190)

    # ---- evolution ----

    def test_a_young_world_runs_ahead_first(self):
        browser = self.browser
        self.speed(real_time_factor=1)
        self.control.run_to(20)
        self.open(part=False)
        browser.press("Show evolution")
        browser.wait_for_text("This world is in generation 1", ".banners")
        browser.press("Take part, and run 30 generations at full speed", ".banners")
        browser.wait("evod.app.areas.length === 2 && " + BOTH_RUN, "both running")
        self.assertTrue(browser.value("evod.server.access.taking_part"))
        browser.wait("evod.app.areas[1].world.snapshot?.generation <= 3", "generation 1")
        browser.wait_for_text("Generation ", ".pane-caption")
        browser.wait_for_text("Now, after generation 3", ".pane-caption")
        self.assertIn("mean fitness", browser.text(".pane-caption"))
        self.assertEqual(self.control.world().speed.real_time_factor, 1)
        browser.press("End the comparison")
        browser.wait("evod.app.areas.length === 1", "one world")
        self.assertFalse(browser.value("evod.app.world().is_replay"))
        self.assertEqual(browser.value("document.querySelectorAll('.pane-caption:not([hidden])').length"), 0)

    def test_the_run_ahead_can_be_cancelled(self):
        browser = self.browser
        large = json.dumps({"generation_s": 40.0, "population_size": 1000, "island_width_px": 5000,
                            "island_height_px": 4000})
        self.control.call(create_world=c.CreateWorld(name="large", seed=1, experiment_json=large))
        browser.open(self.page(self.served, "#world=large"))
        browser.take_part()
        browser.press("Show evolution")
        browser.wait_for_text("This world is in generation 1", ".banners")  # its code is loaded first
        browser.press("Run 30 generations at full speed", ".banners")
        browser.wait("document.querySelector('.banners progress') !== null", "the progress")
        self.control.wait_world(lambda world: world.speed.max and world.state == w.RUN_STATE_RUNNING, "large")
        browser.press("Cancel", ".banners")
        self.control.wait_world(lambda world: not world.speed.max and world.state == w.RUN_STATE_PAUSED, "large")
        self.assertEqual(browser.text(".banners"), "")

    def test_a_viewer_sees_evolution_too(self):
        browser = self.browser
        self.control.run_to(15 * 60 + 30)
        self.open(part=False)
        browser.press("Show evolution")
        browser.wait("evod.app.areas[1]?.world.control.state === 'RUN_STATE_RUNNING'", "the replay running")
        browser.wait_for_text("default does not run: You are watching.", ".notices")
        browser.wait_for_text("Now, after generation 15", ".pane-caption")
        self.assertEqual(self.control.world().tick, 15 * 60 + 30)
        browser.element("body").send_keys("e")
        browser.wait("evod.app.areas.length === 1", "one world")

    # ---- new worlds, placing ----

    def test_a_new_world_can_run_at_once(self):
        self.open()
        self.browser.press("New …")
        self.browser.wait_for_text("Create and run", "dialog[open]")  # its code is loaded first
        self.browser.press("Create and run", "dialog[open]")
        self.browser.wait("evod.app.world().name === 'default-2'", "the new world")
        self.control.wait_world(lambda world: world.state == w.RUN_STATE_RUNNING, "default-2")

    def test_placing_offers_undo(self):
        browser = self.browser
        self.control.call(subscribe_events=c.SubscribeEvents())
        self.control.run_to(10)
        self.open()
        browser.press("Food")
        left, top, width, height = browser.canvas()
        browser.click_at(left + width / 2 + 30, top + height / 2)
        browser.wait_for_text("Placed 1 food.", ".notices")
        browser.press("Undo", ".notices")
        self.assertEqual(len(self.control.next_event("removed").removed.food), 1)


if __name__ == "__main__":
    signal.signal(signal.SIGTERM, lambda *_: sys.exit(1))  # closes the browser
    unittest.main(argv=[sys.argv[0], *sys.argv[4:]])
