"""The time line of a long run in a real Chromium: zoom, names of marks, keys."""
import signal
import sys
import unittest

from page_case import Case, c, plain, w
from browser import Keys

GENERATIONS = 500
LINE = "document.querySelector('.time-line')"


class Timeline(Case):
    def setUp(self):
        super().setUp()
        self.served = self.start(generation_s=0.1, population_size=4)
        self.control = self.client(self.served)
        self.control.call(set_speed=c.SetSpeed(world="default", speed=w.Speed(max=True)))
        self.control.run_to(6 * 100 + 3)
        self.control.call(set_parameters=plain.set_parameters("default", mutation_chance=0.25))
        self.control.run_to(6 * (GENERATIONS - 1) + 3)
        self.browser.open(self.page(self.served))
        self.browser.wait("evod.app.world().history.generations.length >= arguments[0]", "the history",
                          GENERATIONS - 1)
        self.browser.wait("document.querySelectorAll('.time-labels span').length > 2", "labels")

    def place(self):
        return self.browser.value(f"(({{ left, top, width, height }}) => [left, top, width, height])("
                                  f"{LINE}.getBoundingClientRect())")

    def wheel(self, part, delta_y, **more):
        left, top, width, height = self.place()
        self.browser.cdp("Input.dispatchMouseEvent", type="mouseWheel", x=left + part * width, y=top + height / 2,
                         deltaX=more.get("delta_x", 0), deltaY=delta_y)

    def labels(self):
        return self.browser.value("""[...document.querySelectorAll(".time-labels span")]
                                     .map((e) => Number(e.textContent.replace(",", "")))""")

    def test_a_single_generation_can_be_clicked(self):
        browser = self.browser
        for _ in range(30):
            self.wheel(0.5, -300)
        browser.wait("document.querySelectorAll('.time-labels span').length > 0 && " + LINE + ".dataset.zoomed === ''",
                     "a zoomed line")
        browser.wait("[...document.querySelectorAll('.time-labels span')].every((e) => Math.abs(Number(e.textContent) "
                     "- 250) < 3)", "the middle of the run")
        place = browser.wait("(([e]) => e && [e.textContent, e.getBoundingClientRect().left])("
                             "document.querySelectorAll('.time-labels span'))", "a label")
        _, top, width, height = self.place()
        browser.click_at(place[1] + 8, top + height / 2)
        browser.wait("evod.app.world().snapshot?.generation === arguments[0]", f"generation {place[0]}", int(place[0]))
        browser.press("Show all generations", ".timeline")
        browser.wait("Math.max(...[...document.querySelectorAll('.time-labels span')].map((e) => "
                     "Number(e.textContent))) >= 400", "the whole run")

    def test_the_line_moves_and_zooms_by_buttons_and_keys(self):
        browser, line = self.browser, self.browser.element(".time-line")
        browser.press("Zoom in", ".timeline")
        browser.wait(f"{LINE}.dataset.zoomed === ''", "a zoomed line")
        browser.wait("!document.querySelector('.time-labels').innerText.split('\\n').includes('100')", "the end")
        self.wheel(0.5, 0, delta_x=-2000)
        browser.wait("document.querySelector('.time-labels').innerText.split('\\n').includes('100')", "the beginning")
        line.send_keys("0")
        browser.wait(f"{LINE}.dataset.zoomed === undefined", "the whole run")
        line.send_keys("+++")
        browser.wait(f"{LINE}.getAttribute('aria-valuetext').includes('the line shows the generations')", "the words")
        line.send_keys(Keys.HOME)
        browser.wait("evod.app.world().snapshot?.generation === 1", "generation 1")

    def test_marks_have_names(self):
        browser = self.browser
        browser.wait_for_text("mutation_chance", ".time-name")
        line = browser.element(".time-line")
        line.send_keys(Keys.CONTROL, Keys.ARROW_LEFT)
        browser.wait("evod.app.world().snapshot?.generation === 101", "the generation of the change")
        browser.wait(f"{LINE}.getAttribute('aria-valuetext').includes('mutation_chance')", "the name for readers")
        browser.wait_for_text("mutation_chance", ".time-bubble")
        browser.press("Live", ".timeline")
        self.control.call(place=c.Place(world="default", items=[c.PlacedItem(kind=c.ITEM_KIND_FOOD, x_px=50, y_px=50)]))
        browser.wait("document.querySelector('.time-marks [data-kind=placed]') !== null", "the mark of what was placed")


if __name__ == "__main__":
    signal.signal(signal.SIGTERM, lambda *_: sys.exit(1))  # closes the browser
    unittest.main(argv=[sys.argv[0], *sys.argv[4:]])
