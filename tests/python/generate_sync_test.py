"""generate_sync.py turns asyncio source into synchronous source."""
import pathlib
import runpy
import unittest

SCRIPT = pathlib.Path(__file__).resolve().parents[2] / "client/python/generate_sync.py"
synchronous = runpy.run_path(str(SCRIPT))["synchronous"]


class GenerateSync(unittest.TestCase):
    def assert_becomes(self, source, expected):
        self.assertEqual(synchronous(source + "\n"), expected + "\n")

    def test_async_and_await_are_removed(self):
        self.assert_becomes("async def f():\n    async with a as b:\n        await b",
                            "def f():\n    with a as b:\n        b")

    def test_parentheses_around_await_are_removed(self):
        self.assert_becomes("return (await f(x, (1, 2))).y", "return f(x, (1, 2)).y")
        self.assert_becomes("g(await f())", "g(f())")
        self.assert_becomes("x = [(await f())[0] for i in (1, 2)]", "x = [f()[0] for i in (1, 2)]")

    def test_special_names_are_replaced(self):
        self.assert_becomes("raise StopAsyncIteration", "raise StopIteration")
        self.assert_becomes("def __aiter__(self): pass", "def __iter__(self): pass")

    def test_decorators_and_their_import_are_removed(self):
        self.assert_becomes("from evod.aio.awaitable import opens\n@opens\nasync def f(): pass", "def f(): pass")

    def test_modules_and_examples_are_replaced(self):
        self.assert_becomes("from evod.aio.link import Link", "from evod.link import Link")
        self.assert_becomes('"""\n>>> async with evod.aio.local() as lab:\n...     await lab.world()\n"""',
                            '"""\n>>> with evod.local() as lab:\n...     lab.world()\n"""')


if __name__ == "__main__":
    unittest.main()
