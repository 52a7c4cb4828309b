"""Lessons in the page. Lesson: what a teacher does by docs/TUTORIAL_TEACHER.md has the results that the document
states; tests/docs runs the commands of the document. Lessons, GermanLessons: the panel "Lesson" plays lesson files."""
import json
import pathlib
import re
import signal
import sys
import unittest

from selenium.webdriver.support.ui import Select

HERE = pathlib.Path(__file__).resolve().parent
sys.path[:0] = [str(HERE), str(HERE.parent)]

from browser import Browser  # noqa: E402
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


PANEL = "[data-panel=lesson]"
GIVE, RUN_HEADING, NEXT = "That is my prediction", "What happened", "Next ›"


class PlayedCase(Case):
    """Plays a lesson: gives the expected predictions, and runs."""

    def setUp(self):
        super().setUp()
        self.served = self.start()
        self.control = self.client(self.served)

    def visible(self, css):
        return self.browser.wait(f"""[...document.querySelectorAll("{PANEL} {css}")]
            .find((e) => e.checkVisibility() && !e.matches(":disabled"))""", css)

    def fields(self):
        return self.browser.value(f"""[...document.querySelectorAll("{PANEL} .lesson-question:enabled .field")]""")

    def give(self, question, value):
        """Fills in the field of a question."""
        browser = self.browser
        kind = question["kind"]
        if kind == "number":
            browser.type_into(self.visible(".lesson-number-field"), str(value))
        elif kind == "choice":
            browser.click(self.visible(f".lesson-choice label:nth-of-type({value + 1})"))
        elif kind == "sentence":
            browser.click(self.visible("textarea"))
            browser.driver.switch_to.active_element.send_keys(value)
        elif kind == "curve":
            for field, (_, y) in zip(self.fields(), value):
                browser.type_into(field, str(y))
        else:
            for place, option in enumerate(value):
                text = question["options"][option]
                for _ in range(self.order().index(text) - place):
                    browser.press(f"Move up: {text}", PANEL)
                self.assertEqual(self.order().index(text), place)

    def order(self):
        return self.browser.value(f"""[...document.querySelectorAll("{PANEL} .lesson-order-list li .grow")]
            .map((e) => e.textContent)""")

    def notes(self):
        """The notes of the run of `default`, as (kind, fields)."""
        part = self.control.call(export_run=c.ExportRun(
            world="default", table=c.RUN_TABLE_NOTES, format=c.TEXT_FORMAT_JSON_LINES)).export_part
        text = part.text
        while not part.last:
            part = self.control.call(continue_export=c.ContinueExport(export_id=part.export_id)).export_part
            text += part.text
        rows = [json.loads(row) for row in text.decode().splitlines()]
        return [(row["kind"], json.loads(row["text"])) for row in rows]


