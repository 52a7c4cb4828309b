"""The examples in the docstrings and in the README, as they stand there."""
import contextlib
import doctest
import importlib
import io
import pathlib
import pkgutil
import re
import unittest

import evod


def load_tests(loader, tests, pattern):
    for module in pkgutil.walk_packages(evod.__path__, "evod."):
        if not module.name.startswith("evod.v1"):
            suite = doctest.DocTestSuite(importlib.import_module(module.name))
            tests.addTest(suite)
    return tests


class Readme(unittest.TestCase):
    def test_its_programs_run(self):
        readme = pathlib.Path(__file__).resolve().parents[2] / "client" / "python" / "README.md"
        programs = re.findall(r"^```python\n(.*?)^```", readme.read_text(), re.MULTILINE | re.DOTALL)
        self.assertEqual(len(programs), 5)
        for program in programs:
            said = io.StringIO()
            with contextlib.redirect_stdout(said):
                exec(compile(program, str(readme), "exec"), {"__name__": "readme"})
            self.assertTrue(said.getvalue(), program)


class Docstrings(unittest.TestCase):
    def test_who_can_be_called_says_what_it_does(self):
        for name in evod.__all__:
            thing = getattr(evod, name)
            self.assertTrue(thing.__doc__, name)
            for member, value in vars(thing).items() if isinstance(thing, type) else ():
                named = not member.startswith("_") and (callable(value) or isinstance(value, property))
                if named and member not in PLAIN:
                    self.assertTrue(value.__doc__, f"{name}.{member}")


#: What their names and the class say.
PLAIN = {"close", "name", "lab", "organism_count", "worst", "items", "keys", "values", "of", "radius_px", "half_width_px",
         "half_height_px", "first_generation"}

if __name__ == "__main__":
    unittest.main()
