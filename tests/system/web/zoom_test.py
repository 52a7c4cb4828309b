"""The page at high zoom, in a real Chromium: nothing scrolls sideways, and the world stays visible (WCAG 1.4.10)."""
import signal
import sys
import unittest

from page_case import Case, SHOWN_PANELS

SIZES = ((1280, 720), (640, 360), (426, 240), (320, 256))  # CSS pixels at 100, 200, 300 and 400 % zoom
WORLD_LEAST = 120  # CSS pixels
# The elements that scroll sideways, or are wider than the window. A table or a tab list may scroll by itself.
WIDE = """(() => {
  const may_scroll = ".tabs, .glass-table, .family-scroll, .family-tree, pre, canvas, [role=tablist]";
  const root = document.scrollingElement;
  const scrolling = [...document.querySelectorAll(".app, .app *")].filter((e) =>
    e.checkVisibility() && !e.closest(may_scroll) && e.scrollWidth > e.clientWidth + 1 &&
    ["auto", "scroll"].includes(getComputedStyle(e).overflowX));
  return [...(root.scrollWidth > root.clientWidth ? [root] : []), ...scrolling]
    .map((e) => `${e.tagName} ${e.className} ${e.scrollWidth} > ${e.clientWidth}`);
})()"""


class Zoom(Case):
    maxDiff = None

    def tearDown(self):
        self.browser.resize(1280, 720)
        super().tearDown()

    def test_nothing_scrolls_sideways_and_the_world_stays(self):
        browser, served = self.browser, self.start("--speed", "max", island_count=2)
        self.client(served).run_to(250)
        browser.open(self.page(served))
        self.shown_tick(250)
        browser.take_part()
        browser.run("evod.app.world().selection.select(0)")
        for width, height in SIZES:
            browser.resize(width, height)
            wide = {}
            for title in browser.panels():
                browser.panel(title)
                browser.wait(f"{SHOWN_PANELS}.some((panel) => panel.innerText !== '')", title)
                for one in browser.value(WIDE):
                    wide.setdefault(one, title)
            _, _, world_width, world_height = browser.canvas()
            with self.subTest(width=width, height=height):
                self.assertEqual(wide, {})
                self.assertGreaterEqual(world_width, WORLD_LEAST)
                self.assertGreaterEqual(world_height, min(WORLD_LEAST, height / 3))


if __name__ == "__main__":
    signal.signal(signal.SIGTERM, lambda *_: sys.exit(1))  # closes the browser
    unittest.main(argv=[sys.argv[0], *sys.argv[4:]])
