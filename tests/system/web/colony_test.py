"""A colony with predators on the page: triangles, the counts of both species, the organism panel, which follows an
organism over intervals, and the plots of the population."""
import signal
import sys
import unittest

from page_case import Case, c, w

COLONY = {"reproduction": "births", "births": "asexual", "population_size": 40, "predator_count": 6,
          "birth_health": 120.0, "food_count": 60, "generation_s": 2.0,
          "island_width_px": 900.0, "island_height_px": 500.0}
TICKS = 120  # of an interval


class Colony(Case):
    def colony(self, ticks):
        server = self.start(**COLONY)
        control = self.client(server)
        control.run_to(ticks)
        self.browser.open(self.page(server))
        self.shown_tick(ticks)
        return server, control

    def test_predators_are_triangles(self):
        _, control = self.colony(30)
        browser = self.browser
        species = browser.columns()["organisms"]["species"]
        live = control.call(get_statistics=c.GetStatistics(world="default")).statistics.live[0]
        self.assertEqual(species.count(w.SPECIES_PREDATOR), live.predator_count)
        self.assertGreater(live.predator_count, 0)
        browser.wait_for_text(f"predators {live.predator_count}")
        browser.wait_for_text(f"prey {live.alive_count - live.predator_count}")
        browser.wait("[...document.querySelectorAll('.legend-item')].some("
                     "(item) => item.checkVisibility() && item.innerText === 'predator')", "the mark of predators")

    def test_an_organism_is_followed_over_intervals(self):
        _, control = self.colony(TICKS - 10)
        browser, ticks = self.browser, TICKS - 10
        for is_predator, name in ((False, "Organism"), (True, "Predator")):
            organism = self.healthiest(control, is_predator)
            browser.run("evod.app.world().selection.select(arguments[0])", organism.id)
            browser.panel("Organism")
            browser.wait_for_text(f"{name} number {organism.number}", ".organism")
            ticks += TICKS
            control.run_to(ticks)
            browser.wait("evod.app.world().selection.info?.generation === arguments[0]", "the next interval",
                         organism.generation + 1)
            found = browser.value("evod.app.world().selection.info")
            self.assertEqual(found["number"], organism.number)
            browser.wait_for_text("It was born before this interval.", ".organism")

    @staticmethod
    def healthiest(control, is_predator):
        """The healthiest organism of a species."""
        count = control.call(get_statistics=c.GetStatistics(world="default")).statistics.live[0].organism_count
        all_infos = [control.call(get_organism=c.GetOrganism(world="default", organism=organism)).organism
                     for organism in range(count)]
        return max((info for info in all_infos if info.alive and (info.species == w.SPECIES_PREDATOR) == is_predator),
                   key=lambda info: info.health)

    def test_the_population_is_plotted(self):
        self.colony(4 * TICKS + 10)
        browser = self.browser
        browser.panel("Plots")
        browser.wait_for_text("4 intervals, up to 4", ".plots")
        browser.press("Population", ".plots")
        browser.wait_for_text("predators, mean", ".plots .plot-legend")
        browser.press("Phase plot", ".plots")
        browser.wait_for_text("Circle: interval 4,", ".plots")
        self.assertGreater(browser.value("document.querySelectorAll('.phase-plot polyline').length"), 0)


if __name__ == "__main__":
    signal.signal(signal.SIGTERM, lambda *_: sys.exit(1))  # closes the browser
    unittest.main(argv=[sys.argv[0], *sys.argv[4:]])
