"""All islands of a world as tiles, and two worlds whose views are linked, in a real Chromium."""
import pathlib
import signal
import sys
import unittest

HERE = pathlib.Path(__file__).resolve().parent
sys.path[:0] = [str(HERE), str(HERE.parent)]

from browser import Keys  # noqa: E402
from page_case import Case, c, w  # noqa: E402

ISLANDS = 6
TILES = "[...document.querySelectorAll('.island-tile')]"
SHOWN = "evod.app.areas.map(({ pane, world }) => `${world.snapshot?.world} ${pane.view.island?.width}`).join()"
VIEWS = "evod.app.areas.map((area) => area.pane.view.camera)"


class Islands(Case):
    def test_all_islands_are_tiles(self):
        server = self.start(island_count=ISLANDS)
        control, browser = self.client(server), self.browser
        control.run_to(150)  # in the second generation
        browser.open(self.page(server))
        whole = browser.pixels()
        browser.element("body").send_keys("i")  # the focus goes to the chosen island
        browser.wait("document.querySelectorAll('.island-tile').length === arguments[0]", "all tiles", ISLANDS)
        browser.wait(f"{TILES}.every((tile) => tile.ariaLabel.includes('generation 2'))", "all islands in generation 2")
        self.assertEqual(browser.value("document.querySelectorAll('.pane-area canvas.pane-canvas').length"), 1)
        shown = browser.pixels()
        self.assertTrue((whole != shown).any())
        left, top, _, _ = browser.canvas()
        for island in range(ISLANDS):  # each tile shows organisms
            x, y, width, height = browser.value(
                """(({ left, top, width, height }) => [left, top, width, height])(
                    document.querySelectorAll(".island-tile")[arguments[0]].getBoundingClientRect())""", island)
            x, y = x - left, y - top
            place = shown[round(y) + 25:round(y + height) - 5, round(x) + 5:round(x + width) - 5]
            self.assertGreater(len({tuple(pixel) for row in place for pixel in row}), 20, island)

        keys = browser.driver.switch_to.active_element  # the tile of island 0
        keys.send_keys(Keys.ARROW_RIGHT)
        browser.wait("evod.app.world().island === 1", "island 1")
        browser.driver.switch_to.active_element.send_keys(Keys.ENTER)
        browser.wait("document.querySelectorAll('.island-tile').length === 0", "only one island")
        browser.wait("evod.app.world().snapshot?.island === 1", "island 1 alone")
        browser.driver.switch_to.active_element.send_keys(Keys.ESCAPE)
        browser.wait("document.activeElement.ariaLabel?.startsWith('Island 1:')", "the tile of island 1")
        browser.press("All islands")
        browser.wait("document.querySelectorAll('.island-tile').length === 0", "only one island")
        browser.press("All islands")
        browser.wait(f"{TILES}.length > 0 && document.activeElement.ariaLabel === 'All islands'", "the button's focus")
        browser.click(browser.element(f".island-tile:nth-child({ISLANDS})"))
        browser.wait("evod.app.world().snapshot?.island === arguments[0]", "the last island", ISLANDS - 1)

    def test_two_worlds_move_together(self):
        server = self.start()
        control, browser = self.client(server), self.browser
        same = {"island_width_px": 720.0, "island_height_px": 450.0}
        for name, factor in (("same", 1), ("wide", 2)):
            parameters = [w.ParameterAssignment(name=key, value=w.ParameterValue(real=factor * size))
                          for key, size in same.items()]
            control.call(create_world=c.CreateWorld(name=name, seed=1, parameters=parameters))
        browser.open(self.page(server))
        browser.run("evod.app.show_beside('same')")
        browser.wait(f"{SHOWN} === 'default 720,same 720'", "two worlds")
        browser.element("body").send_keys("z")
        browser.wait(f"({VIEWS}).every((camera) => camera !== null)", "both zoomed")
        one, other = browser.value(VIEWS)
        self.assertEqual(one, other)

        browser.run("evod.app.show_beside('wide')")  # in place of the first one
        browser.wait(f"{SHOWN} === 'wide 1440,same 720'", "a wider world")
        browser.element("body").send_keys("zz")  # the other one is zoomed once
        browser.wait(f"({VIEWS})[0] !== null && ({VIEWS})[0].zoom !== ({VIEWS})[1].zoom / 2",
                     "only the wider one zoomed")
        browser.press("Link the views")
        wide, small = browser.value(VIEWS)
        self.assertAlmostEqual(wide["zoom"], small["zoom"] / 2)
        self.assertAlmostEqual(wide["x_px"], 2 * small["x_px"])


if __name__ == "__main__":
    signal.signal(signal.SIGTERM, lambda *_: sys.exit(1))  # closes the browser
    unittest.main(argv=[sys.argv[0], *sys.argv[4:]])
