"""The past of a world in a real Chromium: links to moments, typed generations, and forks of the past."""
import signal
import sys
import unittest

from page_case import Case, c, w
from browser import Keys


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
        browser.wait("evod.app.areas.length === 2", "two worlds")
        fork = self.control.world("default-2")
        self.assertEqual((fork.generation, fork.generation_tick, fork.state_hash), (3, 60, self.over_tcp(3, 60)))
        browser.wait("evod.app.areas.every((area) => area.world.snapshot?.state_hash === arguments[0])",
                     "both at the same state", fork.state_hash)
        self.assertEqual(browser.value("evod.app.areas.map((area) => area.world.name)"), ["default", "default-2"])


if __name__ == "__main__":
    signal.signal(signal.SIGTERM, lambda *_: sys.exit(1))  # closes the browser
    unittest.main(argv=[sys.argv[0], *sys.argv[4:]])
