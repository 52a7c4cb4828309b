"""evod without a network, as a user meets it: run, check, parameters. EVOD names the program."""
import csv
import io
import json
import os
import pathlib
import re
import signal
import subprocess
import tempfile
import unittest

import waiting

EVOD = os.environ["EVOD"]
ROOT = pathlib.Path(__file__).resolve().parents[2]


def evod(*arguments, stdin="", status=0):
    done = waiting.run([EVOD, *arguments], input=stdin, capture_output=True, text=True)
    assert done.returncode == status, f"status {done.returncode}, wanted {status}\n{done.stdout}\n{done.stderr}"
    return done


def state(text):
    return re.search(r"state ([0-9a-f]{32})", text).group(1)


class Folder(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.TemporaryDirectory()
        self.addCleanup(self.folder.cleanup)

    def file(self, text, name="mine.json"):
        path = pathlib.Path(self.folder.name) / name
        path.write_text(text)
        return str(path)


class Run(Folder):
    short = ["--set", "generation_s=2", "--set", "population_size=12"]

    def test_every_preset_runs_a_generation(self):
        for path in sorted((ROOT / "experiments").glob("*.json")):
            with self.subTest(path.name):
                done = evod("run", str(path), "--seed", "1", "--generations", "1", "--set", "generation_s=1")
                self.assertIn("ended: generation_limit", done.stdout)
                self.assertIn("M organism-ticks/s", done.stdout)

    def test_the_exit_status_is_the_outcome(self):
        evod("run", "--seed", "1", "--set", "stop_at_target_fitness=true", "--set", "target_fitness=1", *self.short)
        evod("run", "--seed", "1", "--set", "stagnation_limit=2", "--set", "fitness=gene_sum", "--set",
             "mutation_chance=0", status=3)
        evod("run", "--seed", "1", "--set", "stop_at_extinction=true", "--set", "food_count=0", status=4)

    def test_an_interrupt_ends_it_with_the_summary(self):
        process = subprocess.Popen([EVOD, "run", "--seed", "1"], stdout=subprocess.PIPE, text=True)
        lines = []
        while not lines or not re.match(r"\s+1 ", lines[-1]):  # until the first generation is over
            lines.append(process.stdout.readline())
            self.assertTrue(lines[-1], "ended by itself")
        process.send_signal(signal.SIGINT)
        rest = waiting.communicate(process)[0]
        self.assertEqual(process.returncode, 130)
        self.assertIn("ended: interrupted", rest)
        self.assertRegex(rest, "state [0-9a-f]{32}")

    def test_ask_repeats_a_question_after_a_wrong_answer(self):
        # Population, food (twice), poison, time, generations; the rest as proposed.
        answers = "9\nmany\n11\n\n1.5\n1\n" + "\n" * 40
        done = evod("run", "--seed", "1", "--ask", stdin=answers)
        self.assertIn("food_count: got \"many\", allowed a whole number, 0 to", done.stdout)
        for question in ("population_size", "poison_count", "generation_s", "population_model", "selection",
                         "crossover",
                         "rearranging", "creep", "fitness_scaling", "mutation_chance", "survivors"):
            self.assertIn(f"  {question} (", done.stdout)
        same = evod("run", "--seed", "1", "--generations", "1", "--set", "population_size=9", "--set", "food_count=11",
                    "--set", "generation_s=1.5")
        self.assertEqual(state(done.stdout), state(same.stdout))

    def test_control_characters_of_files_are_not_printed(self):
        path = pathlib.Path(self.folder.name) / "steering.json"
        path.write_bytes(b'{"mutation_\\u001b[2Jchance\xc2\x9b31m": 1}')
        said = evod("check", path, status=1)
        self.assertFalse(re.search("[\x00-\x09\x0b-\x1f\x7f-\x9f]", said.stdout + said.stderr), said)

    def test_a_server_checks_options_before_it_opens_files(self):
        data = pathlib.Path(self.folder.name) / "not made"
        for options, words in ((["--bind", "300.1.1.1"], "--bind: got '300.1.1.1', allowed the IP address of an "
                                                         "interface"),
                               (["--http-port", "0", "--http-bind", "x"],
                                "--http-bind: got 'x', allowed the IP address of an interface"),
                               (["--tls-cert", "a.crt"], "--tls-cert requires --tls-key")):
            self.assertIn(words, evod("--port", "0", "--data", data, *options, status=1).stderr)
            self.assertFalse(data.exists())

    def test_wrong_usage_ends_with_status_2(self):
        for arguments in (("--seed", "-1"), ("--generations", "many"), ("--threads", "0"), ("--speed", "2")):
            evod("run", *arguments, status=2)


class Options(Folder):
    def test_options_before_a_subcommand_count_as_its_own(self):
        short = ["--generations", "1", *Run.short]
        self.assertEqual(state(evod("--seed", "7", "run", *short).stdout),
                         state(evod("run", "--seed", "7", *short).stdout))
        evod("--data", self.folder.name, "token", "add", "anna", "--role", "viewer")
        self.assertIn("anna", evod("token", "list", "--data", self.folder.name).stdout)
        self.assertIn("given twice, before run and after it",
                      evod("--seed", "7", "run", "--seed", "7", status=2).stderr)
        said = evod("--data", self.folder.name, "fork", "/nowhere.evod", "--name", "a b", status=1).stderr
        self.assertIn("--name: got \"a b\"", said)

    def test_options_of_the_server_are_refused_by_subcommands(self):
        path = self.file("{}")
        for option, words in ((["--port", "7744"], ["verify", path]), (["--data", self.folder.name], ["run", path]),
                              (["--start"], ["replay", path]),
                              (["--keep-every", "2"], ["export", path, "--what", "events"]),
                              (["--speed", "2"], ["fork", path, "--name", "x"]), (["--seed", "1"], ["check", path]),
                              (["--require-token"], ["token", "list"]),
                              (["--threads", "2"], ["certificate", "localhost"]),
                              (["--log-level", "info"], ["parameters"]), (["--keep-nothing"], ["limits"])):
            command = " ".join(words[:2]) if words[0] == "token" else words[0]
            with self.subTest(command):
                said = evod(*option, *words, status=2).stderr
                self.assertIn(f"{option[0]}: an option of the server that evod {command} does not use: leave it out",
                              said)

    def test_keep_nothing_excludes_options_of_run_files(self):
        for option in (["--durability", "full"], ["--file-bytes-max", "2000000"], ["--keep-every", "2"]):
            self.assertEqual(evod("--keep-nothing", *option, status=2).stderr,
                             f"evod: --keep-nothing: not allowed with {option[0]}\nSee evod --help\n")


class Output(Folder):
    def test_a_server_logs_on_standard_error(self):
        with subprocess.Popen([EVOD, "--port", "0", "--data", self.folder.name], stdout=subprocess.PIPE,
                              stderr=subprocess.PIPE,
                              text=True, env=os.environ | {"EVOD_INSTRUCTIONS": "baseline"}) as server:
            lines = [server.stderr.readline() for _ in range(3)]
            server.terminate()
            printed, logged = waiting.communicate(server)
        self.assertEqual(server.returncode, 0)
        self.assertRegex(lines[1], r" info vector instructions: baseline\n$")
        self.assertRegex(lines[2], r" info evod \S+ listening on 127\.0\.0\.1:\d+, world \"default\", seed \d+\n$")
        self.assertIn(" info stopped\n", logged)
        self.assertEqual(printed, "")

    def log_of_start(self, *options):
        """The lines that a server logs until it listens."""
        with subprocess.Popen([EVOD, "--port", "0", *options], stderr=subprocess.PIPE, text=True) as server:
            lines = []
            for line in server.stderr:
                lines.append(line)
                if " listening on " in line:
                    break
            server.terminate()
            waiting.communicate(server)
        return "".join(lines)

    def test_the_log_names_the_page(self):
        log = self.log_of_start("--keep-nothing", "--web", "--http-port", "0")
        self.assertRegex(log, r" info page at http://127\.0\.0\.1:\d+/\n")
        self.assertNotIn("token", log)

    def test_the_log_says_how_others_open_the_page(self):
        evod("token", "add", "anna", "--role", "viewer", "--data", self.folder.name)
        log = self.log_of_start("--data", self.folder.name, "--http-port", "0", "--http-bind", "0.0.0.0", "--http-host",
                                "lab.example")
        self.assertRegex(log, r" info page at http://lab\.example:\d+/\n.* info other users open "
                              r"http://lab\.example:\d+/#token=TOKEN; "
                              r"evod token add NAME --role viewer makes a token\n")
        self.assertIn("without TLS, any machine on the network path to 0.0.0.0", log)

    def test_vector_instructions_that_are_unknown_are_an_error(self):
        done = waiting.run([EVOD, "parameters"], capture_output=True, text=True,
                           env=os.environ | {"EVOD_INSTRUCTIONS": "mmx"})
        self.assertEqual(done.returncode, 1)
        self.assertRegex(done.stderr, r"^evod: EVOD_INSTRUCTIONS: got mmx, allowed on this processor baseline\b.*\n$")
        self.assertEqual(done.stdout, "")

    def test_a_full_standard_output_is_an_error(self):
        for words in ("parameters",), ("limits",), ("token", "list", "--data", self.folder.name), ("run", *Run.short,
                                                                                                   "--seed",
                                                                                                   "1", "--generations",
                                                                                                   "1"):
            with open("/dev/full", "w") as full:
                done = waiting.run([EVOD, *words], stdout=full, stderr=subprocess.PIPE, text=True)
            self.assertEqual(done.returncode, 1, words)
            self.assertIn("evod: standard output cannot be written", done.stderr)

    def test_an_unknown_command_gets_a_list_of_commands(self):
        said = evod("exprot", status=2).stderr
        self.assertEqual(said, "evod: exprot: unknown command; did you mean export?\nSee evod --help\n")
        self.assertIn("unknown command; commands are run, compare, sweep, ", evod("xxxxxxxx", status=2).stderr)

    def test_an_output_file_error_is_reported_with_its_reason(self):
        self.assertIn(f"--csv: cannot write {self.folder.name}: Is a directory",
                      evod("run", "--csv", self.folder.name, "--generations", "1", status=1).stderr)
        self.assertIn(f"there are no tokens in {self.folder.name}",
                      evod("token", "list", "--data", self.folder.name).stderr)


class Population(Folder):
    heading = "island,organism,normal_speed,impulse,body_size,base_health,food_radius,poison_radius\n"
    two = ["--set", "population_size=2", "--set", "generation_s=1", "--generations", "1", "--seed", "1"]

    def run_with(self, rows, *arguments, status=0):
        return evod("run", "--population", self.file(self.heading + rows, "plate.csv"), *self.two, *arguments,
                    status=status)

    def test_a_run_begins_with_it(self):
        path = self.folder.name + "/run.csv"
        done = self.run_with("0,0,100,110,120,130,140,150\n0,1,101.5,90,80,70.25,60,50\n", "--csv", path)
        row = next(csv.DictReader(io.StringIO(pathlib.Path(path).read_text())))
        self.assertEqual([float(row["normal_speed_" + of]) for of in ("min", "mean", "max")], [100, 100.75, 101.5])
        windows = self.run_with("0,0,100,110,120,130,140,150\r\n0,1,101.5,90,80,70.25,60,50\r\n")
        self.assertEqual(state(done.stdout), state(windows.stdout))
        other = self.run_with("0,0,100,110,120,130,140,150\n0,1,101.5,90,80,70.25,60,51\n")
        self.assertNotEqual(state(done.stdout), state(other.stdout))

    def test_places_without_an_organism_are_filled(self):
        one = self.run_with("0,22,100,110,120,130,140,150\n", "--clone-founders")
        two = self.run_with("0,0,100,110,120,130,140,150\n0,0,100,110,120,130,140,150\n")
        self.assertEqual(state(one.stdout), state(two.stdout))
        drawn = self.run_with("0,22,100,110,120,130,140,150\n")
        self.assertNotEqual(state(drawn.stdout), state(two.stdout))
        plate = self.file(self.heading + "0,3,100,110,120,130,140,150\n", "other.csv")
        both = self.run_with("0,7,100,110,120,130,140,150\n", "--population", plate)
        self.assertEqual(state(both.stdout), state(two.stdout))


class Check(Folder):
    def test_a_valid_file_is_described(self):
        done = evod("check", self.file('{"food_count": 3, "seed": 18446744073709551615, "description": "Few meals."}'))
        self.assertIn("valid\nFew meals.", done.stdout)
        text = done.stdout[done.stdout.index("{"):done.stdout.index("warning: ")]
        self.assertEqual(json.loads(text), {"food_count": 3})

    def test_files_of_windows_and_numpy_are_read(self):
        path = self.folder.name + "/bom.json"
        pathlib.Path(path).write_bytes(b'\xef\xbb\xbf{"population_size": 30.0,\r\n "food_count": 1e2}\r\n')
        self.assertIn('"population_size": 30', evod("check", path).stdout)

    def test_settings_with_which_nothing_evolves_have_warnings(self):
        for text, word in {
            '{"elite_count": 50}': "elite_count 50 is not below population_size 50",
            '{"survivors": 1}': "all organisms survive",
            '{"body_size_min": 150}': "the same body_size",
            '{"seed": 9007199254740992}': "2^53",
        }.items():
            with self.subTest(text):
                path = self.file(text)
                self.assertIn("warning: ", evod("check", path).stdout)
                self.assertIn(word, evod("check", path).stdout)
                ran = evod("run", path, "--generations", "1", "--set", "generation_s=0.1", "--set", "tick_s=0.1")
                self.assertIn("evod: warning: ", ran.stderr)
                self.assertIn(word, ran.stderr)
        self.assertNotIn("warning", evod("check", self.file('{"elite_count": 49, "seed": 7}')).stdout)


class Image(Folder):
    def test_subcommands_get_only_options_they_have(self):
        program = pathlib.Path(self.file("#!/bin/sh\necho \"$@\"\n", "evod"))
        program.chmod(0o755)
        path = f"{self.folder.name}:{os.environ['PATH']}"
        for words, given in ((["--start"], "--bind 0.0.0.0 --data /data --start"), ([], "--bind 0.0.0.0 --data /data"),
                             (["replay", "x.evod"], "--bind 0.0.0.0 --data /data replay x.evod"),
                             (["token", "list"], "--data /data token list"), (["verify", "x.evod"], "verify x.evod"),
                             (["fork", "x.evod", "--name", "y"], "--data /data fork x.evod --name y")):
            done = subprocess.run([ROOT / "docker/entrypoint", *words], capture_output=True, text=True, check=True,
                                  env={**os.environ, "PATH": path})
            self.assertEqual(done.stdout.strip(), given)


class Documents(unittest.TestCase):
    """They contain what the program prints."""

    def test_parameters(self):
        self.assertEqual((ROOT / "docs/PARAMETERS.md").read_text(), evod("parameters").stdout)

    def test_limits(self):
        self.assertIn("\n\n" + evod("limits").stdout + "\n", (ROOT / "docs/OPERATIONS.md").read_text())


if __name__ == "__main__":
    unittest.main()
