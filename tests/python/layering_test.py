"""The modules of the package import each other without a circle."""
import ast
import graphlib
import pathlib
import unittest

import evod

PACKAGE = pathlib.Path(evod.__file__).parent


def imports_of(path):
    """The modules of the package that a module imports, in functions too."""
    for node in ast.walk(ast.parse(path.read_text())):
        if isinstance(node, ast.ImportFrom) and node.module and node.module.startswith("evod"):
            yield node.module
            yield from (f"{node.module}.{name.name}" for name in node.names)
        elif isinstance(node, ast.Import):
            yield from (name.name for name in node.names)


class Layering(unittest.TestCase):
    def test_imports_form_no_circle(self):
        paths = [path for path in PACKAGE.rglob("*.py") if path.name != "__init__.py" and path.parent.name != "v1"]
        modules = {".".join(("evod", *path.relative_to(PACKAGE).with_suffix("").parts)): path for path in paths}
        graph = {module: set(imports_of(path)) & modules.keys() for module, path in modules.items()}
        self.assertGreater(len(graph["evod.aio.lab"]), 5)
        list(graphlib.TopologicalSorter(graph).static_order())  # raises CycleError


if __name__ == "__main__":
    unittest.main()
