"""The tree keeps the rules of tidy.py, and each rule finds what breaks it."""
import pathlib
import unittest
import unittest.mock

import tidy

ROOT = pathlib.Path(__file__).resolve().parents[2]


def found(rule, name, text):
    """The lines in which a rule finds something in a file of that name."""
    return [line for _, line, _ in rule(pathlib.Path(name), text)]


class Tree(unittest.TestCase):
    def test_keeps_every_rule(self):
        findings = [f"{path}:{line}: {what}" for path, line, what in tidy.findings(ROOT)]
        self.assertEqual(findings, [], "\n" + "\n".join(findings))


class Rules(unittest.TestCase):
    def test_banned_words_are_found_in_every_form(self):
        text = "// It is told.\nint nobody_here;\nstruct PictureStream {};\nvoid anew();\n"
        self.assertEqual(found(tidy.banned_words, "server/a.cpp", text), [1, 2, 3, 4])
        self.assertEqual(found(tidy.banned_words, "docs/a.md", "The server is\ntold"), [2])
        self.assertEqual(found(tidy.banned_words, "a.py", "class Retries:\n    pass"), [1])
        self.assertEqual(found(tidy.banned_words, "a.md", "Retries of a request: total, stellar, newcomer\n"), [])
        for _, _, what in tidy.banned_words(pathlib.Path("a.md"), "picture"):
            self.assertIn("snapshot", what)

    def test_is_no_is_found_and_there_is_no_is_not(self):
        for text in ("if the output is no terminal", "// These were no numbers.", "\"genes that are no weights\""):
            self.assertEqual(found(tidy.banned_grammar, "docs/a.md", text), [1], text)
        for text in ("There is no terminal.", "it is no longer there", "if there\n/// is no log", "is not a terminal"):
            self.assertEqual(found(tidy.banned_grammar, "docs/a.md", text), [], text)

    def test_statements_without_braces_are_found(self):
        for statement in ("if (a) b();", "else b();", "for (;;) b();", "while (f(a)) b();", "if constexpr (a) b();",
                          "if (a)\n    return \"{\";"):
            self.assertEqual(found(tidy.missing_braces, "a.cpp", statement), [1], statement)
        self.assertNotEqual(found(tidy.missing_braces, "a.cpp", "do b(); while (a);"), [])
        for statement in ("if (a) { b(); } else if (c) { d(); } else { e(); }", "do { b(); } while (a);",
                          "while (a) { b(); }",
                          "#if a\nb();\n#else\nc();\n#endif", "// if (a) b();", "auto text = \"if (a) b();\";"):
            self.assertEqual(found(tidy.missing_braces, "a.cpp", statement), [], statement)

    def test_a_sentence_in_two_languages_is_found(self):
        page = "client/web/src/a.ts"
        def voices(source, text, of_page):
            files = {source: text, page: of_page}
            return [line for _, line, _ in tidy.second_voices(files, files.get)]
        cpp = 'f("the world " + name + " has been deleted "\n  "by the administrator: create it");'
        self.assertEqual(voices("server/a.cpp", cpp, "\nlet a = `${x} has been deleted by the administrator.`;"), [2])
        python, of_page = 'f"{x} has been deleted by Anna"', 'a("has been deleted by Anna");'
        self.assertEqual(voices("client/python/evod/a.py", python, of_page), [1])
        comment, of_page = "// has been deleted by the administrator\n", 'a("has been deleted by the administrator");'
        self.assertEqual(voices("server/a.cpp", comment, of_page), [])
        self.assertEqual(voices("tests/a.cpp", cpp, of_page), [], "a test")
        self.assertEqual(voices("server/a.cpp", 'f("has been deleted");', 'a("has been deleted");'), [], "three words")

    def test_torn_comment_blocks_are_found(self):
        self.assertEqual(found(tidy.torn_comments, "a.h", "// stream. Source       Blickle 1996\n"), [1])
        self.assertEqual(found(tidy.torn_comments, "a.h", "// Source       Blickle 1996\n// The Owner of it.\n"), [])

    def test_long_test_names_are_found(self):
        long = "A" * 51
        self.assertEqual(found(tidy.long_test_names, "tests/a.cpp", f"TEST(Suite, {long}) {{}}\n"), [1])
        self.assertEqual(found(tidy.long_test_names, "tests/a.cpp", f"TEST_F(Suite, {long[1:]}) {{}}\n"), [])
        self.assertEqual(found(tidy.long_test_names, "tests/a.py", f"    def test_{long}(self):\n"), [1])
        self.assertEqual(found(tidy.long_test_names, "tests/a.py", f"    def test_{long[1:]}(self):\n"), [])

    def test_headers_without_a_page_are_found(self):
        self.assertEqual(found(tidy.header_without_page, "server/a.h", "#pragma once\n"), [1])
        self.assertEqual(found(tidy.header_without_page, "server/a.h", "// A.\n#pragma once\n"), [1])
        self.assertEqual(found(tidy.header_without_page, "server/a.h",
                               "// Migration: copies of the best go to neighbours.\n"), [])

    def test_large_sources_are_found(self):
        self.assertEqual(found(tidy.large_source, "server/a.cpp", "\n" * 701), [1])
        self.assertEqual(found(tidy.large_source, "server/a.cpp", "\n" * 700), [])
        self.assertEqual(found(tidy.large_source, "tests/a.py", "\n" * 701), [1])
        self.assertEqual(found(tidy.large_source, "a.py", '"""Messages. Generated by protoc."""\n' + "\n" * 701), [])
        self.assertEqual(found(tidy.large_source, "client/web/src/a.ts", "\n" * 701), [1])

    def test_large_functions_are_found(self):
        inside = "    f();\n"
        for name, begin, end in (("a.cpp", "class A {\n  int f(int x) const {\n", "  }\n};\n"),
                                 ("a.py", "class A:\n  def f(self):\n", ""),
                                 ("a.h", "namespace a {\nA::A(int b)\n    : b_{b} {\n", "}\n}\n")):
            short = 100 - begin.count("\n") + 1 - bool(end)
            self.assertEqual(found(tidy.large_function, name, begin + inside * short + end), [], name)
            self.assertEqual(found(tidy.large_function, name, begin + inside * (short + 1) + end), [2], name)
        self.assertEqual(found(tidy.large_function, "a.py", 'def f():\n    """' + "\n" * 150 + '"""\n'), [])
        self.assertEqual(found(tidy.large_function, "a.h", "struct A {\n" + "    int b();\n" * 150 + "};\n"), [])

    def test_long_lines_are_found(self):
        self.assertEqual(found(tidy.long_line, "a.py", "#" * 121 + "\n" + "#" * 120 + "\n"), [1])
        self.assertEqual(found(tidy.long_line, "client/web/src/a.ts", "/" * 121), [1])
        self.assertEqual(found(tidy.long_line, "server/a.h", "/" * 121), [1])
        self.assertEqual(found(tidy.long_line, "server/evolution/ga_parameters.h", "/" * 121), [])

    def test_python_names_are_defined_once_and_used(self):
        for text, lines in (("A = 1\nA = 2\n", [2]), ("_A = 1\n", [1]), ("_A = 1\nprint(_A)\n", []),
                            ("A = 1\nA = A + 1\n", []),
                            ("def f(): pass\ndef g(): pass\ndef f(): pass\n", [3]),
                            ("import a\nfrom b import a\n", [2]),
                            ("class A:\n    def f(self): pass\n    def f(self): pass\n", [3]),
                            ("class A:\n    @property\n    def f(self): pass\n"
                             "    @f.setter\n    def f(self, x): pass\n", []),
                            ("class A:\n    @overload\n    def f(self): ...\n    def f(self): pass\n", []),
                            ("try:\n    import a\nexcept ImportError:\n    a = None\n", [])):
            self.assertEqual(found(tidy.python_names, "a.py", text), lines, text)

    def test_sources_without_a_unit_test_are_found(self):
        def untested(tests, excepted=()):
            names = ["server/network/a.cpp", "server/network/a.h", *tests]
            with unittest.mock.patch.dict(tidy.UNIT_TESTED_ELSEWHERE, {name: "reason" for name in excepted},
                                          clear=True):
                return [str(path) for path, _, _ in tidy.untested_sources(names, lambda name: tests.get(name, ""))]
        self.assertEqual(untested({}), ["server/network/a.cpp"])
        self.assertEqual(untested({"tests/unit/network/a_test.cpp": ""}), [])
        self.assertEqual(untested({"tests/unit/b_test.cpp": '#include "server/network/a.h"\n'}), [])
        self.assertEqual(untested({"tests/unit/other/a_test.cpp": "",
                                   "tests/system/a_test.cpp": '#include "server/network/a.h"\n'}),
                         ["server/network/a.cpp"])
        self.assertEqual(untested({}, [("server/network", "a")]), [])
        self.assertEqual(untested({}, [("server", "*")]), [])
        self.assertEqual(untested({"tests/unit/network/a_test.cpp": ""}, [("server/network", "a")]),
                         ["tests/tidy/tidy.py"])

    def test_every_test_is_built(self):
        texts = {"tests/unit/CMakeLists.txt": "evod_test(unit_a SOURCES a_test.cpp aa_test.cpp)"}
        names = [*texts, "tests/unit/a_test.cpp", "tests/unit/b_test.cpp", "tests/unit/support.cpp"]
        self.assertEqual([str(path) for path, _, _ in tidy.unbuilt_tests(names, lambda name: texts.get(name, ""))],
                         ["tests/unit/b_test.cpp"])


if __name__ == "__main__":
    unittest.main()
