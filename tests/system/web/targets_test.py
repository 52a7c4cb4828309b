"""Everything that a finger can press in the page is large enough, in every panel and at every size, and every table,
landmark and canvas has a name."""
import signal
import sys
import unittest

from page_case import Case, SHOWN_PANELS

SIZES = ((1280, 720), (820, 1180), (390, 844), (640, 360))  # CSS pixels: laptop, tablet, phone, laptop at 200 %
LEAST = 24  # CSS pixels, WCAG 2.5.8

# What is smaller than LEAST. A control in a label is as large as the label; a link within a sentence may be smaller.
SMALL = """(() => {
  const all = "a[href], button, input, select, textarea, summary, [role=button], [role=tab], [role=slider], [onclick]";
  const targets = [...document.querySelectorAll(all)]
    .filter((e) => !e.disabled && e.type !== "file")
    .filter((e) => e.checkVisibility({ checkVisibilityCSS: true, opacityProperty: true }));
  return targets.flatMap((e) => {
    const { width, height } = (e.closest("label") ?? e).getBoundingClientRect();
    const inline = e.matches("a") && e.closest("p") !== null;
    const hidden = width <= 1 || height <= 1 || e.classList.contains("skip");
    return inline || hidden || (width >= arguments[0] - 0.01 && height >= arguments[0] - 0.01) ? []
      : [`${e.tagName} ${e.className} “${e.getAttribute("aria-label") ?? e.textContent.slice(0, 20)}” ` +
         `${width.toFixed(1)} x ${height.toFixed(1)}`];
  });
})()"""


class Targets(Case):
    maxDiff = None

    def setUp(self):
        super().setUp()
        self.served = self.start("--speed", "max", island_count=2, migration="ring", migration_epoch=1)
        self.control = self.client(self.served)
        self.control.run_to(370)  # in the fourth generation
        self.browser.open(self.page(self.served))
        self.shown_tick(370)
        self.browser.take_part()
        self.browser.run("evod.app.world().selection.select(0)")

    def tearDown(self):
        self.browser.resize(1280, 720)
        super().tearDown()

    def panels(self):
        """Opens each panel."""
        for title in self.browser.panels():
            self.browser.panel(title)
            self.browser.wait(f"{SHOWN_PANELS}.some((panel) => panel.innerText !== '')", title)
            yield title
            # Whatever the panel folds away.
            self.browser.run(f"{SHOWN_PANELS}.forEach((panel) => panel.querySelectorAll('details')"
                             ".forEach((details) => details.open = true))")
            yield f"{title}, opened"

    def test_targets_are_large_enough(self):
        for width, height in SIZES:
            self.browser.resize(width, height)
            small = {}
            for title in self.panels():
                for one in self.browser.value(SMALL, LEAST):
                    small.setdefault(one, title)
            with self.subTest(width=width, height=height):
                self.assertEqual(small, {})

    def test_tables_landmarks_and_canvases_have_names(self):
        browser = self.browser
        browser.cdp("Accessibility.enable")
        roles = {"table", "grid", "Canvas", "main", "complementary", "region", "navigation", "form", "image"}
        nameless = {}
        for title in self.panels():
            for node in browser.cdp("Accessibility.getFullAXTree")["nodes"]:
                name = node.get("name", {}).get("value", "").strip()
                if not node["ignored"] and node["role"]["value"] in roles and not name:
                    html = browser.cdp("DOM.getOuterHTML", backendNodeId=node["backendDOMNodeId"])["outerHTML"][:100]
                    nameless.setdefault(html, title)
        browser.cdp("Accessibility.disable")
        self.assertEqual(nameless, {})


if __name__ == "__main__":
    signal.signal(signal.SIGTERM, lambda *_: sys.exit(1))  # closes the browser
    unittest.main(argv=[sys.argv[0], *sys.argv[4:]])
