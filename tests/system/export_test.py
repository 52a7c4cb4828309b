"""Tables of a run over real sockets: ExportRun, ContinueExport and evoctl export. EVOD and EVOCTL name the programs,
MESSAGES the folder of the message classes."""
import contextlib
import pathlib
import shutil
import signal
import sqlite3
import subprocess
import sys
import unittest

import past_test as past
import waiting
from past_test import CREATE, EVOD, EVOCTL, c, plain, w

WHATS = {"generations": c.RUN_TABLE_GENERATIONS, "organisms": c.RUN_TABLE_ORGANISMS, "lineage": c.RUN_TABLE_LINEAGE,
         "population": c.RUN_TABLE_POPULATION, "events": c.RUN_TABLE_EVENTS,
         "notes": c.RUN_TABLE_NOTES}
INVALID_ARGUMENT, NOT_FOUND, FAILED_PRECONDITION = 3, 5, 9


def copies_in(folder):
    return [path.name for path in pathlib.Path(folder).glob("*.evod.copy-*")]


class Runs(past.Case):
    def serve(self, *options):
        server = self.server("--data", self.folder, "--speed", "max", *options)
        client = self.client(server)
        return server, client

    def run_world(self, client, generations, **parameters):
        client.call(create_world=c.CreateWorld(name="w", seed=5,
                                               parameters=plain.assignments(**{**CREATE, **parameters})))
        client.call(set_speed=c.SetSpeed(world="w", speed=w.Speed(max=True)))
        client.call(run=c.Run(world="w", generations=generations))
        plain.until(lambda: client.world("w").state == w.RUN_STATE_WAITING, "generations")

    def table(self, client, **export):
        """The whole table, in how many parts."""
        part = client.call(export_run=c.ExportRun(format=c.TEXT_FORMAT_CSV, **{"world": "w", **export})).export_part
        text, parts = part.text, 1
        while not part.last:
            part = client.call(continue_export=c.ContinueExport(export_id=part.export_id)).export_part
            parts += 1
            text += part.text
        return text.decode(), parts

    def evod_export(self, *words):
        done = waiting.run([EVOD, "export", f"{self.folder}/w.evod", *words], capture_output=True, text=True)
        self.assertEqual(done.returncode, 0, done.stderr)
        return done.stdout


class Damaged(Runs):
    def test_what_is_damaged_is_named_and_the_rest_written(self):
        server, client = self.serve()
        self.run_world(client, 5)
        server.end()
        sound = self.evod_export("--what", "events")
        path = pathlib.Path(self.folder, "w.evod")
        with contextlib.closing(sqlite3.connect(path, isolation_level=None)) as run:
            run.execute("DELETE FROM statistics WHERE generation = 3")
        for words, written in ((["--what", "events"], sound), (["--bundle", f"{self.folder}/bundle"], "")):
            with self.subTest(words):
                done = waiting.run([EVOD, "export", path, *words], capture_output=True, text=True)
                self.assertEqual((done.returncode, done.stdout), (1, written))
                self.assertIn("is damaged: ", done.stderr)
        self.assertFalse(pathlib.Path(self.folder, "bundle").exists())


class Interrupted(Runs):
    def test_unfinished_output_is_not_left_behind(self):
        server, client = self.serve()
        self.run_world(client, 100, generation_s=1.0)
        server.end()
        run = pathlib.Path(self.folder, "w.evod")
        for words, name in ((["--bundle"], "bundle"), (["--what", "organisms", "--output"], "organisms.csv")):
            whole, part = pathlib.Path(self.folder, name), pathlib.Path(self.folder, name + ".part")
            for how in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP, signal.SIGKILL):
                with subprocess.Popen([EVOD, "export", run, *words, whole]) as export:
                    self.addCleanup(export.kill)
                    first = part / "experiment.json" if name == "bundle" else part
                    waiting.until(lambda: export.poll() is not None or first.exists(), "a part of the output")
                    export.send_signal(how)
                    if waiting.ended(export) == 0:  # it was complete before the signal
                        shutil.rmtree(whole) if whole.is_dir() else whole.unlink()
                        continue
                with self.subTest(name=name, how=how):
                    self.assertFalse(whole.exists())
                    self.assertEqual(part.exists(), how == signal.SIGKILL)
            self.evod_export(*words, str(whole))
            self.assertTrue(whole.exists())
            self.assertFalse(part.exists())


