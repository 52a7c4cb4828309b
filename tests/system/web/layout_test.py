"""The layout of the page in a real Chromium, from phones to large screens and zoomed windows: what is visible without
an action, how much room a panel has, and that nothing scrolls sideways."""
import json
import signal
import sys
import unittest

from page_case import Case, c
from browser import Browser
import waiting
from screenshots import PHONE, SIZES, TABLET, TOUCHED, show

LAPTOP = (1366, 768)
PANEL_PX_MIN, WORLD_PX_MIN, TOUCH_PX_MIN = 400, 120, 24
PLACE = """((e) => { if (!e?.checkVisibility()) return null;
           const { left, top, right, bottom } = e.getBoundingClientRect();
           return [left, top, right, bottom].map(Math.round); })(document.querySelector(arguments[0]))"""


class Layout(Case):
    @classmethod
    def setUpClass(cls):
        cls.browser = Browser(introduces=True)

    def setUp(self):
        super().setUp()
        self.served = self.start(generation_s=1.0)
        self.control = self.client(self.served)
        self.control.run_to(330)

    def tearDown(self):
        self.browser.cdp("Emulation.setTouchEmulationEnabled", enabled=False)
        super().tearDown()

    def open(self, size, introduction="seen", theme="dark"):
        browser, url = self.browser, self.page(self.served)
        show(browser, size)
        if not browser.driver.current_url.startswith(url):  # another test's server has another storage
            browser.driver.get(url)
        browser.run("""localStorage.setItem('evod.introduction', arguments[0]);
                       localStorage.setItem('evod.theme', arguments[1]); localStorage.removeItem('evod.panel');""",
                    introduction, theme)
        browser.open(url)
        browser.wait("""evod.app.world().history.is_complete && evod.app.world().parameters.experiment !== '' &&
                        document.querySelector('.healthiest button').textContent !== ''""",
                     "the curve, the sentence and the healthiest")

    def place(self, css):
        return waiting.until(lambda: self.browser.value(PLACE, css), css)

    def in_window(self, css, size):
        left, top, right, bottom = self.place(css)
        self.assertTrue(left >= 0 and top >= 0 and right <= size[0] and bottom <= size[1] and bottom > top,
                        (css, size, (left, top, right, bottom)))

    def overflowing(self):
        """Parts of the page that scroll sideways, except those that are meant to."""
        return self.browser.value("""[document.documentElement, document.body,
            ...document.querySelectorAll(".app, .column, .summary, .panel-body, .pane-area, .introduction")]
            .filter((e) => e.scrollWidth > e.clientWidth + 1 && getComputedStyle(e).overflowX !== "clip")
            .map((e) => `${e.tagName}.${e.className}: ${e.scrollWidth} in ${e.clientWidth}`)""")

    def test_the_first_screen_answers_the_questions(self):
        for size in (PHONE, TABLET, LAPTOP, (1280, 720), (1920, 1080)):
            with self.subTest(size):
                self.open(size)
                self.assertEqual(self.browser.text("[role=tab][aria-selected=true]"), "Overview")
                for css in (".about", ".pane-canvas", ".pane-place", ".pane-state", ".experiment", ".legend",
                            ".run-bar .run", ".run-bar .new", ".part .button", ".healthiest button",
                            ".show-evolution", ".curve"):
                    self.in_window(css, size)
                self.assertLess(self.place(".legend")[3], self.place(".part .button")[1] + 1)
                self.assertLess(self.place(".part .button")[3], self.place(".run-bar .run")[1] + 1)

    def test_nothing_scrolls_sideways(self):
        for size in SIZES:
            for introduction in ("seen", ""):
                with self.subTest(size, introduction=introduction):
                    self.open(size, introduction)
                    self.assertEqual(self.overflowing(), [])
                    left, _, right, _ = self.place(".pane-canvas")
                    self.assertGreaterEqual(right - left, WORLD_PX_MIN)
                    self.browser.panel("Parameters")
                    self.assertEqual(self.overflowing(), [])

    def test_a_panel_has_room_on_a_laptop(self):
        self.open(LAPTOP)
        self.browser.take_part()
        for title in self.browser.panels():
            self.browser.panel(title)
            _, top, _, bottom = self.place(".panel-body")
            self.assertGreaterEqual(bottom - top, PANEL_PX_MIN, title)
            self.assertLessEqual(bottom, LAPTOP[1])
        self.browser.panel("Plots")
        self.browser.wait("document.querySelector('[data-panel=plots] canvas') !== null", "the plot")
        self.in_window("[data-panel=plots] canvas", LAPTOP)

    def test_bodies_with_headings_are_seen(self):
        brains = json.dumps({"controller": "network", "generation_s": 60.0})
        self.control.call(create_world=c.CreateWorld(name="brains", seed=1, experiment_json=brains))
        self.control.call(run_until_tick=c.RunUntilTick(world="brains", tick=1))  # otherwise Start covers some of them
        browser = self.browser
        for size in (PHONE, (320, 256)):
            show(browser, size)
            browser.open(self.page(self.served, "#world=brains"))
            browser.wait("evod.app.world().snapshot?.world === 'brains'", "the world brains")
            browser.run("evod.app.world().set_look({ trails: false, flashes: false })")
            shown = browser.columns()["organisms"]
            _, _, width, height = browser.canvas()
            browser.wait("evod.app.panes.focused.pane.view.shown() !== null", "the camera")
            camera = browser.value("evod.app.panes.focused.pane.view.shown()")
            pixels = browser.pixels().astype(int)
            seen = 0
            for x, y in zip(shown["x"], shown["y"]):
                column = round(width / 2 + (x / 16 - camera["x_px"]) * camera["zoom"])
                row = round(height / 2 + (y / 16 - camera["y_px"]) * camera["zoom"])
                around = pixels[max(row - 3, 0):row + 4, max(column - 3, 0):column + 4]
                # violet: more blue than green, unlike the ground, the lines, food and poison
                seen += int(((around[..., 2] - around[..., 1] > 40) & (around[..., 2] > 120)).sum() >= 9)
            self.assertGreaterEqual(seen, 0.8 * len(shown["x"]), size)

    def test_fingers_have_large_targets(self):
        self.open(PHONE)
        small = self.browser.value("""[...document.querySelectorAll("button, select, input, a[href]")]
            .filter((e) => e.checkVisibility() && !e.closest(".visually-hidden, .skip, label"))
            .map((e) => [e.getAttribute("aria-label") ?? e.textContent, e.getBoundingClientRect()])
            .filter(([, { width, height }]) => Math.min(width, height) < arguments[0])
            .map(([name, { width, height }]) => `${name}: ${width} x ${height}`)""", TOUCH_PX_MIN)
        self.assertEqual(small, [])
        self.assertIn(PHONE, TOUCHED)

    def test_the_introduction_covers_nothing(self):
        browser = self.browser
        for size in SIZES:
            with self.subTest(size):
                self.open(size, "")
                left, top, right, bottom = self.place(".introduction")
                world = self.place(".pane-canvas")
                self.assertTrue(bottom <= world[1] or top >= world[3] or right <= world[0] or left >= world[2], size)
                self.assertEqual(browser.value("document.activeElement === document.body"), True)

    def test_the_introduction_is_shown_once(self):
        browser = self.browser
        self.open(LAPTOP, "")
        browser.wait_for_text("What you see", ".introduction")
        browser.press("Next", ".introduction")
        browser.wait_for_text("What they want", ".introduction")
        browser.press("Next", ".introduction")
        browser.wait_for_text("What you can do", ".introduction")
        browser.press("Done", ".introduction")
        self.assertIsNone(browser.value(PLACE, ".introduction"))
        browser.reload()
        self.assertIsNone(browser.value(PLACE, ".introduction"))
        browser.element("body").send_keys("?")
        browser.wait_for_text("Show the introduction", "dialog[open]")  # its code is loaded first
        browser.press("Show the introduction", "dialog[open]")
        browser.wait_for_text("What you see", ".introduction")
        self.assertEqual(browser.value("document.activeElement.textContent"), "Next")
        browser.driver.switch_to.active_element.send_keys("\ue00c")  # Escape
        self.assertIsNone(browser.value(PLACE, ".introduction"))


if __name__ == "__main__":
    signal.signal(signal.SIGTERM, lambda *_: sys.exit(1))  # closes the browser
    unittest.main(argv=[sys.argv[0], *sys.argv[4:]])
