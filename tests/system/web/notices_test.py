"""Notices that state a condition, in a real Chromium: each disappears when its condition ends."""
import signal
import sys
import unittest

from page_case import Case, c, w
from browser import Keys

PANEL = ".panel-freezer"
CLOSE = "[...document.querySelectorAll('.notice')].find((one) => one.textContent.includes(arguments[0]))"


class Notices(Case):
    def setUp(self):
        super().setUp()
        self.served = self.start("--speed", "max")
        self.control = self.client(self.served)
        self.control.run_to(130)
        two = [w.ParameterAssignment(name="island_count", value=w.ParameterValue(count=2))]
        self.control.call(create_world=c.CreateWorld(name="islands", seed=1, parameters=two))
        self.browser.open(self.page(self.served))
        self.shown_tick(130)

    def key(self, keys):
        self.browser.run("document.activeElement.blur()")
        self.browser.element("body").send_keys(keys)

    def shown(self, world):
        self.browser.run("evod.app.world().show(arguments[0])", world)
        self.browser.wait("evod.app.world().snapshot?.world === arguments[0]", world, world)

    def replay(self):
        self.browser.press("Replay")
        self.browser.wait("evod.app.world().past.is_own_replay && evod.app.world().snapshot !== null", "a replay")

    def live(self):
        self.browser.press("Live")
        self.browser.wait("!evod.app.world().is_replay && evod.app.world().snapshot !== null", "the live world")

    def replay_at_its_end(self):
        self.replay()
        self.browser.run("void evod.app.world().past.show_moment({})")
        self.browser.wait("evod.app.world().control.at_end", "the end of the replay")

    def freezer(self):
        self.browser.take_part()
        self.browser.panel("Freezer")
        self.browser.wait_for_text("Keeps organisms", PANEL)
        self.browser.press("Healthiest", PANEL)
        self.browser.wait("document.querySelector('.freezer-entry h3')?.checkVisibility()", "the kept organism")
        self.browser.press("Place by clicks", PANEL)

    def lose_the_server(self):
        self.browser.take_part()
        self.served.kill()
        self.browser.wait("evod.server.state.phase !== 'open'", "no connection")
        self.key(Keys.SPACE)

    def find_the_server(self):
        self.served = self.server("--data", self.folder, "--http-port", str(self.served.http_port))
        self.browser.wait("evod.server.state.phase === 'open'", "a session")
        self.browser.take_part(False)

    def close_other(self):
        self.browser.run("evod.app.panes.close(evod.app.panes.other)")

    def test_a_notice_ends_with_its_condition(self):
        browser = self.browser
        watching = "You are watching."
        for name, begin, text, end, restore in (
                ("key", lambda: self.key(Keys.SPACE), watching, browser.take_part, lambda: browser.take_part(False)),
                ("button", lambda: browser.click(browser.element(".run")), watching, browser.take_part,
                 lambda: browser.take_part(False)),
                ("undo", lambda: self.key(Keys.CONTROL + "z"), watching, browser.take_part,
                 lambda: browser.take_part(False)),
                ("live", lambda: self.key("["), "The world is live", self.replay, self.live),
                ("replay button", lambda: (self.replay(), browser.click("Fork")), watching,
                 browser.take_part, lambda: (browser.take_part(False), self.live())),
                ("end of the replay", lambda: (self.replay_at_its_end(), self.key(Keys.SPACE)), "the end of the replay",
                 self.live, lambda: None),
                ("one world", lambda: self.key("k"), "Only one world is shown",
                 lambda: browser.run("evod.app.show_beside('islands')"), self.close_other),
                ("linked", lambda: (browser.run("evod.app.show_beside('islands')"), self.key("k")), "Both worlds move",
                 self.close_other, lambda: None),
                ("one island", lambda: (self.shown("default"), self.key("i")), "only one island",
                 lambda: self.shown("islands"), lambda: self.shown("default")),
                ("colour", lambda: self.key("c"), "Colour: health", lambda: self.key("c"), lambda: None),
                ("placing", self.freezer, "Click in the island to place", lambda: self.key(Keys.ESCAPE),
                 lambda: browser.take_part(False)),
                ("no connection", self.lose_the_server, "There is no connection", self.find_the_server, lambda: None)):
            with self.subTest(name):
                begin()
                browser.wait_for_text(text, ".notices")
                # A notice under the pointer does not expire.
                browser.run(f"{CLOSE}.matches = () => true", text)
                end()
                browser.wait(f"{CLOSE} === undefined", f"no notice {text!r}", text)
                restore()


    def test_a_refusal_stays_until_the_next_action(self):
        browser = self.browser
        browser.run("""const { setTimeout } = globalThis;  // messages that expire after some seconds do so at once
            globalThis.setTimeout = (act, ms) => ms >= 6000 ? act() : setTimeout(act, ms);""")
        refused = "void evod.app.attempt(() => evod.server.request('pause', { world: arguments[0] }))"
        browser.run("evod.app.notify('expires')")
        browser.run(refused, "nowhere")
        browser.wait_for_text("nowhere", ".notices")
        self.assertNotIn("expires", browser.text(".notices"))
        browser.run("void evod.app.attempt(async () => undefined)")
        browser.wait("document.querySelector('.notice') === null", "no refusal after the next action")


if __name__ == "__main__":
    signal.signal(signal.SIGTERM, lambda *_: sys.exit(1))  # closes the browser
    unittest.main(argv=[sys.argv[0], *sys.argv[4:]])
