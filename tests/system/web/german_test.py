"""The page in German, in a real Chromium that prefers German: introduction, parameters, refusals, events, and the
choice of the language."""
import signal
import sys
import unittest

from selenium.webdriver.support.ui import Select

from page_case import Case, SHOWN_PANELS, c
from browser import Browser, Keys
from layout_test import Layout
from screenshots import PHONE, show

FIELD = "[data-parameter=mutation_chance][type=text]"
WORLD = "evod.app.world().name === arguments[0] && evod.app.world().snapshot !== null"


class German(Case):
    @classmethod
    def setUpClass(cls):
        cls.browser = Browser("--lang=de-DE", "--accept-lang=de-DE,de", introduces=True)

    def setUp(self):
        super().setUp()
        self.served = self.start(generation_s=1.0)
        self.control = self.client(self.served)
        self.control.call(create_world=c.CreateWorld(name="zweite", seed=1))
        self.control.run_to(130)
        self.browser.open(self.page(self.served))
        self.shown_tick(130)

    def tearDown(self):
        self.browser.cdp("Emulation.setTouchEmulationEnabled", enabled=False)
        super().tearDown()

    def choose(self, css, value):
        self.browser.wait("document.querySelector(arguments[0])?.checkVisibility()", css, css)
        Select(self.browser.element(css)).select_by_value(value)

    def type_chance(self, text):
        field = self.browser.wait("""[...document.querySelectorAll(arguments[0])].find((e) =>
            e.checkVisibility() && !e.disabled)""", "the field of mutation_chance", FIELD)
        self.browser.type_into(field, text)

    def test_a_new_visitor_reads_german(self):
        browser = self.browser
        self.assertEqual(browser.value("document.documentElement.lang"), "de")
        browser.wait_for_text("Was zu sehen ist", ".introduction")
        browser.press("Weiter")
        browser.press("Weiter")
        browser.press("Fertig")
        browser.wait_for_text("30 Organismen suchen Futter (+25 Gesundheit)", ".experiment")
        scripts = [url.rpartition("/")[0] for url in browser.requested() if url.endswith(".js")]
        self.assertEqual(set(scripts), {self.page(self.served)[:-1], self.page(self.served) + "de"})  # and language.js

    def test_parameters_refusals_and_events_are_german(self):
        browser = self.browser
        browser.take_part()
        browser.panel("Parameter")
        browser.wait_for_text("Mutationsrate", "[data-name=mutation_chance]")
        self.type_chance("1,5")
        browser.wait_for_text("1,5 ist nicht möglich, erlaubt: 0 bis 1", ".parameter-refused")
        self.type_chance("0,25")
        browser.press("Anwenden")
        browser.wait_for_text("1 Änderung ab Tick", ".notices")
        self.assertEqual(self.value_of(self.control, "mutation_chance"), 0.25)
        browser.panel("Ereignisse")
        browser.wait_for_text("Mutationsrate auf 0,25", "[data-panel=events]")
        browser.run("void evod.app.attempt(() => evod.server.request('delete_world', { world: 'dritte' }))")
        browser.wait_for_text("Diese Welt gibt es nicht", ".notices")

    def test_a_change_of_language_keeps_the_world(self):
        browser = self.browser
        browser.run("evod.app.world().show('zweite')")
        browser.wait(WORLD, "the second world", "zweite")
        browser.panel("Ansicht")
        self.choose("#view-language", "en")
        browser.wait_for_text("Overview", ".column")
        browser.wait(WORLD, "the second world", "zweite")
        self.assertEqual(browser.value("document.documentElement.lang"), "en")
        browser.panel("View")
        self.choose("#view-language", "")
        browser.wait_for_text("Übersicht", ".column")
        browser.wait(WORLD, "the second world", "zweite")

    def test_no_panel_scrolls_sideways(self):
        browser = self.browser
        browser.take_part()
        for size in (PHONE, (1280, 720)):
            show(browser, size)
            for title in browser.panels():
                with self.subTest(size=size, panel=title):
                    browser.panel(title)
                    browser.wait(f"{SHOWN_PANELS}.some((panel) => panel.innerText !== '')", title)
                    self.assertEqual(Layout.overflowing(self), [])

    def test_the_console_stays_empty(self):
        browser = self.browser
        for title in browser.panels():
            browser.panel(title)
            browser.wait(f"{SHOWN_PANELS}.some((panel) => panel.innerText !== '')", title)
        browser.element("body").send_keys(Keys.ESCAPE)
        self.assertEqual([text for level, text in browser.log() if level == "SEVERE" or "Content Security" in text], [])


if __name__ == "__main__":
    signal.signal(signal.SIGTERM, lambda *_: sys.exit(1))  # closes the browser
    unittest.main(argv=[sys.argv[0], *sys.argv[4:]])
