"""The three scripts at the beginning of the package's README run, with smaller numbers, in at most ten lines each."""
import contextlib
import io
import os
import pathlib
import re
import tempfile
import unittest

README = pathlib.Path(__file__).resolve().parents[2] / "client/python/README.md"
SECTION = README.read_text().split("\n## Three scripts\n")[1].split("\n## ")[0]
SCRIPTS = re.findall(r"^```python\n(.*?)^```$", SECTION, re.MULTILINE | re.DOTALL)
SMALLER = {"replicates=10, generations=40": "replicates=2, generations=3", "speed=40": "speed=400",
           "generations=3)": "generations=1)", "generations=20)": "generations=2)",
           "at_generation=20": "at_generation=2",
           "at_generation=21": "at_generation=3", "generations=21)": "generations=3)", "range(1, 9)": "range(1, 4)"}


class Scripts(unittest.TestCase):
    def run_script(self, number):
        """Returns the output and the variables of a script, run in a new folder."""
        text = SCRIPTS[number]
        self.assertLessEqual(sum(bool(line.strip()) for line in text.splitlines()), 10)
        for before, after in SMALLER.items():
            text = text.replace(before, after)
        output, variables, here = io.StringIO(), {}, os.getcwd()
        with tempfile.TemporaryDirectory() as folder, contextlib.redirect_stdout(output):
            os.chdir(folder)
            try:
                exec(compile(text, f"script {number + 1} of {README}", "exec"), variables)
                variables["files"] = {path.name: path.stat().st_size for path in pathlib.Path(folder).iterdir()}
            finally:
                os.chdir(here)
        return output.getvalue(), variables

    def test_there_are_three(self):
        self.assertEqual(len(SCRIPTS), 3)
        for before in SMALLER:
            self.assertTrue(any(before in script for script in SCRIPTS), before)

    def test_two_selection_methods_are_plotted(self):
        _, variables = self.run_script(0)
        self.assertEqual(variables["sweep"].last.generation.tolist(), [3] * 4)
        self.assertGreater(variables["files"]["selection.png"], 5000)

    def test_distances_to_neighbours_are_printed(self):
        output, variables = self.run_script(1)
        lines = re.findall(r"^generation 1, +[\d.]+ s: ([\d.]+) px$", output, re.MULTILINE)
        self.assertEqual(len(lines), len(output.splitlines()))
        positions = variables["snapshot"].organisms.positions
        nearest = [min(((x - a) ** 2 + (y - b) ** 2) ** 0.5 for j, (a, b) in enumerate(positions) if j != i)
                   for i, (x, y) in enumerate(positions)]
        self.assertEqual(lines[-1], f"{sum(nearest) / len(nearest):.1f}")

    def test_the_effect_of_a_change_is_printed(self):
        output, variables = self.run_script(2)
        self.assertRegex(output, r"^-?\d+\.\d ± \d+\.\d\n$")
        self.assertEqual(len(set(variables["effects"])), 3)


if __name__ == "__main__":
    unittest.main()
