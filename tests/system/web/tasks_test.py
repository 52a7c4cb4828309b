"""Tasks of a lesson in the page. Each takes at most three actions from the first screen: clicks, keys, and choices
in a list.

The user takes part already. docs/BROWSER.md lists the tasks with their actions.
"""
import pathlib
import signal
import sys
import unittest

from selenium.webdriver.support.ui import Select

HERE = pathlib.Path(__file__).resolve().parent
sys.path[:0] = [str(HERE), str(HERE.parent)]

from page_case import Case, c, w  # noqa: E402
from browser import Keys  # noqa: E402

ACTIONS_MAX = 3


class Tasks(Case):
    def setUp(self):
        super().setUp()
        self.served = self.start(generation_s=1.0)
        self.control = self.client(self.served)
        self.control.call(set_speed=c.SetSpeed(world="default", speed=w.Speed(max=True)))
        self.control.run_to(9 * 60 + 30)  # in generation 10
        self.control.call(set_speed=c.SetSpeed(world="default", speed=w.Speed(real_time_factor=1)))
        self.control.call(subscribe_events=c.SubscribeEvents())
        self.browser.open(self.page(self.served))
        self.shown_tick(9 * 60 + 30)
        self.browser.take_part()
        self.browser.set_camera(360, 225, 1)
        self.actions = 0

    def tearDown(self):
        self.assertLessEqual(self.actions, ACTIONS_MAX)
        self.assertGreater(self.actions, 0)
        super().tearDown()

    # ---- actions ----

    def act(self, what, *arguments):
        self.actions += 1
        return what(*arguments)

    def panel(self, title):
        self.act(self.browser.panel, title)

    def press(self, label, within="body"):
        self.act(self.browser.press, label, within)

    def key(self, key):
        self.act(self.browser.element("body").send_keys, key)

    def choose(self, css, value):
        """Chooses an entry of a drop-down list. The browser shows and closes the list."""
        found = self.browser.wait("""[...document.querySelectorAll(arguments[0])].find((e) =>
            e.checkVisibility() && !e.disabled && [...e.options].some((option) => option.value === arguments[1]))""",
                                  f"{value} in {css}", css, value)
        self.act(Select(found).select_by_value, value)

    def click_island(self, x_px, y_px):
        """Clicks on a point of the island."""
        left, top, width, height = self.browser.canvas()
        x, y = left + width / 2 + x_px - 360, top + height / 2 + y_px - 225  # as set_camera() has it
        self.act(self.mouse, x, y)

    def mouse(self, x, y):
        for kind in ("mouseMoved", "mousePressed", "mouseReleased"):
            pressed = dict(button="left", clickCount=1) if kind != "mouseMoved" else {}
            self.browser.cdp("Input.dispatchMouseEvent", type=kind, x=x, y=y, **pressed)

    def click_organism(self, organism):
        shown = self.browser.columns()["organisms"]
        row = shown["id"].index(organism)
        self.click_island(shown["x"][row] / 16, shown["y"][row] / 16)
        self.browser.wait("evod.app.world().selection.id === arguments[0]", f"organism {organism} selected", organism)

    def child(self):
        """An organism that is alive, is not covered by others, and has parents."""
        shown = self.browser.columns()["organisms"]
        places = list(zip(shown["id"], shown["x"], shown["y"]))
        for organism, x, y in places:
            if min((x - x2) ** 2 + (y - y2) ** 2 for one, x2, y2 in places if one != organism) > (16 * 50) ** 2:
                found = self.control.call(get_organism=c.GetOrganism(world="default", organism=organism)).organism
                if found.parents:
                    return found
        self.fail("every organism is a founder, or covered")

    def worlds(self):
        return {world.name for world in self.control.call(list_worlds=c.ListWorlds()).worlds.worlds}

    # ---- tasks ----

    def test_change_the_selection_method(self):
        self.panel("Parameters")
        self.choose("[data-panel=parameters] select[data-parameter=selection]", "tournament")
        self.press("Apply")
        self.browser.wait_for_text("no edits", "[data-panel=parameters]")
        self.assertEqual(self.value_of(self.control, "selection"), "tournament")

    def test_slow_down(self):
        self.key("-")
        self.control.wait_world(lambda world: world.speed.real_time_factor == 0.5, "default")

    def test_follow_an_organism(self):
        organism = self.child().id
        self.click_organism(organism)
        self.key("l")
        self.browser.wait("evod.app.world().selection.follow && evod.app.world().selection.id === arguments[0]",
                          "following", organism)

    def test_show_generation_5_again(self):
        left, top, width, height = self.browser.value("""(({ left, top, width, height }) => [left, top, width, height])(
            document.querySelector(".column .plot canvas").getBoundingClientRect())""")
        # The generations 1 to 9 have ended: generation 5 is in the middle of the curve, to the right of the axis's
        # numbers.
        self.act(self.mouse, left + width * 0.55, top + height / 2)
        generation = self.browser.wait("""(world => world.is_replay && world.snapshot?.generation < 10 &&
            world.snapshot.generation)(evod.app.world())""", "an earlier generation")
        self.assertIn(generation, (4, 5, 6))
        self.key(Keys.SPACE)
        self.browser.wait("evod.app.world().control.state === 'RUN_STATE_RUNNING'", "the replay playing")

    def test_compare_two_worlds(self):
        self.control.call(create_world=c.CreateWorld(name="other", seed=2))
        self.browser.wait("evod.server.worlds.names.length === 2", "two worlds")
        self.key("b")
        self.act(self.browser.click, self.browser.wait("""[...document.querySelectorAll("dialog[open] .second-choice")]
            .find((e) => e.innerText.startsWith("other"))""", "the other world in the list"))
        self.browser.wait("evod.app.areas.map((area) => area.world.name).join() === 'default,other'", "both worlds")

    def test_compare_the_curves_of_two_worlds(self):
        self.control.call(create_world=c.CreateWorld(name="other", seed=2))
        self.browser.wait("evod.server.worlds.names.length === 2", "two worlds")
        self.panel("Plots")
        self.choose("[data-panel=plots] select", "world other")
        self.browser.wait_for_text("other", "[data-panel=plots]")

    def test_see_why_an_organism_was_chosen(self):
        child = self.child()
        self.click_organism(child.id)
        self.browser.wait_for_text(f"Why {child.parents[0]}?", "[data-panel=organism]")  # its code is loaded first
        self.press(f"Why {child.parents[0]}?", "[data-panel=organism]")
        self.browser.wait_for_text(f"in the slot of organism {child.parents[0]}", "[data-panel='glass box']")

    def test_create_a_world_and_run_it(self):
        self.press("New …")
        self.act(self.browser.click, self.browser.wait("""[...document.querySelectorAll("dialog[open] label")]
            .find((e) => e.checkVisibility() && e.innerText.startsWith("brains"))""", "the experiment brains"))
        self.press("Create and run")
        self.control.wait_world(lambda world: len(self.worlds()) == 2, "default")
        self.control.wait_world(lambda world: world.state == w.RUN_STATE_RUNNING, *(self.worlds() - {"default"}))

    def test_fork_now(self):
        self.press("Fork")
        self.browser.wait("evod.server.worlds.names.length === 2", "the fork")
        self.assertEqual(self.worlds(), {"default", "default-2"})

    def test_place_food(self):
        self.press("Food")
        self.click_island(200, 150)
        placed = self.control.next_event("placed").placed
        self.assertEqual(len(placed.food), 1)

    def test_undo_a_placement(self):
        self.press("Food")
        self.click_island(200, 150)
        placed = self.control.next_event("placed").placed
        self.browser.wait("evod.app.world().undo.next_undo === 'placed 1 food'", "the placed food in the history")
        self.act(self.browser.element("body").send_keys, Keys.CONTROL, "z")
        self.assertEqual(list(self.control.next_event("removed").removed.food), list(placed.food))


if __name__ == "__main__":
    signal.signal(signal.SIGTERM, lambda *_: sys.exit(1))  # closes the browser
    unittest.main(argv=[sys.argv[0], *sys.argv[4:]])
