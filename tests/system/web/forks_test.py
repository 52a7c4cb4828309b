"""Forks in a real Chromium: what bred before a fork began is in the world of its origin, and the page leads there."""
import signal
import sys
import unittest

from page_case import Case, c
from browser import Keys

NOTE = ".origin-note"
BRED = "Generation 3 bred in the world default, before this fork began."


class Forks(Case):
    def setUp(self):
        super().setUp()
        self.served = self.start("--speed", "max")
        self.control = self.client(self.served)
        self.control.run_to(370)  # in the fourth generation
        self.control.call(fork_world=c.ForkWorld(world="default", name="fork"))
        self.browser.open(self.page(self.served, "#world=fork"))
        self.browser.wait("evod.app.world().snapshot?.world === 'fork'", "the fork")
        run_id = self.browser.value("evod.server.worlds.find('default').run_id")
        for fields, code in (({}, "CODE_FAILED_PRECONDITION"), ({"generation": 2}, "CODE_FAILED_PRECONDITION")):
            refusal = self.browser.request("get_breeding", world="fork", **fields)
            self.assertEqual(refusal["code"], code)
            self.assertIn(f"in the run of which it is a fork: {run_id}", refusal["message"])

    def select(self):
        self.browser.run("evod.app.world().selection.select(0)")

    def origin_shown(self):
        self.browser.wait("evod.app.world().name === 'default' && evod.app.world().snapshot?.generation === 3",
                          "generation 3 of the origin")
        self.browser.wait(f"![...document.querySelectorAll('{NOTE}')].some((one) => one.checkVisibility())", "no note")

    def back(self):
        self.browser.run("evod.app.panes.close(evod.app.panes.focused)")

    def test_the_organism_leads_to_its_parents(self):
        browser = self.browser
        browser.panel("Organism")
        self.select()
        browser.wait_for_text(BRED, NOTE)
        parent = browser.value("evod.app.world().selection.info.parents[0]")
        self.assertNotIn("No generation", browser.text(".column"))
        browser.press("Open it in default", NOTE)
        browser.wait("evod.app.world().selection.id === arguments[0]", "the parent", parent)
        self.origin_shown()

    def test_the_glass_box_leads_to_the_breeding(self):
        browser = self.browser
        browser.panel("Glass box")
        browser.wait_for_text(BRED, NOTE)
        browser.press("Open it in default", NOTE)
        self.origin_shown()
        browser.wait_for_text("World default, generation 3", ".glass-box")

    def test_the_family_tree_leads_to_earlier_ancestors(self):
        browser = self.browser
        browser.panel("Family tree")
        self.select()
        browser.wait_for_text(BRED, NOTE)
        browser.press("Open it in default", NOTE)
        self.origin_shown()

    def test_the_curve_shows_the_first_generation_of_the_run(self):
        browser = self.browser
        browser.panel("Overview")
        browser.element(".overview .plot-area").send_keys(Keys.HOME, Keys.ENTER)
        browser.wait("evod.app.world().is_replay && evod.app.world().snapshot?.generation === 4", "the replay")
        browser.wait_for_text("can be shown from generation 4 on", ".notices")

    def test_a_later_generation_knows_its_own_picks(self):
        browser = self.browser
        self.control.call(run_until_tick=c.RunUntilTick(world="fork", tick=500))  # in the fifth generation
        browser.wait("evod.app.world().snapshot?.tick === 500", "tick 500")
        browser.run("void evod.app.attempt(() => evod.app.world().past.show_nearest({ generation: 4 }))")
        browser.wait("evod.app.world().is_replay && evod.app.world().snapshot?.generation === 4", "the replay")
        browser.panel("Organism")
        self.select()
        browser.wait_for_text(BRED, NOTE)
        browser.wait_for_text("It was picked", ".organism")  # the breeding of its own generation

    def test_a_deleted_origin_is_said(self):
        browser = self.browser
        self.control.call(delete_world=c.DeleteWorld(world="default"))
        browser.wait("evod.server.worlds.find('default') === null", "no origin")
        browser.panel("Glass box")
        browser.wait_for_text("Generation 3 bred before this fork began, in a run "
                              "that no world of this server has now.",
                              NOTE)


if __name__ == "__main__":
    signal.signal(signal.SIGTERM, lambda *_: sys.exit(1))  # closes the browser
    unittest.main(argv=[sys.argv[0], *sys.argv[4:]])
