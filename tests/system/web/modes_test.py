"""Modes of the page in a real Chromium: after entering and leaving one, the camera, the selection
and the world are the same."""
import signal
import sys
import unittest

from page_case import Case, c
from browser import Keys

STATE = """(() => {
  const { panes } = evod.app, world = evod.app.world(), { selection } = world;
  return { camera: panes.focused.pane.view.camera, selected: selection.id, follow: selection.follow, world: world.shown,
           island: world.island, tool: panes.focused.pane.tool.tool, panes: panes.all.length,
           tiles: panes.focused.pane.tiles.is_on, look: world.look };
})()"""


class Modes(Case):
    def setUp(self):
        super().setUp()
        self.served = self.start("--speed", "max", island_count=2)
        self.control = self.client(self.served)
        self.control.run_to(130)  # in the second generation
        self.control.call(create_world=c.CreateWorld(name="other", seed=2))
        self.browser.open(self.page(self.served))
        self.shown_tick(130)
        self.browser.take_part()

    def key(self, *keys):
        self.browser.run("document.activeElement.blur()")
        self.browser.element("body").send_keys(*keys)

    def replay(self):
        self.key("p")
        self.browser.wait("evod.app.world().is_replay && evod.app.world().snapshot !== null", "a replay")

    def live(self):
        self.key("p")
        self.browser.wait("!evod.app.world().is_replay && evod.app.world().snapshot !== null", "the live world")

    def earlier(self):
        self.replay()
        self.browser.run("void evod.app.world().past.show(1)")
        self.browser.wait("evod.app.world().snapshot?.generation === 1", "the first generation")

    def tool(self, name):
        def choose():
            if self.browser.value("evod.app.world().selection.id !== null"):
                self.browser.press(name, ".tools")  # as soon as it can act
            else:
                self.browser.click(self.browser.button(name, ".tools"))
        return choose

    def escape(self):
        self.key(Keys.ESCAPE)

    def test_leaving_a_mode_restores_the_view(self):
        browser = self.browser
        panel = browser.panel
        zoomed = {"x_px": 300, "y_px": 200, "zoom": 4}
        for name, enter, leave in (
                ("follow", lambda: self.key("l"), lambda: self.key("l")),
                ("replay", self.replay, self.live),
                ("replay of an earlier generation", self.earlier, self.live),
                ("follow within a replay", lambda: (self.replay(), self.key("l")),
                 lambda: (self.key("l"), self.live())),
                ("tiles", lambda: self.key("i"), lambda: self.key("i")),
                ("organism panel", lambda: panel("Organism"), lambda: panel("Worlds")),
                ("glass box", lambda: panel("Glass box"), lambda: panel("Worlds")),
                ("family tree", lambda: panel("Family tree"), lambda: panel("Worlds")),
                ("placing food", self.tool("Food"), self.escape),
                ("placing an organism", self.tool("Organism"), self.escape),
                ("removing", self.tool("Remove"), self.escape),
                ("help", lambda: self.key("?"), lambda: browser.driver.switch_to.active_element.send_keys(Keys.ESCAPE)),
                ("column", lambda: self.key("d"), lambda: self.key("d")),
                ("second world", lambda: browser.run("evod.app.panes.show_second('other')"), lambda: self.key("b")),
                ("trails", lambda: self.key("t"), lambda: self.key("t"))):
            for camera in (None, zoomed):
                for selected in (None, 3):
                    with self.subTest(name, camera=camera, selected=selected):
                        browser.run("evod.app.panes.focused.pane.view.set(arguments[0])", camera)
                        browser.run("evod.app.world().selection.select(arguments[0])", selected)
                        browser.wait("arguments[0] === null || evod.app.world().selection.info", "its genes", selected)
                        browser.run(f"globalThis.before = JSON.stringify({STATE})")
                        enter()
                        browser.value("new Promise(requestAnimationFrame)")
                        leave()
                        browser.wait(f"JSON.stringify({STATE}) === before", "what was shown before")


if __name__ == "__main__":
    signal.signal(signal.SIGTERM, lambda *_: sys.exit(1))  # closes the browser
    unittest.main(argv=[sys.argv[0], *sys.argv[4:]])
