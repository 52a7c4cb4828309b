"""documents_test.py fails where a document is wrong, and says where: short documents, right or wrong in one way."""
import pathlib
import subprocess
import sys
import tempfile
import unittest

SKIPPED = 77  # ctest's SKIP_RETURN_CODE


def follow(document):
    """Its status and what it says of a document."""
    with tempfile.TemporaryDirectory() as folder:
        path = pathlib.Path(folder) / "page.md"
        path.write_text(document)
        ended = subprocess.run([sys.executable, pathlib.Path(__file__).with_name("documents_test.py"), path],
                               capture_output=True, text=True)
    return ended.returncode, ended.stdout + ended.stderr


def block(language, *lines):
    return "\n".join(["```" + language, *lines, "```", ""])


class Documents(unittest.TestCase):
    def right(self, document, *words):
        status, said = follow(document)
        self.assertEqual(status, 0, said)
        for word in words:
            self.assertIn(word, said)

    def wrong(self, document, *words):
        status, said = follow(document)
        self.assertEqual(status, 1, said)
        for word in words:
            self.assertIn(word, said)

    def test_a_block_has_what_those_before_it_left(self):
        self.right(block("sh", "word=left", "mkdir there && cd there") + block("sh", "echo $word in $(basename $PWD)") +
                   block("text", "left in there") + block("python", "import os",
                                                          "print(os.path.basename(os.getcwd()))") +
                   block("text", "there"), "2 sh blocks", "1 python blocks", "2 outputs compared")

    def test_every_command_has_to_succeed(self):
        self.wrong("A word.\n" + block("sh", "echo before", "false", "true"), "line 3", "status 1", "before")
        self.wrong(block("sh", "false | cat"), "status 1")
        self.assertNotIn("Traceback", follow(block("sh", "false"))[1])
        self.wrong(block("sh", "exit 3"), "status 3")
        self.wrong(block("python", "import sys", "sys.exit('no')"), "status 1", "no")

    def test_a_status_that_is_shown_has_to_be_the_one(self):
        mark = "<!-- ends with status 3 -->\n"
        self.right(mark + block("sh", "(exit 3)") + block("sh", "true"))
        self.wrong(mark + block("sh", "true"), "status 0, not 3")

    def test_an_output_that_is_shown_has_to_be_the_one(self):
        self.right(block("sh", "seq 5") + block("text", "1", "…", "4", "5"))
        self.right(block("sh", "seq 2") + block("text", "1", "2", "…"))
        self.wrong(block("sh", "seq 5") + block("text", "1", "…", "4"), "line 5", "said was")
        self.wrong(block("sh", "echo a.c") + block("text", "abc"), "said was")
        self.wrong(block("sh", "echo right; echo wrong >&2") + block("text", "right"), "wrong")
        self.wrong(block("text", "right"), "nothing was run")

    def test_what_varies_varies_as_it_is_said_and_nothing_else(self):
        mark = "<!-- varies: \\d+ s -->\n"
        self.right(block("sh", "echo 7 of 9 in 12 s") + mark + block("text", "7 of 9 in 3 s"))
        self.wrong(block("sh", "echo 8 of 9 in 12 s") + mark + block("text", "7 of 9 in 3 s"), "said was")
        self.wrong(block("sh", "echo 7 of 9 in x s") + mark + block("text", "7 of 9 in 3 s"), "said was")

    def test_an_output_is_waited_for(self):
        self.right(block("sh", "(sleep 0.3; echo ready) &") + block("text", "ready"))

    def test_skipped_blocks_are_reported(self):
        self.right("<!-- not run: it needs a window -->\n" + block("sh", "false") + block("sh", "true"),
                   "1 not run: it needs a window", "1 sh blocks")

    def test_what_a_reader_has_goes_before(self):
        self.right("<!-- before: answer = 42 -->\n" + block("python", "print(answer)") + block("text", "42"))

    def test_questions_to_a_run_file_have_answers(self):
        make = block("sh", "sqlite3 default.evod 'CREATE TABLE t(a); INSERT INTO t VALUES (7)'")
        self.right(make + block("sql", "SELECT a FROM t;", "SELECT 8;") + block("text", "7", "8"))
        self.wrong(make + block("sql", "SELECT a FROM t WHERE a = 8;"), "status 1")
        self.wrong(make + block("sql", "SELECT b FROM t;"), "no such column")

    def test_marks_and_blocks_that_say_nothing_are_found(self):
        self.wrong("<!-- varies: 1 -->\n" + block("sh", "true"), "'varies' says nothing")
        self.wrong("<!-- not run: why -->\n" + block("yaml", "a: b"), "not run")
        self.wrong(block("sh", "true") + "<!-- not run: why -->\n", "no block after")
        self.wrong("- a list\n\n  ```sh\n  false\n  ```\n", "not found")
        self.wrong("```sh\ntrue\n", "not found")


if __name__ == "__main__":
    status, said = follow("")
    if status == SKIPPED:
        print(said)
        sys.exit(SKIPPED)
    unittest.main()