class Lessons(PlayedCase):
    lesson = json.loads((ROOT / "experiments/lessons/selection_pressure.json").read_text())

    def play(self, step):
        """Predicts what is expected; a curve gets values at its fields."""
        question = step["predict"]
        expected = question.get("expected", "Because of chance.")
        self.give(question, expected)
        self.browser.press(GIVE, PANEL)
        self.browser.wait_for_text("Your prediction is stored.", PANEL)

    def run_step(self, step):
        count = step["do"]["run"]
        if count < 4:
            self.control.call(set_speed=c.SetSpeed(world="default", speed=w.Speed(max=True)))
        self.browser.press(f"Run {count} generation{'s' * (count > 1)}", PANEL)
        self.browser.wait_for_text(RUN_HEADING, PANEL)

    def test_a_whole_lesson(self):
        browser, lesson = self.browser, self.lesson
        browser.open(self.page(self.served))
        browser.panel("Lesson")
        browser.press(lesson["title"], PANEL)
        browser.wait_for_text("You can read this lesson, but not run it here.", PANEL)
        browser.take_part()
        browser.press("Begin the lesson", PANEL)
        browser.wait_for_text(lesson["steps"][0]["title"], PANEL)
        self.assertEqual(self.control.world("default").seed, lesson["seed"])
        for number, step in enumerate(lesson["steps"], 1):
            browser.wait_for_text(f"Step {number} of {len(lesson['steps'])}", PANEL)
            self.assertEqual(browser.button(NEXT, PANEL).get_attribute("aria-disabled") if number < len(lesson["steps"])
                             else "true", "true")
            self.play(step)
            if number in (3, 4):
                browser.reload()  # the prediction has been given, and the world has not run
                browser.wait_for_text(f"Step {number} of", PANEL)
                browser.wait_for_text("Your prediction is stored.", PANEL)
            if "do" in step:
                self.run_step(step)
            if number < len(lesson["steps"]):
                browser.press(NEXT, PANEL)
        browser.wait_for_text("You have finished the lesson.", PANEL)
        self.check_notes()
        browser.press("‹ Back", PANEL)
        browser.wait_for_text("Order in the run", PANEL)
        self.assertEqual([text for level, text in browser.log() if level == "SEVERE"], [])

    def check_notes(self):
        """The last run contains all notes of the lesson, in their order, and what its steps set."""
        notes = self.notes()
        steps = self.lesson["steps"]
        predictions = [note for kind, note in notes if kind == "lesson_prediction"]
        self.assertEqual([note["id"] for note in predictions], [step["predict"]["id"] for step in steps])
        self.assertEqual(predictions[0], {"lesson": "selection_pressure", "step": 1, "id": "picks",
                                          "value": steps[0]["predict"]["expected"]})
        self.assertEqual(predictions[4]["value"], steps[4]["predict"]["expected"])
        observed = {note["id"]: note["value"] for kind, note in notes if kind == "lesson_observation"}
        self.assertEqual(list(observed), [name for step in steps for name in step.get("observe", {})])
        self.assertEqual(len(observed["mean_fitness"]), 6)
        diversity = self.control.call(observe=c.Observe(world="default", expressions=["diversity[4]"]))
        self.assertEqual(observed["diversity_0"], diversity.observations.observations[0].value)
        answers = {note["id"]: note for kind, note in notes if kind == "lesson_answer"}
        self.assertEqual(list(answers), ["picks", "rise", "takeover", "most_diverse"])
        self.assertAlmostEqual(answers["picks"]["apart"], answers["picks"]["predicted"] - observed["picks_of_fittest"])
        self.assertAlmostEqual(answers["takeover"]["law"], 4.15, places=2)
        self.assertEqual(answers["most_diverse"]["passed"], True)
        self.assertEqual(self.value_of(self.control, "tournament_size"), 1)

    def test_a_run_goes_on_after_a_reload(self):
        browser = self.browser
        browser.open(self.page(self.served, "#world=default&lesson=selection_pressure"))
        browser.take_part()
        browser.press("Begin the lesson", PANEL)
        self.play(self.lesson["steps"][0])
        browser.press("Run 1 generation", PANEL)
        browser.wait_for_text("Generation 1 of 1 …", PANEL)
        browser.reload()
        browser.wait_for_text("Generation 1 of 1 …", PANEL)
        browser.run("sessionStorage.clear()")  # as in another browser: the notes and the world are enough
        browser.reload()
        browser.take_part()
        browser.wait_for_text("Generation 1 of 1 …", PANEL)
        self.control.call(set_speed=c.SetSpeed(world="default", speed=w.Speed(max=True)))
        browser.wait_for_text("Observed", PANEL)

    def test_the_link_names_the_lesson(self):
        browser = self.browser
        browser.open(self.page(self.served, "#lesson=selection_pressure"))
        browser.wait_for_text(self.lesson["goals"][0], PANEL)
        self.assertTrue(browser.value("evod.app.link()").endswith("&lesson=selection_pressure"))
        for step in self.lesson["steps"]:  # all can be read
            browser.press(NEXT, PANEL)
            browser.wait_for_text(step["title"], PANEL)
            browser.wait_for_text(step["predict"]["ask"], PANEL)
        browser.press("‹ All lessons", PANEL)
        browser.wait_for_text(self.lesson["title"], PANEL)
        self.assertNotIn("lesson", browser.value("location.hash"))
        browser.open(self.page(self.served, "#lesson=nothing"))
        browser.wait_for_text("This server has no lesson nothing.", PANEL)

    def test_a_curve_is_drawn(self):
        browser = self.browser
        browser.open(self.page(self.served, "#lesson=selection_pressure"))
        for _ in range(3):
            browser.press(NEXT, PANEL)
        plot = self.visible(".lesson-drawable")
        browser.run("arguments[0].scrollIntoView({ block: 'center' })", plot)
        left, top, width, height = browser.value("""(({ left, top, width, height }) => [left, top, width, height])(
            arguments[0].getBoundingClientRect())""", plot)
        for kind, x, y in (("mousePressed", 0.2, 0.7), ("mouseMoved", 0.5, 0.5), ("mouseMoved", 0.9, 0.2),
                           ("mouseReleased", 0.9, 0.2)):
            browser.cdp("Input.dispatchMouseEvent", type=kind, x=left + x * width, y=top + y * height, button="left",
                        buttons=1, clickCount=1)
        values = browser.wait(f"""(() => {{
            const fields = [...document.querySelectorAll("{PANEL} .lesson-values .field")];
            const values = fields.map((field) => Number(field.value)).filter((value) => value > 0);
            return values.length > 2 && values; }})()""", "the values of the curve")
        self.assertEqual(values, sorted(values))

    def test_the_handout_has_space_for_predictions(self):
        browser = self.browser
        browser.open(self.page(self.served, "#lesson=selection_pressure"))
        browser.run("globalThis.print = () => undefined")
        browser.press("Print handout", PANEL)
        browser.wait("document.querySelector('.lesson-handout') !== null", "the handout")
        browser.cdp("Emulation.setEmulatedMedia", media="print")
        self.addCleanup(browser.cdp, "Emulation.setEmulatedMedia", media="")
        self.assertFalse(browser.value("document.querySelector('.app').checkVisibility()"))
        text = browser.text(".lesson-handout")
        for step in self.lesson["steps"]:
            self.assertIn(step["title"], text)
            self.assertIn(step["predict"]["ask"], text)
        self.assertGreater(browser.value("document.querySelectorAll('.lesson-handout .handout-write').length"), 3)
        browser.run("dispatchEvent(new Event('afterprint'))")
        self.assertTrue(browser.value("document.querySelector('.lesson-handout') === null"))


