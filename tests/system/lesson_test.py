"""Lessons: the files that evod brings, evod lesson, and a lesson as a client plays it. EVOD names the program, MESSAGES
the folder of the message classes."""
import csv
import io
import json
import pathlib
import re
import sys
import tempfile
import unittest

import export_test
import waiting
from past_test import EVOD, c

LESSONS = pathlib.Path(__file__).parents[2] / "experiments" / "lessons"
ENGLISH = sorted(LESSONS.glob("*.json"))
TEXTS = {"title", "text", "ask", "unit", "label", "needs", "goals", "options"}
INVALID_ARGUMENT = 3


def lesson(*words):
    return waiting.run([EVOD, "lesson", *words], capture_output=True, text=True)


def without_texts(value, inside=""):
    """The structure of a lesson: each text is replaced by its kind."""
    if isinstance(value, dict):
        return {name: without_texts(inner, name) for name, inner in value.items()}
    if isinstance(value, list):
        return [without_texts(inner, inside) for inner in value]
    return str if inside in TEXTS and isinstance(value, str) else value


class Files(unittest.TestCase):
    def test_there_are_nine(self):
        self.assertEqual(len(ENGLISH), 9)

    def test_each_has_a_german_twin(self):
        self.assertEqual([path.name for path in ENGLISH], sorted(path.name for path in (LESSONS / "de").iterdir()))
        for path in ENGLISH:
            with self.subTest(path.name):
                english, german = json.loads(path.read_text()), json.loads((LESSONS / "de" / path.name).read_text())
                self.assertEqual(without_texts(english), without_texts(german))
                self.assertNotEqual(english["title"], german["title"])
                for one, other in zip(english["steps"], german["steps"]):
                    self.assertNotEqual(one["text"], other["text"])
                    self.assertEqual(one["text"].count("\n\n"), other["text"].count("\n\n"), "paragraphs")

    def test_the_page_has_all(self):
        inc = (LESSONS.parents[1] / "client" / "web" / "web_files.inc").read_text()
        paths = set(re.findall(r'"/lessons/((?:de/)?\w+)\.json"', inc)) - {"index"}
        self.assertEqual(paths, {path.stem for path in ENGLISH} | {"de/" + path.stem for path in ENGLISH})

    def test_markdown_is_closed(self):
        for path in LESSONS.rglob("*.json"):
            for step in json.loads(path.read_text())["steps"]:
                for line in step["text"].split("\n"):
                    self.assertEqual(line.replace("**", "").count("*") % 2, 0, (path.name, line))
                    self.assertEqual(line.count("`") % 2, 0, (path.name, line))
                    self.assertNotRegex(line, r"[<#\[]", path.name)


class Command(unittest.TestCase):
    def test_list_names_all(self):
        listed = lesson("list")
        self.assertEqual(listed.returncode, 0, listed.stderr)
        self.assertEqual([line.split(":")[0] for line in listed.stdout.splitlines()], [path.stem for path in ENGLISH])

    def test_handouts_are_in_both_languages(self):
        for language, word in (("en", "My prediction"), ("de", "Meine Vorhersage")):
            handout = lesson("handout", "drift", "--language", language)
            self.assertEqual(handout.returncode, 0, handout.stderr)
            self.assertIn(word, handout.stdout)

    def test_wrong_files_are_refused_with_their_path(self):
        with tempfile.TemporaryDirectory() as folder:
            path = pathlib.Path(folder, "wrong.json")
            path.write_text(ENGLISH[0].read_text().replace('"kind": "number"', '"kind": "guess"', 1))
            refused = lesson("check", path)
            self.assertEqual(refused.returncode, 1)
            self.assertRegex(refused.stderr, r"wrong\.json: invalid lesson\n.*steps\[0\]\.predict\.kind \(line \d+\)")
        self.assertIn("nothing.json", lesson("check", "nothing").stderr)


class Class(export_test.Runs):
    def note(self, client, kind, **note):
        client.call(add_note=c.AddNote(world="w", kind=kind, text=json.dumps(note)))

    def observe(self, client, *expressions):
        return client.call(observe=c.Observe(world="w", expressions=expressions))

    def test_answers_of_a_client_are_collected(self):
        server, client = self.serve()
        self.run_world(client, 3)
        answer = self.observe(client, "fitness_mean[3]", "fitness_mean@1[3]", "fitness_mean[4]",
                              "parameter.population_size")
        values = [one.value if one.HasField("value") else None for one in answer.observations.observations]
        rows = [row for row in csv.DictReader(io.StringIO(self.table(client, table=c.RUN_TABLE_GENERATIONS)[0]))
                if row["generation"] == "3"]
        means = [float(row["fitness_mean"]) for row in rows]
        self.assertEqual(values, [sum(means) / 2, means[1], None, 12])
        self.note(client, "lesson_prediction", lesson="drift", step=2, id="half", value=12)
        self.note(client, "lesson_prediction", lesson="drift", step=7, id="worry", value='=HYPERLINK("x"), "yes"')
        self.note(client, "lesson_observation", lesson="drift", step=2, id="half_100", value=14.5)
        self.note(client, "lesson_answer", lesson="drift", step=2, id="half", predicted=12, observed=14.5, passed=True,
                  apart=-2.5, law=16, error=3)
        client.call(add_note=c.AddNote(world="w", kind="lesson_answer", text="not JSON"))
        server.end()
        done = lesson("report", f"{self.folder}/w.evod", "--csv")
        self.assertEqual(done.returncode, 0, done.stderr)
        half, worry = csv.DictReader(io.StringIO(done.stdout))
        del half["file"], half["run"]
        self.assertEqual(half, {"world": "w", "lesson": "drift", "step": "2", "id": "half", "predicted": "12",
                                "observed": "14.5", "passed": "true", "apart": "-2.5", "law": "16", "error": "3"})
        self.assertEqual((worry["predicted"], worry["observed"]), ('\'=HYPERLINK("x"), "yes"', ""))

    def test_wrong_expressions_are_named(self):
        _, client = self.serve()
        self.run_world(client, 1)
        refused = client.call(INVALID_ARGUMENT, observe=c.Observe(world="w", expressions=["1", "fitnes_mean[1]"]))
        self.assertEqual(refused.status.violations[0].field, "observe.expressions[1]")
        self.assertIn("at character 1", refused.status.violations[0].got)
        self.assertIn("did you mean fitness_mean", refused.status.violations[0].allowed)
        for expressions in ([], ["1"] * 33):
            refused = client.call(INVALID_ARGUMENT, observe=c.Observe(world="w", expressions=expressions))
            self.assertEqual(refused.status.violations[0].field, "observe.expressions")


if __name__ == "__main__":
    unittest.main(argv=[sys.argv[0], *sys.argv[4:]])
