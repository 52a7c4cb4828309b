"""check_documents finds links and tables of contents that are wrong."""
import importlib.machinery
import importlib.util
import pathlib
import unittest

SCRIPT = pathlib.Path(__file__).resolve().parents[2] / "scripts/check_documents"
loader = importlib.machinery.SourceFileLoader("check_documents", str(SCRIPT))
check = importlib.util.module_from_spec(importlib.util.spec_from_loader("check_documents", loader))
loader.exec_module(check)


class Links(unittest.TestCase):
    def test_a_missing_file_or_heading_is_found(self):
        self.assertFalse(list(check.broken_links("README.md", "[a](docs/MODEL.md#mutation) [b](LICENSE)")))
        self.assertTrue(list(check.broken_links("README.md", "[a](docs/MODEL.md#mutations)")))
        self.assertTrue(list(check.broken_links("README.md", "[a](docs/NONE.md)")))

    def test_the_contents_are_the_headings_in_order(self):
        headings = "\n## First part\n\n### Detail\n\n## Second\n"
        contents = "## Contents\n\n- [First part](#first-part)\n  - [Detail](#detail)\n- [Second](#second)\n"
        self.assertFalse(list(check.broken_contents("page.md", contents + headings)))
        self.assertFalse(list(check.broken_contents("page.md", headings)))
        for wrong in contents.replace("  - [Detail](#detail)\n", ""), contents.replace("Second]", "Third]"):
            self.assertTrue(list(check.broken_contents("page.md", wrong + headings)))


if __name__ == "__main__":
    unittest.main()
