"""The family tree of a whole generation in the page: it names the common ancestors that the lineage table contains."""
import csv
import signal
import sys
import unittest

from page_case import Case, c
from browser import Keys

OPTIONS = "[...document.querySelectorAll(`.family select[aria-label='${arguments[0]}'] option`)]"
READ = "Number(/Organism (\\d+) of generation/.exec(document.querySelector('.family-note').textContent)?.[1] ?? -1)"


class Family(Case):
    def choose(self, label, text):
        option = f"{OPTIONS}.find((option) => option.text === arguments[1])"
        self.browser.wait(option, text, label, text).click()

    def parents(self, control):
        """The parents of each organism, which is (generation, id)."""
        wanted = c.ExportRun(world="default", table=c.RUN_TABLE_LINEAGE, format=c.TEXT_FORMAT_CSV)
        part = control.call(export_run=wanted).export_part
        text = part.text
        while not part.last:
            part = control.call(continue_export=c.ContinueExport(export_id=part.export_id)).export_part
            text += part.text
        parents = {}
        for row in csv.DictReader(text.decode().splitlines()):
            generation, organism = int(row["generation"]), int(row["organism"])
            ids = (row["parent_first"], row["parent_second"])
            parents[generation, organism] = {(generation - 1, int(id)) for id in ids if id}
        return parents

    def common(self, parents, organisms):
        """The most recent common ancestors of organisms of one generation."""
        ancestors = [{one} for one in organisms]
        while all(ancestors):
            ancestors = [set().union(*(parents[one] for one in of)) for of in ancestors]
            if common := set.intersection(*ancestors):
                return sorted(common)
        return []

    def test_a_generation_and_its_common_ancestors(self):
        browser, server = self.browser, self.start()
        control = self.client(server)
        control.run_to(900)
        parents = self.parents(control)
        last = max(generation for generation, _ in parents)
        browser.open(self.page(server))
        self.shown_tick(900)
        browser.panel("Family tree")
        self.choose("What to show", "whole generation")
        sentence = browser.wait("document.querySelector('.family-sentence')?.textContent", "the sentence")
        common = self.common(parents, [one for one in parents if one[0] == last])
        self.assertIn(f"of generation {common[0][0]}, " if common else "have no common ancestor since", sentence)
        for _, organism in common[:2]:
            self.assertRegex(sentence, rf"\b{organism}\b")
        browser.click(browser.element(".family summary"))
        browser.wait("document.querySelectorAll('.family tbody tr').length === 30", "the table")

        drawing = browser.element(".family-drawing")
        browser.run("arguments[0].focus()", drawing)
        one = browser.value(READ)
        drawing.send_keys("m", Keys.END, "m")
        other = browser.value(READ)
        named = f"A: organism {one} of generation {last}. B: organism {other} of generation {last}."
        browser.wait_for_text(named, ".family-marks")
        common = self.common(parents, [(last, one), (last, other)])
        browser.wait_for_text(f"of generation {common[0][0]}." if common else "no common ancestor", ".family-marks")

        drawing.send_keys(Keys.ARROW_UP)
        parent = browser.value(READ)
        self.assertIn((last - 1, parent), parents[last, other])
        drawing.send_keys(Keys.ENTER)
        browser.wait("evod.app.world().snapshot.generation === arguments[0]", "the past", last - 1)
        browser.wait("evod.app.world().selection.id === arguments[0]", f"organism {parent} selected", parent)


if __name__ == "__main__":
    signal.signal(signal.SIGTERM, lambda *_: sys.exit(1))  # closes the browser
    unittest.main(argv=[sys.argv[0], *sys.argv[4:]])
