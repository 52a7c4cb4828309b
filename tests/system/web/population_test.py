"""Worlds without bodies, the best solution and warnings in a real Chromium."""
import json
import signal
import sys
import unittest

from page_case import Browser, Case, c, w

DRAWN = """(() => {
  const canvas = document.querySelector(".population-canvas");
  const pixels = canvas.getContext("2d").getImageData(0, 0, canvas.width, canvas.height).data;
  return new Set(new Uint32Array(pixels.buffer)).size;
})()"""  # number of colours


class WithoutBodies(Case):
    def show(self, **parameters):
        self.served = self.start("--speed", "max", fitness="rastrigin", **parameters)
        self.control = self.client(self.served)
        self.browser.open(self.page(self.served))

    def run_generations(self, generations):
        self.control.call(run=c.Run(generations=generations))
        self.control.wait_world(lambda world: world.generation >= generations and
                                world.state == w.RUN_STATE_WAITING, "default")

    def test_the_population_stands_in_place_of_the_island(self):
        browser = self.browser
        self.show()
        browser.wait_for_text("Each line is one of 30 organisms.", ".population-head")
        browser.wait_for_text("Best: organism", ".population-head")
        self.assertGreater(browser.value(DRAWN), 20)
        for absent in (".pane-canvas", ".legend", ".tools", ".island-legend"):
            self.assertFalse(browser.value("document.querySelector(arguments[0]).checkVisibility()", absent), absent)
        page = browser.text()
        for absent in ("food", "poison", "alive", "health"):
            self.assertNotIn(absent, page)

    def test_the_introduction_speaks_of_genes(self):
        self.show()
        newcomer = Browser(introduces=True)
        self.addCleanup(newcomer.close)
        newcomer.open(self.page(self.served), wait=False)
        newcomer.wait_for_text("Each line is an organism", ".introduction")
        for word in "Food", "poison", "health":
            self.assertNotIn(word, newcomer.text())

    def test_other_genes_are_on_further_pages(self):
        browser = self.browser
        self.show(free_genes=100)
        browser.wait_for_text("of 106", ".population-pages")
        first = browser.text(".population-pages")
        browser.press("›", ".population-pages")
        browser.wait("document.querySelector('.population-pages').innerText !== arguments[0]", "later genes", first)
        browser.press("›", ".population-pages")
        browser.wait_for_text("–106 of 106", ".population-pages")

    def test_a_large_population_is_a_sample(self):
        self.show(population_size=12_000)
        self.browser.wait_for_text("1,000 lines: a sample of the first 10,000 of 12,000 organisms.", ".population-head")

    def test_the_best_solution_has_genes_and_ancestors(self):
        browser = self.browser
        self.show()
        self.run_generations(5)
        rows = self.control.call(get_history=c.GetHistory()).history.generations
        best = max(rows, key=lambda row: row.fitness_best)
        browser.wait_for_text(f"organism {best.best_organism}, generation {best.generation}", ".best-solution")
        browser.click(browser.element(".best-solution summary"))
        browser.wait("document.querySelectorAll('.best-solution tbody tr').length === 6", "six genes")
        genes = [float(text) for text in
                 browser.value("[...document.querySelectorAll('.best-solution td')].map((cell) => cell.innerText)")]
        table = self.evoctl(self.served, "--json", "best")
        self.assertEqual([f"{gene:.4g}" for gene in genes],
                         [f"{gene:.4g}" for gene in json.loads(table)["genes"]])
        browser.press("Ancestors", ".best-solution")
        browser.wait_for_text("ancestor", "[data-panel=family]")


class Warnings(Case):
    def test_warnings_stay_until_the_settings_change(self):
        browser = self.browser
        served = self.start(elite_count=30)
        control = self.client(served)
        browser.open(self.page(served))
        browser.wait_for_text("No child is ever bred, because elite_count 30 is not below population_size 30.",
                              ".summary .warning")
        browser.reload()
        browser.wait_for_text("No child is ever bred", ".summary .warning")
        assignment = w.ParameterAssignment(name="elite_count", value=w.ParameterValue(count=1))
        control.call(set_parameters=c.SetParameters(parameters=[assignment]))
        browser.wait("document.querySelector('.summary .warning').innerText === ''", "no warning")

    def test_an_edit_is_warned_about_before_it_is_applied(self):
        browser = self.browser
        served = self.start()
        browser.open(self.page(served))
        browser.take_part()
        browser.panel("Parameters")
        field = browser.wait("[...document.querySelectorAll(arguments[0])].find((one) => !one.disabled)", "the field",
                             "[data-panel=parameters] .field[data-parameter=survivors]")
        browser.type_into(field, "1")
        browser.wait_for_text("No child is ever bred, because all organisms survive", ".parameters .warning")
        browser.press("Discard")
        browser.wait("[...document.querySelectorAll('.parameters .warning')].every((one) => one.innerText === '')",
                     "no warning")
        browser.take_part(False)


if __name__ == "__main__":
    signal.signal(signal.SIGTERM, lambda *_: sys.exit(1))  # closes the browser
    unittest.main(argv=[sys.argv[0], *sys.argv[4:]])
