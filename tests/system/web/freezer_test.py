"""The freezer of the page: it keeps organisms, places copies, begins worlds with them, and shares files with evoctl."""
import pathlib
import signal
import sys
import unittest

HERE = pathlib.Path(__file__).resolve().parent
sys.path[:0] = [str(HERE), str(HERE.parent)]

import numpy  # noqa: E402
import waiting  # noqa: E402
from page_case import Case, c  # noqa: E402

PANEL = ".panel-freezer"
HEADING = "island,organism,normal_speed,impulse,body_size,base_health,food_radius,poison_radius\n"
ROW = "103.2,97.5,100,100,99.25,101\n"


class Freezer(Case):
    def setUp(self):
        super().setUp()
        self.served = self.start()
        self.control = self.client(self.served)
        self.control.run_to(60)
        self.browser.cdp("Browser.setDownloadBehavior", behavior="allow", downloadPath=self.folder)
        self.browser.open(self.page(self.served))
        self.shown_tick(60)
        self.browser.take_part()
        self.show()

    def show(self):
        self.browser.panel("Freezer")
        self.browser.wait_for_text("Keeps organisms", PANEL)  # it is loaded when it is first shown

    def entry(self, name):
        """Waits until the entry is kept and chosen."""
        self.browser.wait("document.querySelector('.freezer-entry h3')?.textContent === arguments[0]", name, name)

    def keep(self, which, name):
        field = self.browser.element(f"{PANEL} input[aria-label=Name]")
        field.send_keys(name)
        self.browser.press(which, PANEL)
        self.entry(name)

    def open_file(self, name, text):
        path = pathlib.Path(self.folder, name)
        path.write_text(text)
        self.browser.element(f"{PANEL} input[type=file]").send_keys(str(path))

    def genes(self, world, organism=None):
        """Row by row, as the server has them."""
        population = self.control.call(get_population=c.GetPopulation(world=world)).population
        genes = numpy.frombuffer(population.genes, "<f4").reshape(-1, population.count).T
        return genes if organism is None else genes[organism]

    def test_a_kept_organism_is_placed_and_outlives_the_page(self):
        browser = self.browser
        self.keep("Healthiest", "leader")
        healthiest = browser.value("evod.app.world().feed.healthiest[0].id")
        browser.reload()
        self.show()
        browser.press("leader", PANEL)
        self.entry("leader")
        browser.run("evod.app.world().selection.select(arguments[0])", healthiest)
        browser.wait_for_text(f"Organism {healthiest} has the same 6 genes.", PANEL)
        browser.run("evod.app.world().selection.select(arguments[0])", (healthiest + 1) % 30)
        browser.wait_for_text("differs in 6 of 6 genes.", PANEL)
        browser.press("Place at random places", PANEL)  # some of the places are occupied at first
        browser.wait_for_text("Placed 10 copies of leader in default, island 0.", ".notices")
        genes = self.genes("default")
        self.assertEqual(len(genes), 40)
        numpy.testing.assert_array_equal(genes[30:], [genes[healthiest]] * 10)
        browser.press("Undo")  # all copies were one change
        browser.wait_for_text("Undone: placed 10 organisms.", ".notices")

    def test_a_click_places_a_copy(self):
        browser = self.browser
        self.open_file("file.csv", HEADING + "0,0," + ROW)
        self.entry("file")
        browser.press("Place by clicks", PANEL)
        browser.wait_for_text("Click in the island to place file.", ".notices")
        left, top, width, height = browser.canvas()
        for x, y in numpy.mgrid[0.3:0.7:0.1, 0.3:0.7:0.1].reshape(2, -1).T:  # some places are occupied
            browser.click_at(left + x * width, top + y * height)
        waiting.until(lambda: len(self.genes("default")) > 30, "a placed copy")
        numpy.testing.assert_array_equal(self.genes("default", 30), numpy.array(ROW.split(","), "f4"))

    def test_a_population_begins_a_world_and_is_a_file(self):
        browser = self.browser
        self.keep("Population", "ancestors")
        browser.press("New world …", PANEL)
        browser.wait_for_text("population_size and island_count follow from the population.", ".new-world")
        browser.press("Create", ".new-world")
        browser.wait("evod.app.world().name === 'ancestors'", "the new world")
        numpy.testing.assert_array_equal(self.genes("ancestors"), self.genes("default"))
        browser.press("Download", PANEL)
        file = pathlib.Path(self.folder, "ancestors.csv")
        waiting.until(file.exists, "the downloaded file")
        self.assertEqual(file.read_text(), self.evoctl(self.served, "export", "--what", "population"))
        self.evoctl(self.served, "create", "of_file", "--population", str(file), "--set", "population_size=30")
        numpy.testing.assert_array_equal(self.genes("of_file"), self.genes("default"))

    def test_what_cannot_be_kept_or_placed_says_why(self):
        browser = self.browser
        self.open_file("wrong.csv", HEADING + "0,0," + ROW + "0,x," + ROW)
        browser.wait_for_text('wrong.csv: line 3: got "0,x,103.2,97.5,100,100,99.25,101", allowed: a whole number '
                              "(column organism).", PANEL)
        self.open_file("other.csv", HEADING.replace("\n", ",free_0\n") + "0,0," + ROW.replace("\n", ",1\n"))
        self.entry("other")
        browser.click("Place by clicks")
        browser.wait_for_text("other has 7 genes, but the organisms of the world default have 6.", ".notices")
        browser.press("New world …", PANEL)
        browser.wait_for_text("All organisms of the first generation are copies of this one.", ".new-world")
        browser.press("Create", ".new-world")
        browser.wait_for_text("free_0", ".new-world .error")
        browser.press("Cancel", ".new-world")
        browser.press("Delete …", PANEL)
        browser.press("Delete it", PANEL)
        browser.wait_for_text("Nothing is kept yet.", PANEL)


if __name__ == "__main__":
    signal.signal(signal.SIGTERM, lambda *_: sys.exit(1))  # closes the browser
    unittest.main(argv=[sys.argv[0], *sys.argv[4:]])
