"""The page without a mouse, in a real Chromium: the keyboard, names and contrasts for screen readers, and taps."""
import pathlib
import signal
import sys
import unittest

import numpy

from page_case import Case, SHOWN_PANELS, w
import contrast
from browser import Keys

PAGE = pathlib.Path(__file__).resolve().parents[3] / "client" / "web"


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
        browser.element(".part .button").send_keys(Keys.SPACE)
        browser.wait("evod.server.access.taking_part && !document.querySelector('.run-bar .run').ariaDisabled",
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


if __name__ == "__main__":
    signal.signal(signal.SIGTERM, lambda *_: sys.exit(1))  # closes the browser
    unittest.main(argv=[sys.argv[0], *sys.argv[4:]])