class Export(Runs):
    def evoctl(self, server, *words, status=0):
        done = waiting.run([EVOCTL, "--server", f"localhost:{server.port}", *waiting.PATIENT, "--world", "w", "export",
                            *words], capture_output=True, text=True)
        self.assertEqual(done.returncode, status, done.stdout + done.stderr)
        return done.stderr if status else done.stdout

    def refused(self, client, code, field, **export):
        answer = client.call(code, export_run=c.ExportRun(**{"world": "w", "format": c.TEXT_FORMAT_CSV, **export}))
        self.assertEqual([violation.field for violation in answer.status.violations], ["export_run." + field])

    def test_every_table_is_the_one_that_evod_export_writes(self):
        server, client = self.serve()
        self.run_world(client, 5)
        client.call(add_note=c.AddNote(world="w", kind="answer", text='5, because "more" is better\n'))
        self.assertEqual(self.table(client, table=c.RUN_TABLE_NOTES)[0].splitlines()[0],
                         "number,tick,generation,sender,user,kind,text")
        self.assertIn(',5,client,,answer,"5, because ""more"" is better\n"\n', self.evod_export("--what", "notes"))
        for what, table in WHATS.items():
            # At once, and of a file that lags behind otherwise.
            text, _ = self.table(client, table=table)
            self.assertEqual(text, self.evod_export("--what", what))
            self.assertEqual(self.evoctl(server, "--what", what, "--format", "jsonl"),
                             self.evod_export("--what", what, "--format", "jsonl"))
        of = c.OrganismName(generation=4, island=1, organism=3)
        self.assertEqual(self.table(client, table=c.RUN_TABLE_LINEAGE, of=of)[0],
                         self.evod_export("--what", "lineage", "--of", "4:1:3"))
        self.assertEqual(self.evoctl(server, "--what", "lineage", "--of", "4:1:3"),
                         self.evod_export("--what", "lineage", "--of", "4:1:3"))
        heading, *rows = self.evod_export("--what", "lineage").splitlines()
        later = [row for row in rows if int(row.split(",")[0]) >= 3]
        self.assertEqual(self.table(client, table=c.RUN_TABLE_LINEAGE, first_generation=3)[0].splitlines(),
                         [heading, *later])
        ancestors = [row for row in self.evod_export("--what", "lineage", "--of", "4:1:3").splitlines()
                     if row[0] not in "12"]
        self.assertEqual(self.table(client, table=c.RUN_TABLE_LINEAGE, of=of, first_generation=3)[0].splitlines(),
                         ancestors)
        self.assertEqual(self.evoctl(server, "--what", "population", "--generation", "2"),
                         self.evod_export("--what", "population", "--generation", "2"))

    def test_a_copy_of_the_file_is_a_run_file(self):
        server, client = self.serve()
        self.run_world(client, 30)
        client.call(run=c.Run(world="w"))
        copy = pathlib.Path(self.folder, "copy.evod")
        self.evoctl(server, "--what", "file", "--output", copy)
        self.assertEqual(copies_in(self.folder), [])
        client.call(pause=c.Pause(world="w"))
        verified = waiting.run([EVOD, "verify", copy], capture_output=True, text=True)
        self.assertEqual(verified.returncode, 0, verified.stderr)
        with contextlib.closing(sqlite3.connect(copy)) as run:
            self.assertEqual({key for key, in run.execute("SELECT client_key FROM journal")}, {"exported"})
        replayed = self.client(self.server("replay", copy))
        self.assertEqual(replayed.world("w").name, "w")
        data = pathlib.Path(self.folder, "continued")
        data.mkdir()
        shutil.copy(copy, data / "w.evod")
        continued = self.client(self.server("--data", data))
        continued.call(run=c.Run(world="w", generations=1))
        self.assertIn("not with --what file", self.evoctl(server, "--what", "file", "--format", "jsonl", status=2))
        self.refused(client, INVALID_ARGUMENT, "format", table=c.RUN_TABLE_FILE)

    def test_copies_do_not_outlive_their_client_or_a_kill(self):
        server, client = self.serve()
        self.run_world(client, 5)
        client.call(run=c.Run(world="w"))
        for _ in range(5):
            gone = self.client(server)
            gone.ask(export_run=c.ExportRun(world="w", table=c.RUN_TABLE_FILE))
            gone.socket.close()
        plain.until(lambda: not copies_in(self.folder), "no copies")
        for _ in range(5):
            self.client(server).ask(export_run=c.ExportRun(world="w", table=c.RUN_TABLE_FILE))
        server.kill()
        pathlib.Path(self.folder, "w.evod.copy-1a2B3c").write_text("left by a kill")
        self.serve()
        self.assertEqual(copies_in(self.folder), [])

    def test_a_running_world_can_be_exported(self):
        _, client = self.serve()
        self.run_world(client, 30)
        client.call(run=c.Run(world="w"))
        text, _ = self.table(client, table=c.RUN_TABLE_GENERATIONS)
        self.assertGreaterEqual(text.count("\n"), 1 + 2 * 30)
        tick = client.world("w").tick
        plain.until(lambda: client.world("w").tick > tick, "ticks")
        client.call(pause=c.Pause(world="w"))
        self.assertTrue(self.table(client, table=c.RUN_TABLE_GENERATIONS)[0].startswith(text))

    def test_a_replay_can_be_exported(self):
        server, client = self.serve()
        self.run_world(client, 4)
        live, _ = self.table(client, table=c.RUN_TABLE_ORGANISMS)
        replay = client.call(open_replay=c.OpenReplay(world="w")).world.name
        self.assertEqual(self.table(client, world=replay, table=c.RUN_TABLE_ORGANISMS)[0], live)
        server.end()
        replayed = self.client(self.server("replay", f"{self.folder}/w.evod"))
        self.assertEqual(self.table(replayed, table=c.RUN_TABLE_ORGANISMS)[0], live)

    def test_errors_name_the_field(self):
        server, client = self.serve()
        self.run_world(client, 2)
        events = {"table": c.RUN_TABLE_EVENTS}
        self.refused(client, INVALID_ARGUMENT, "table")
        self.refused(client, INVALID_ARGUMENT, "table", table=99)
        self.refused(client, INVALID_ARGUMENT, "format", format=0, **events)
        self.refused(client, INVALID_ARGUMENT, "generation", generation=1, **events)
        self.refused(client, INVALID_ARGUMENT, "of", of=c.OrganismName(generation=1), **events)
        self.refused(client, INVALID_ARGUMENT, "first_generation", first_generation=1, **events)
        self.refused(client, NOT_FOUND, "first_generation", table=c.RUN_TABLE_LINEAGE, first_generation=9)
        self.refused(client, NOT_FOUND, "world", **{**events, "world": "unknown"})
        self.refused(client, NOT_FOUND, "generation", table=c.RUN_TABLE_POPULATION, generation=9)
        for field, of in (("generation", (9, 0, 0)), ("island", (1, 2, 0)), ("organism", (1, 0, 12))):
            name = c.OrganismName(generation=of[0], island=of[1], organism=of[2])
            self.refused(client, NOT_FOUND, "of." + field, table=c.RUN_TABLE_LINEAGE, of=name)
        self.assertIn("got 9, allowed", self.evoctl(server, "--what", "population", "--generation", "9", status=1))
        self.assertIn("only with --what lineage", self.evoctl(server, "--what", "events", "--of", "1:0:0", status=2))
        self.assertIn("No such file", self.evoctl(server, "--what", "events", "--output", "/nowhere/x", status=2))
        client.call(list_worlds=c.ListWorlds())

    def test_without_files_there_is_nothing_to_export(self):
        client = self.client(self.server("--keep-nothing"))
        client.call(FAILED_PRECONDITION, export_run=c.ExportRun(table=c.RUN_TABLE_EVENTS, format=c.TEXT_FORMAT_CSV))


if __name__ == "__main__":
    unittest.main(argv=[sys.argv[0], *sys.argv[4:]])
