"""The connection of the page in a real Chromium: a killed server, a shutdown, and a hidden page. What the page does
happens once."""
import pathlib
import signal
import sys
import unittest

from page_case import Case, c, plain
import waiting
from metrics_test import EVOD


class Connection(Case):
    def setUp(self):
        super().setUp()
        self.served = self.start("--speed", "max")
        self.address = self.page(self.served)
        self.browser.open(self.address)
        self.browser.take_part()

    def restart(self):
        """Another server with the same data and the same address of the page."""
        self.served = self.server("--data", self.folder, "--http-port", str(self.served.http_port))
        self.http(self.served)

    def journal(self, kind):
        """How many commands of a kind the run file contains."""
        files = [str(file) for file in pathlib.Path(self.folder).glob("default*.evod")]
        self.assertEqual(len(files), 1)
        exported = waiting.run([EVOD, "export", files[0], "--what", "events", "--format", "jsonl"], capture_output=True,
                               text=True, check=True)
        return sum(f'"{kind}"' in line for line in exported.stdout.splitlines())

    def test_the_page_carries_on_after_a_kill(self):
        browser = self.browser
        self.client(self.served).run_to(130)
        self.shown_tick(130)
        self.served.kill()
        browser.wait_for_text("Trying again", ".banners")
        browser.wait_for_text("not connected", ".pane-state")
        self.assertEqual(browser.snapshot()["tick"], 130)  # the last image stays
        browser.run("""globalThis.answered = null;
            evod.app.world().control.run_until_tick(200)
                .then(() => answered = "yes", (error) => answered = error.message);""")
        self.restart()
        browser.wait("answered", "the answer of the new server")
        self.assertEqual(browser.value("answered"), "yes")
        self.shown_tick(200)
        self.assertEqual(browser.text(".banners"), "")
        self.assertEqual(self.client(self.served).world().tick, 200)
        self.served.process.terminate()
        self.assertEqual(waiting.ended(self.served.process), 0)
        self.assertEqual(self.journal("run_until_tick"), 2)  # one by the TCP client, one by the page

    def test_a_silent_server_is_not_called_running(self):
        browser = self.browser
        # At full speed, a slow page may still be busy with what the server has sent before.
        self.client(self.served).call(set_speed=c.SetSpeed(speed=plain.w.Speed(real_time_factor=1)))
        browser.run("void evod.app.world().control.run()")
        browser.wait("evod.app.world().snapshot.tick > 0", "a snapshot of the running world")
        self.served.process.send_signal(signal.SIGSTOP)
        self.addCleanup(self.served.process.send_signal, signal.SIGCONT)
        browser.wait_for_text("no data for", ".pane-state")
        self.served.process.send_signal(signal.SIGCONT)
        browser.wait_for_text("running", ".pane-state")
        self.assertEqual(browser.value("evod.server.state.silent_s"), 0)

    def test_commands_around_a_kill_happen_once(self):
        browser, count = self.browser, 40
        browser.run("""globalThis.done = [];
            (async () => {
              for (let i = 1; i <= arguments[0]; ++i) {
                const parameters = [{ name: "mutation_step", value: { real: i } }];
                await evod.server.request("set_parameters", { world: "default", parameters })
                  .then(() => done.push(i), (error) => done.push(error.message));
              }
            })();""", count)
        browser.wait("done.length >= 5", "some answers")
        self.served.kill()
        self.restart()
        browser.wait("done.length === arguments[0]", "all answers", count)
        self.assertEqual(browser.value("done"), list(range(1, count + 1)))
        self.assertEqual(self.value_of(self.client(self.served), "mutation_step"), count)
        self.served.process.terminate()
        self.assertEqual(waiting.ended(self.served.process), 0)
        self.assertEqual(self.journal("set_parameters"), count)

    def test_a_hidden_page_gets_no_snapshots(self):
        browser, first = self.browser, self.browser.driver.current_window_handle
        control = self.client(self.served)
        control.call(run=c.Run(world="default"))
        self.wait(self.served, lambda seen: seen("evod_snapshots_sent_total") > 20, "snapshots")
        browser.driver.switch_to.new_window("tab")  # hides the first
        try:
            sent = lambda: self.metrics(self.served)("evod_snapshots_sent_total")

            def stands_still():
                """Whether none is sent during a thousand ticks."""
                before, tick = sent(), control.world().tick
                control.wait_world(lambda world: world.tick > tick + 1000, "default")
                return sent() == before
            plain.until(stands_still, "no further snapshots")
            still = sent()
        finally:
            browser.driver.close()
            browser.driver.switch_to.window(first)
        self.wait(self.served, lambda seen: seen("evod_snapshots_sent_total") > still + 5,
                  "snapshots for the visible page")

    def test_a_shutdown_is_announced(self):
        browser = self.browser
        self.served.process.terminate()
        browser.wait_for_text("The server has shut down. Trying again …", ".banners")
        self.assertEqual(waiting.ended(self.served.process), 0)
        self.restart()
        browser.wait("evod.server.state.phase === 'open' && document.querySelector('.banners').innerText === ''",
                     "a session")


if __name__ == "__main__":
    signal.signal(signal.SIGTERM, lambda *_: sys.exit(1))  # closes the browser
    unittest.main(argv=[sys.argv[0], *sys.argv[4:]])
