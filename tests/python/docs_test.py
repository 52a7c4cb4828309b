"""The examples in the docstrings, as they stand there; the README is run by tests/docs."""
import doctest
import importlib
import pkgutil
import unittest

import evod


def load_tests(loader, tests, pattern):
    for module in pkgutil.walk_packages(evod.__path__, "evod."):
        if not module.name.startswith("evod.v1"):
            suite = doctest.DocTestSuite(importlib.import_module(module.name))
            tests.addTest(suite)
    return tests


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
