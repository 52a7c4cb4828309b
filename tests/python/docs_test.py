"""The examples in docstrings print what they show, and every public name has a docstring. tests/docs runs the
README."""
import ast
import asyncio
import doctest
import importlib
import inspect
import pkgutil
import unittest
from unittest import mock

import evod
import evod.aio

MODULES = sorted(module.name for module in pkgutil.walk_packages(evod.__path__, "evod.")
                 if not module.name.startswith("evod.v1"))
#: The name says it all.
PLAIN = {"items", "keys", "values"}


class Docstrings(unittest.TestCase):
    def test_public_names_have_docstrings(self):
        for package in (evod, evod.aio):
            for name in package.__all__:
                thing = getattr(package, name)
                self.assertTrue(thing.__doc__, name)
                for member, value in vars(thing).items() if isinstance(thing, type) else ():
                    named = not member.startswith("_") and (callable(value) or isinstance(value, property))
                    if named and member not in PLAIN:
                        self.assertTrue(value.__doc__, f"{package.__name__}.{name}.{member}")

    def test_synchronous_docstrings_await_nothing(self):
        for name in ("classrooms", "connection", "evaluation", "experiments", "lab", "streams", "world_queries"):
            source = inspect.getsource(importlib.import_module(f"evod.{name}"))
            for word in ("await ", "async ", "evod.aio"):
                self.assertNotIn(word, source.partition("\n\n")[2], name)


def _examples_of(name):
    def test(self):
        module = importlib.import_module(name)
        flags = ast.PyCF_ALLOW_TOP_LEVEL_AWAIT if name.startswith("evod.aio") else 0
        with asyncio.Runner() as loop:
            def execute(code, variables):
                result = eval(code, variables)
                if inspect.iscoroutine(result):
                    loop.run(result)

            with mock.patch.object(doctest, "exec", execute, create=True):
                runner = doctest.DocTestRunner(verbose=False)
                for found in doctest.DocTestFinder().find(module, name):
                    lines = []
                    failed = runner.run(found, compileflags=flags, out=lines.append).failed
                    self.assertEqual(failed, 0, "".join(lines))
    return test


class Examples(unittest.TestCase):
    """A test for each module; examples of evod.aio await outside of functions."""


for _name in MODULES:
    setattr(Examples, "test_" + _name.replace(".", "_"), _examples_of(_name))

if __name__ == "__main__":
    unittest.main()
