"""The examples run, with few generations, and print and plot their results."""
import contextlib
import io
import pathlib
import runpy
import sys
import tempfile
import unittest
from unittest import mock

from matplotlib import pyplot

EXAMPLES = pathlib.Path(__file__).resolve().parents[2] / "client" / "python" / "examples"
SMALL = {
    "watch_a_run": ["--generations", "1"],
    "change_at_generation_20": ["--generations", "22"],
    "compare_selection": ["--generations", "2", "--seeds", "2"],
    "sweep_heat_map": ["--generations", "2", "--seeds", "2", "--steps", "2"],
    "fork": ["--generations", "6"],
    "follow_a_lineage": ["--generations", "4"],
}
PRINTS = {
    "watch_a_run": "mean health",
    "change_at_generation_20": "generation 22: best",
    "compare_selection": "truncation: ",
    "sweep_heat_map": "mutation_step",
    "fork": "generation 3 of both is the same",
    "follow_a_lineage": "of generation 1",
}


class Examples(unittest.TestCase):
    def test_every_example_is_tested(self):
        self.assertEqual({path.stem for path in EXAMPLES.glob("*.py")}, set(SMALL))


def _runs(name):
    def test(self):
        with tempfile.TemporaryDirectory() as folder:
            plot = pathlib.Path(folder) / "plot.png"
            draws = name != "watch_a_run"
            arguments = [name, *SMALL[name], *(["--output", str(plot)] if draws else [])]
            output = io.StringIO()
            with mock.patch.object(sys, "argv", arguments), contextlib.redirect_stdout(output):
                runpy.run_path(str(EXAMPLES / f"{name}.py"), run_name="__main__")
            pyplot.close("all")
            self.assertIn(PRINTS[name], output.getvalue())
            if draws:
                self.assertGreater(plot.stat().st_size, 5000)
    return test


for _name in SMALL:
    setattr(Examples, f"test_{_name}", _runs(_name))


if __name__ == "__main__":
    unittest.main()
