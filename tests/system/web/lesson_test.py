"""The lesson of docs/TUTORIAL_TEACHER.md in the page: what a teacher does there has the results that the document
states. tests/docs runs the commands of the document."""
import pathlib
import re
import signal
import sys
import unittest

from selenium.webdriver.support.ui import Select

HERE = pathlib.Path(__file__).resolve().parent
sys.path[:0] = [str(HERE), str(HERE.parent)]

from page_case import Case, c, w  # noqa: E402

ROOT = HERE.parents[2]
DOCUMENT = (ROOT / "docs/TUTORIAL_TEACHER.md").read_text()


def row_of(start):
    """The cells of the document's table row with this start, for the organisms 43 and 9."""
    return [cell.strip() for cell in re.search(rf"^\| \*{start}.*?\| (.*) \|$", DOCUMENT, re.M)[1].split("|")]


class Lesson(Case):
    def setUp(self):
        super().setUp()
        self.served = self.serve("--experiment", str(ROOT / "experiments/default.json"), "--seed", "7")
        self.control = self.client(self.served)
        self.control.call(subscribe_events=c.SubscribeEvents())

    def run_to_generation(self, generation, world="default"):
        """Runs a world to the end of a generation at the maximum speed."""
        self.control.call(set_speed=c.SetSpeed(world=world, speed=w.Speed(max=True)))
        info = self.control.wait_world(lambda _: True, world)
        self.control.call(run=c.Run(world=world, generations=generation - info.generation + (info.tick == 0)))
        self.control.wait_world(lambda info: info.generation == generation and info.state == w.RUN_STATE_WAITING, world)

    def check_organisms(self, world, picked, offspring):
        """Compares the panel with the document, in the links of the document."""
        for organism, picks, children in zip((43, 9), picked, offspring):
            link = f"#world=default&generation=1&tick=600&organism={organism}"
            self.assertIn(link, DOCUMENT)
            self.browser.open(self.page(self.served, link.replace("default", world)))
            if picks is not None:
                self.browser.wait_for_text(f"It was picked {picks}.", "[data-panel=organism]")
            self.browser.wait_for_text(f"Offspring in generation 2: {children}", "[data-panel=organism]")

    def test_the_first_generation(self):
        browser = self.browser
        browser.open(self.page(self.served))
        browser.take_part()
        for _ in range(4):
            browser.element("body").send_keys("+")
        self.control.wait_world(lambda world: world.speed.real_time_factor == 16, "default")
        browser.press("One generation")
        best, mean = re.search(r"\*best (\S+)\* and \*mean (\S+)\*", DOCUMENT).groups()
        for text in (f"best{best}", f"mean{mean}"):
            browser.wait("document.querySelector('.column').textContent.replace(/\\s/g, '').includes(arguments[0])",
                         text, text)

    def test_the_sliders(self):
        browser = self.browser
        browser.open(self.page(self.served))
        browser.take_part()
        browser.panel("Parameters")
        browser.type_into(browser.element("[data-panel=parameters] input[type=search]"), "poison count")
        browser.wait("""[...document.querySelectorAll("input.parameter-slider[data-parameter=poison_count]:enabled")]
            .some((e) => e.checkVisibility())""", "the slider")

    def test_the_picks_of_a_generation(self):
        self.run_to_generation(3)
        self.check_organisms("default", row_of("It was picked"),
                             [text.split(":")[0] for text in row_of("Offspring in generation 2")])
        browser = self.browser
        browser.panel("Glass box")
        browser.wait_for_text("Play the 25 picks")
        browser.type_into(browser.element(".glass-generation"), "2")
        browser.wait_for_text("generation 2:", ".glass-box")
        browser.click(browser.value("""[...document.querySelectorAll(".glass-box label")]
            .find((e) => e.innerText.includes("bet first"))"""))
        browser.wait("""[...document.querySelectorAll(".glass-box button")]
            .find((e) => /^organism \\d+: rank 1,/.test(e.title || e.getAttribute("aria-label")))""",
                     "the fittest").click()
        browser.press("Close the bets and play the 25 picks")
        browser.wait_for_text("hit your 1 bet", ".glass-box")

    def test_a_world_without_luck(self):
        browser = self.browser
        browser.open(self.page(self.served))
        browser.take_part()
        browser.press("New …")
        dialog = "document.querySelector('dialog[open]')"
        browser.click(browser.wait(f"""[...{dialog}.querySelectorAll("label")]
            .find((e) => e.checkVisibility() && e.innerText.startsWith("default"))""", "the experiment default"))
        for field, text in (("name", "truncation"), ("seed", "7")):
            labelled = browser.value(f"""[...{dialog}.querySelectorAll("label")]
                .find((e) => e.checkVisibility() && e.innerText.trim() === arguments[0]).control""", field)
            labelled.clear()
            labelled.send_keys(text)
        browser.press("Create", "dialog[open]")
        self.control.wait_world(lambda world: world.seed == 7, "truncation")
        browser.wait("evod.app.world().name === 'truncation'", "the new world")
        browser.panel("Parameters")
        Select(browser.wait("document.querySelector('select[data-parameter=selection]:enabled')", "the list")
               ).select_by_value("truncation")
        browser.press("Apply")
        browser.wait_for_text("no edits", "[data-panel=parameters]")
        self.run_to_generation(2, "truncation")
        offspring = re.search(r"now both have (\d+) offspring", DOCUMENT)[1]
        self.check_organisms("truncation", [None, None], [offspring, offspring])


if __name__ == "__main__":
    signal.signal(signal.SIGTERM, lambda *_: sys.exit(1))  # closes the browser
    unittest.main(argv=[sys.argv[0], *sys.argv[4:]])