class GermanLessons(PlayedCase):
    lesson = json.loads((ROOT / "experiments/lessons/de/selection_pressure.json").read_text())

    @classmethod
    def setUpClass(cls):
        cls.browser = Browser("--lang=de-DE", "--accept-lang=de-DE,de")

    def test_the_first_steps(self):
        browser, steps = self.browser, self.lesson["steps"]
        browser.open(self.page(self.served))
        browser.panel("Lektion")
        browser.press(self.lesson["title"], PANEL)
        browser.take_part()
        browser.press("Lektion beginnen", PANEL)
        browser.wait_for_text(steps[0]["title"], PANEL)
        self.give(steps[0]["predict"], "99")
        browser.press("Das ist meine Vorhersage", PANEL)
        browser.wait_for_text("„99“ ist nicht möglich, erlaubt sind Zahlen von 0 bis 25", PANEL)
        self.give(steps[0]["predict"], "2,5")
        browser.press("Das ist meine Vorhersage", PANEL)
        browser.wait_for_text("Deine Vorhersage ist gespeichert.", PANEL)
        self.control.call(set_speed=c.SetSpeed(world="default", speed=w.Speed(max=True)))
        browser.press("1 Generation laufen lassen", PANEL)
        browser.wait_for_text("Was geschah", PANEL)
        browser.wait_for_text("2,5 Ziehungen", PANEL)
        browser.press("Weiter ›", PANEL)
        browser.wait_for_text(steps[1]["title"], PANEL)
        self.assertEqual(self.notes()[0], ("lesson_prediction", {
            "lesson": "selection_pressure", "step": 1, "id": "picks", "value": 2.5}))
        self.assertEqual([text for level, text in browser.log() if level == "SEVERE"], [])


if __name__ == "__main__":
    signal.signal(signal.SIGTERM, lambda *_: sys.exit(1))  # closes the browser
    unittest.main(argv=[sys.argv[0], *sys.argv[4:]])
