"""evoctl as a user meets it: every command against a real server, right and wrong. EVOD and EVOCTL name the
programs."""
import contextlib
import csv
import fcntl
import io
import json
import os
import pathlib
import pty
import re
import signal
import struct
import subprocess
import tempfile
import termios
import unittest

import waiting

EVOD, EVOCTL = os.environ["EVOD"], os.environ["EVOCTL"]
ROOT = pathlib.Path(__file__).resolve().parents[2]


class WithServer(unittest.TestCase):
    """Each test has a server of its own, on a port that the system chose."""

    options = ["--seed", "1", "--speed", "max"]

    def setUp(self):
        data = tempfile.TemporaryDirectory()
        self.addCleanup(data.cleanup)
        self.server = subprocess.Popen([EVOD, "--port", "0", "--data", data.name, *self.options],
                                       stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
        self.addCleanup(self.end_server)
        for line in self.server.stdout:
            if found := re.search(r"listening on 127\.0\.0\.1:(\d+)", line):
                self.address = "127.0.0.1:" + found.group(1)
                return
        self.fail("the server did not start")

    def end_server(self):
        self.server.terminate()
        self.server.stdout.read()
        self.server.stdout.close()
        self.assertEqual(waiting.ended(self.server), 0)

    def evoctl(self, *words, status=0):
        done = waiting.run([EVOCTL, "--server", self.address, *waiting.PATIENT, *words], capture_output=True, text=True)
        self.assertEqual(done.returncode, status, f"{words}\n{done.stdout}\n{done.stderr}")
        return done.stdout if status == 0 else done.stderr

    def answer(self, *words):
        return json.loads(self.evoctl("--json", *words))


class Durability(WithServer):
    options = [*WithServer.options, "--durability", "relaxed"]

    def test_relaxed_durability_is_shown(self):
        self.assertIn("\ndurability relaxed: ", self.evoctl("status"))


class Commands(WithServer):
    def test_full_durability_is_not_mentioned(self):
        self.assertNotIn("durability", self.evoctl("status"))

    def test_generations_are_run_and_printed(self):
        self.evoctl("run", "3", "--wait")
        rows = list(csv.DictReader(io.StringIO(self.evoctl("history", "--csv"))))
        self.assertEqual([row["generation"] for row in rows], ["1", "2", "3"])
        self.assertEqual(
            len(list(csv.DictReader(io.StringIO(self.evoctl("history", "--csv", "--from", "2", "--to", "2"))))), 1)
        self.assertRegex(self.evoctl("stats"), r"waiting")
        self.assertIn("food_radius", self.evoctl("organism", "3"))
        self.assertIn("organism", self.evoctl("organism", "5000", status=1))

    def test_organism_shows_what_its_network_does(self):
        self.evoctl("create", "networks", "--seed", "4", "--set", "controller=network", "brain_hidden=2")
        self.assertRegex(self.evoctl("--world", "networks", "organism", "3"),
                         r"px/s, heading -?[0-9.]+°\n  next tick: steers with its neural network\n"
                         r"  inputs: food_bearing \S+, food_proximity \S+, poison_bearing \S+, poison_proximity \S+\n"
                         r"  hidden: hidden1 \S+, hidden2 \S+\n  outputs: thrust \S+, turn \S+\n")
        rules = self.evoctl("organism", "3")
        self.assertNotIn("heading", rules)
        self.assertRegex(rules, "next tick: (wanders|seeks food at|flees from poison at)")
        self.evoctl("delete", "networks")

    def test_an_earlier_tick_is_refused(self):
        self.evoctl("step", "60")
        self.evoctl("run")
        self.assertIn("until: the run is at tick ", self.evoctl("until", "5", status=1))
        self.assertEqual(self.answer("speed", "1")["world"]["state"], "RUN_STATE_RUNNING")

    def test_until_stops_at_its_tick_or_changes_nothing(self):
        self.evoctl("speed", "max")
        for ahead in range(0, 40_000, 2_000):  # some of these ticks pass between the requests of `until`
            self.evoctl("run")
            tick = int(self.answer("stats")["world"]["tick"]) + ahead
            done = waiting.run([EVOCTL, "--server", self.address, *waiting.PATIENT, "until", str(tick), "--wait"],
                               capture_output=True, text=True)
            world = self.answer("stats")["world"]
            if done.returncode == 0:
                self.assertEqual((world["state"], int(world["tick"])), ("RUN_STATE_PAUSED", tick))
            else:
                self.assertIn(f"got {tick}, allowed ", done.stderr)
                self.assertEqual(world["state"], "RUN_STATE_RUNNING")

    def test_with_json_errors_are_json(self):
        refused = json.loads(self.evoctl("--json", "--world", "no-such-world", "pause", status=1))
        self.assertEqual((refused["code"], refused["reason"], refused["violations"][0]["got"]),
                         ("CODE_NOT_FOUND", "REASON_WORLD_NOT_FOUND", "no-such-world"))
        wrong = json.loads(self.evoctl("--json", "set", "mutation_chanc=1", status=2))
        self.assertIn("did you mean mutation_chance", wrong["message"])

    def test_steps_are_exact_and_a_reset_repeats_them(self):
        self.evoctl("step", "60")
        first = self.answer("pause")["world"]
        self.assertEqual((first["tick"], first["state"]), (60, "RUN_STATE_PAUSED"))
        self.evoctl("reset")
        self.evoctl("until", "60")
        self.evoctl("step", "1")
        self.evoctl("reset", "--seed", "1")
        self.evoctl("step", "60")
        again = self.answer("pause")["world"]
        self.assertEqual((again["tick"], again["state_hash"]), (first["tick"], first["state_hash"]))
        self.assertNotEqual(again["run_id"], first["run_id"])
        self.evoctl("reset", "--seed", "2")
        self.evoctl("step", "60")
        self.assertNotEqual(self.answer("pause")["world"]["state_hash"], first["state_hash"])

    def test_run_pause_resume_and_speed(self):
        self.evoctl("speed", "2")
        self.evoctl("run")
        self.assertEqual(self.answer("pause")["world"]["state"], "RUN_STATE_PAUSED")
        self.assertEqual(self.answer("resume")["world"]["state"], "RUN_STATE_RUNNING")
        self.assertEqual(self.answer("speed", "max")["world"]["speed"], {"max": True})
        self.evoctl("pause")
        self.evoctl("reset")
        self.assertIn("evoctl: nothing to resume: ", self.evoctl("resume", status=1))
        self.evoctl("speed", "0", status=2)
        self.evoctl("speed", "fast", status=2)

    def test_a_world_behind_its_pace_is_marked_slower(self):
        self.evoctl("speed", "10000")
        self.evoctl("run")
        waiting.until(lambda: "10000× (slower)" in self.evoctl("status"), "it is measured")

    def test_parameters_are_set_all_or_none(self):
        self.evoctl("set", "selection=tournament", "mutation_chance=0.05", "mutate_survivors=true", "tournament_size=4")
        reported = self.evoctl("get", "selection", "mutation_chance", "mutate_survivors", "tournament_size")
        self.assertEqual(reported.split(), ["selection=tournament", "mutation_chance=0.05", "mutate_survivors=true",
                                        "tournament_size=4"])
        wrong = self.evoctl("set", "mutation_chance=2", "survivors=0.25", "restitution=-1", status=2)
        self.assertEqual(wrong, "evoctl: invalid parameter values\n  mutation_chance: got 2, allowed 0 to 1\n"
                                "  restitution: got -1, allowed 0 to 1\n")
        self.assertEqual(self.evoctl("get", "survivors").strip(), "survivors=0.5")
        self.evoctl("set", "--dry-run", "survivors=0.25")
        self.assertEqual(self.evoctl("get", "survivors").strip(), "survivors=0.5")
        self.evoctl("set", "--if-revision", "1", "survivors=0.25", status=1)
        self.evoctl("set", "--if-revision", "2", "survivors=0.25")
        self.assertEqual(self.evoctl("get", "survivors").strip(), "survivors=0.25")
        self.assertIn("did you mean", self.evoctl("set", "mutation_chanse=0.1", status=2))
        registry = {line.split()[0] for line in self.evoctl("params").splitlines() if line}
        self.assertLessEqual({"population_size", "mutation_chance", "flee_rule", "migration"}, registry)
        self.assertIn("tournament", self.evoctl("params", "selection"))

    def test_set_says_when_a_value_takes_effect(self):
        self.assertEqual(self.evoctl("set", "fitness=gene_sum", "survivors=0.25").splitlines()[:2],
                         ["fitness: gene_sum after the next reset (now life)", "survivors=0.25"])
        self.evoctl("step", "1")
        self.assertIn("food_count: 7 from the next generation (now 25)\n", self.evoctl("set", "food_count=7"))
        self.evoctl("reset")
        self.assertEqual(self.evoctl("get", "fitness"), "fitness=gene_sum\n")

    def test_settings_without_evolution_are_warned_about(self):
        done = waiting.run([EVOCTL, "--server", self.address, *waiting.PATIENT, "set", "elite_count=50"],
                           capture_output=True, text=True, check=True)
        self.assertEqual(done.stderr, "evoctl: warning: no child is ever bred, because elite_count 50 is not below "
                                      "population_size 50\n")
        self.assertIn("elite_count", done.stdout)

    def test_errors_name_what_was_typed(self):
        for words, error in (
                (["speed", "0"], "SPEED: got 0, allowed 0.001 to 10000"),
                (["speed", "fast"], "SPEED: got fast, allowed max, or 0.001 to 10000, such as 2 for twice real time"),
                (["create", "no/slash"], 'NAME: got "no/slash", allowed 1 to 64 of a-z A-Z 0-9 _ -'),
                (["set", "--at-generation", "0", "survivors=1"],
                 "invalid planned change\n  --at-generation: got 0, allowed at least 2"),
                (["set", "mutation_chanse=1"], "mutation_chanse: unknown parameter; did you mean mutation_chance?"),
                (["status", "--iland"], "--iland: unknown option\nSee evoctl status --help")):
            self.assertEqual(self.evoctl(*words, status=2), f"evoctl: {error}\n")
        with tempfile.TemporaryDirectory() as folder:
            path = pathlib.Path(folder) / "wrong.json"
            path.write_text('{"survivors": 3}')
            self.assertEqual(self.evoctl("create", "x", "--experiment", str(path), status=2),
                             "evoctl: --experiment: survivors (line 1): got 3, allowed 0 to 1\n")
        self.assertEqual(self.evoctl("organism", "5000", status=1),
                         "evoctl: no such organism\n  ID: got 5000, allowed 0 to 49\n")

    def test_run_wait_says_how_long_it_takes(self):
        def said(*words):
            return waiting.run([EVOCTL, "--server", self.address, *waiting.PATIENT, *words], capture_output=True,
                               text=True,
                               check=True).stderr.splitlines()
        self.evoctl("speed", "1")
        self.evoctl("set", "generation_s=1.5")
        self.evoctl("reset")
        self.assertEqual(said("run", "2", "--wait")[0], "at 1×, a generation of 1.5 s takes 1.5 s: 2 generations take "
                                                        "about 3.0 s; "
                                                        "evoctl speed max is faster")
        self.evoctl("speed", "100")
        lines = said("run", "2", "--wait")
        self.assertEqual(lines[0], "at 100×, a generation of 1.5 s takes 0.0 s: 2 generations take about 0.0 s")
        self.assertEqual([line.split(":")[0] for line in lines[1:]], ["generation 3", "generation 4"])
        self.evoctl("speed", "2")
        shown = self.on_terminal("run", "1", "--wait")
        self.assertRegex(shown, r"\r\x1b\[K\[█[^\]]*\] \d+ %, \d.* left")
        self.assertRegex(shown, r"\] 100 %")

    def on_terminal(self, *words, **environment):
        """What evoctl prints if all its streams are a terminal."""
        own, other = pty.openpty()
        self.addCleanup(os.close, own)
        with subprocess.Popen([EVOCTL, "--server", self.address, *waiting.PATIENT, *words], stdin=other, stdout=other,
                              stderr=other, env={**os.environ, **environment}) as process:
            os.close(other)
            shown = b""
            with contextlib.suppress(OSError):  # EIO after the last output
                while part := os.read(own, 10_000):
                    shown += part
            waiting.ended(process)
        return shown.decode()

    def test_colours_are_for_terminals_only(self):
        self.evoctl("run")
        self.assertIn("\x1b[32mrunning\x1b[0m", self.on_terminal("status", NO_COLOR=""))
        self.assertIn("\x1b[31mevoctl:\x1b[0m no world has that name\r\n  --world: got nowhere",
                      self.on_terminal("--world", "nowhere", "pause", NO_COLOR=""))
        for words in (["status"], ["--world", "nowhere", "pause"]):
            self.assertNotIn("\x1b", self.on_terminal(*words, NO_COLOR="1"))
            done = waiting.run([EVOCTL, "--server", self.address, *waiting.PATIENT, *words], capture_output=True,
                               text=True)
            self.assertNotIn("\x1b", done.stdout + done.stderr)

    def test_worlds_are_created_named_and_deleted(self):
        with tempfile.TemporaryDirectory() as folder:
            path = pathlib.Path(folder) / "small.json"
            path.write_text('{"population_size": 7, "seed": 5, "description": "A few."}')
            self.evoctl("create", "small", "--experiment", str(path), "--set", "food_count=9")
        self.evoctl("create", "other", "--seed", "6", "--set", "population_size=8")
        self.assertEqual(self.evoctl("worlds").split(), ["default", "other", "small"])
        self.assertEqual(self.evoctl("--world", "small", "get", "population_size", "food_count").split(),
                         ["population_size=7", "food_count=9"])
        self.assertIn("NAME: got other, allowed an unused name", self.evoctl("create", "other", status=1))
        self.evoctl("create", "no/slash", status=2)
        self.evoctl("--world", "other", "speed", "max")  # a new world has the pace of real time
        self.evoctl("--world", "other", "run", "1", "--wait")
        self.assertIn("GENERATION", self.evoctl("--world", "other", "history"))
        self.evoctl("delete", "other")
        self.assertIn("--world: got other, allowed default, small", self.evoctl("--world", "other", "pause", status=1))
        self.assertEqual(self.evoctl("worlds").split(), ["default", "small"])

    def test_forks_start_at_a_generation_or_now(self):
        self.evoctl("run", "3", "--wait")
        self.evoctl("fork", "default", "--at-generation", "2", "--name", "then")
        self.evoctl("fork", "then", "--name", "later")
        self.evoctl("--world", "default", "fork", "--name", "now")
        self.assertEqual([self.answer("--world", name, "stats")["world"]["generation"] for name in
                          ("then", "later", "now")], [2, 2, 3])
        self.assertIn("--name: got nothing, a value is required", self.evoctl("fork", "other", status=2))
        self.assertIn("WORLD: got nowhere, allowed ", self.evoctl("fork", "nowhere", "--name", "x", status=1))
        self.assertIn("--at-generation: got 9, allowed 1 to 3",
                      self.evoctl("fork", "default", "--at-generation", "9", "--name", "x", status=1))

    def test_speeds_are_spelled_as_in_the_page(self):
        for factor, text in json.loads((ROOT / "proto/vectors/speeds.json").read_text()):
            for word in (str(factor), text, text.replace("×", "x")):
                self.assertIn(f"waiting at {text}, ", self.evoctl("speed", word))
            self.assertEqual(self.answer("stats")["world"]["speed"], {"real_time_factor": factor})

    def test_a_world_is_named_by_value_or_option(self):
        listing = self.evoctl("--help")
        commands = re.findall(r"^  ([a-z]+) {2,}\S", listing, re.M)
        self.assertIn("fork", commands)
        value_of = {"create": "NAME", "delete": "WORLD", "fork": "WORLD"}  # those whose value names a world
        for command in commands:
            usage = self.evoctl(command, "--help").split("\n\n")[0]
            if command not in value_of:
                self.assertNotIn("WORLD", usage, command)
        further = {"fork": ("--name", "forked")}
        for command, value in value_of.items():
            rest = further.get(command, ())
            for given in (("{}",), ("--world", "{}"), ("{}", "--world", "{}")):
                for before in (True, False):  # the options of evoctl stand before the command or after it
                    with self.subTest(command, given=given, before=before):
                        self.evoctl("create", "forked" if command == "create" else "one")
                        name = "one"
                        words = [word.format(name) for word in given]
                        options = words[words.index("--world"):] if "--world" in words else []
                        values = words[:len(words) - len(options)]
                        self.evoctl(*(options if before else ()), command, *values, *rest,
                                    *(() if before else options))
                        for world in self.evoctl("worlds").split():
                            if world != "default":
                                self.evoctl("delete", world)
            self.assertIn(f"{value} and --world name two worlds: got one and two, allowed one",
                          self.evoctl("--world", "two", command, "one", *rest, status=2))
            self.assertIn(f"{value} and --world name two worlds: got one and two, allowed one",
                          self.evoctl(command, "one", *rest, "--world", "two", status=2))
        for command in ("create", "delete"):
            self.assertIn(f"{value_of[command]}: got nothing, a value is required", self.evoctl(command, status=2))

    def test_earlier_generations_are_shown(self):
        self.evoctl("create", "small", "--seed", "3", "--set", "generation_s=2")
        self.evoctl("--world", "small", "speed", "max")
        self.evoctl("--world", "small", "run", "3", "--wait")
        small = lambda *words: self.answer("--world", "small", *words)
        now = small("organism", "3")
        self.assertEqual(small("organism", "3", "--at-generation", "3", "--at-tick", "120"), now)
        self.assertEqual(small("organism", "3", "--at-tick", "360"), now)
        born = small("organism", "3", "--at-generation", "2")
        self.assertEqual((born["generation"], born["lived_s"], born["alive"]), (2, 0, True))
        then = small("stats", "--at-generation", "3", "--at-tick", "60")
        self.assertEqual((then["world"]["generation"], then["world"]["tick"]), (3, 300))
        self.assertEqual(then["last"][0]["generation"], 2)
        reported = self.evoctl("--world", "small", "stats", "--at-generation", "3", "--at-tick", "60")
        self.assertIn("small as it was: generation 3, tick 300", reported)
        self.assertIn("\nthen\n", reported)
        self.assertIn("small as it was: generation 2, tick 120",
                      self.evoctl("--world", "small", "organism", "3", "--at-generation", "2"))
        self.assertIn("--at-generation: got 9, allowed 1 to 3",
                      self.evoctl("--world", "small", "stats", "--at-generation", "9", status=1))
        self.assertEqual(self.evoctl("worlds").split(), ["default", "small"])

    def test_live_output_fits_a_small_terminal(self):
        self.evoctl("run", "2", "--wait")
        for command in ["watch"], ["top", "--interval", "0.1"]:
            for lines, columns in ((24, 80), (6, 30), (2, 10), (1, 1)):
                with self.subTest(command=command[0], lines=lines, columns=columns):
                    own, other = pty.openpty()
                    fcntl.ioctl(other, termios.TIOCSWINSZ, struct.pack("HHHH", lines, columns, 0, 0))
                    process = subprocess.Popen([EVOCTL, "--server", self.address, *command], stdin=other, stdout=other,
                                               stderr=subprocess.DEVNULL)
                    os.close(other)
                    said = b""
                    while said.count(b"\x1b[J") < 4:  # three drawings that are whole
                        said += os.read(own, 1 << 16)
                    process.send_signal(signal.SIGINT)
                    with contextlib.suppress(OSError):
                        while os.read(own, 1 << 16):
                            pass
                    os.close(own)
                    self.assertEqual(waiting.ended(process), 0)
                    pages = said.decode().split("\x1b[J")[1:4]
                    for page in pages:
                        drawn = re.sub(r"\x1b\[\d*[AH]|\r", "", page).split("\n")
                        self.assertLessEqual(len(drawn), lines)
                        self.assertLessEqual(max(map(len, drawn)), columns)
                        self.assertTrue(drawn[0])

    def test_unreadable_files_and_full_output_are_reported(self):
        with tempfile.TemporaryDirectory() as folder:
            for option, what in ("--experiment", "experiment"), ("--population", "population"):
                for path, why in (folder, "this is a folder"), (folder + "/none",
                                                                "cannot be read: No such file or directory"):
                    self.assertIn(f"{path}: {why}", self.evoctl("create", "x", option, path, status=2))
            pipe, large = folder + "/pipe", folder + "/large"
            os.mkfifo(pipe, 0o600)
            with open(large, "wb") as file:
                file.truncate(1 << 33)  # takes no space
            for path, why in (pipe, "this is a pipe"), ("/dev/zero", "this is a device"), (large, "too large for "):
                for words in (["create", "x", "--experiment", path], ["create", "x", "--population", path],
                              ["rate", path],
                              ["place", "organism", "30,40", "--from", path], ["--token-file", path, "status"],
                              ["--ca", path, "status"], ["--tls", "--cert", path, "status"]):
                    if (words[0], why) != ("--token-file", "too large for "):  # other users can read it
                        status = 3 if "status" in words and words[0] != "--token-file" else 2
                        self.assertIn(why, self.evoctl(*words, status=status), words)
        self.assertIn("--key: mine.key requires the certificate of this key: give --cert",
                      self.evoctl("--key", "mine.key", "status", status=2))
        with open("/dev/full", "w") as full:
            for words in (["params"], ["--json", "describe"], ["worlds"]):
                done = waiting.run([EVOCTL, "--server", self.address, *waiting.PATIENT, *words], stdout=full,
                                   stderr=subprocess.PIPE, text=True)
                self.assertEqual(done.returncode, 1)
                self.assertIn("standard output cannot be written", done.stderr)

    def test_watch_and_events_follow(self):
        self.evoctl("run")
        self.assertEqual(len(self.evoctl("watch", "--generations", "3").strip().splitlines()), 3)
        own, other = pty.openpty()
        self.addCleanup(os.close, own)
        with subprocess.Popen([EVOCTL, "--server", self.address, *waiting.PATIENT, "watch", "--generations", "3"],
                              stdin=other, stdout=other) as watching:
            self.assertEqual(waiting.ended(watching), 0)
        os.close(other)
        shown = ""
        with contextlib.suppress(OSError):  # EIO after the last output
            while part := os.read(own, 10_000).decode():
                shown += part
        self.assertEqual((len(shown.strip().splitlines()), "\x1b" in shown), (3, False), shown)
        events = [json.loads(line) for line in self.evoctl("--json", "events", "--count", "3").splitlines()]
        self.assertEqual(len(events), 3)

    def test_it_describes_and_completes(self):
        self.assertIn("1.0.0", self.evoctl("describe"))
        for words, offered in ((["set", "mutation_ch"], ["mutation_chance="]),
                               (["set", "selection=r"], ["selection=roulette",
                                "selection=random"]), (["get", "mutation_ch"], ["mutation_chance"]),
                               (["delete", "d"], ["default"]),
                               (["--world", "d"], ["default"]), (["create", "x", "--set", "food_cou"], ["food_count="]),
                               (["speed", "m"], ["max"])):
            done = self.evoctl_completes("--server", self.address, *words)
            self.assertEqual([line.split("\t")[0] for line in done.splitlines()], offered)

    def evoctl_completes(self, *words):
        return waiting.run([EVOCTL, "complete", "--", *words], capture_output=True, text=True, check=True).stdout


class WithoutServer(unittest.TestCase):
    def test_without_a_server_it_says_how_to_start_one(self):
        done = waiting.run([EVOCTL, "--server", "127.0.0.1:1", "status"], capture_output=True, text=True)
        self.assertEqual(done.returncode, 3)
        self.assertIn("127.0.0.1:1", done.stderr)
        self.assertIn("evod", done.stderr)

    def test_wrong_usage_is_reported_before_connecting(self):
        for words in (["dance"], ["run", "-1"], ["step", "many"], ["create"], []):
            done = waiting.run([EVOCTL, "--server", "127.0.0.1:1", *words], capture_output=True, text=True)
            self.assertEqual(done.returncode, 2, words)

    def test_a_token_on_the_command_line_is_refused(self):
        for words in (["--token", "evod_secret", "worlds"], ["--token=evod_secret", "worlds"]):
            done = waiting.run([EVOCTL, "--server", "127.0.0.1:1", *words], capture_output=True, text=True)
            self.assertEqual(done.returncode, 2, words)
            self.assertIn("EVOD_TOKEN", done.stderr)
            self.assertNotIn("secret", done.stderr)


unittest.main()
