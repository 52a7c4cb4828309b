"""The panels of the page that plot: comparison with a table from the disk, and the motion of the bodies."""
import pathlib
import signal
import sys
import unittest

from page_case import Case, c


class Plots(Case):
    def plots(self, **parameters):
        """A server whose world has ended two generations, and the panel "Plots" of its page."""
        server = self.start(**parameters)
        control = self.client(server)
        control.run_to(250)
        self.browser.open(self.page(server))
        self.browser.panel("Plots")
        self.browser.wait_for_text("2 generations, up to 2", ".plots")
        return server

    def file(self, name, text):
        file = pathlib.Path(self.folder, name)
        file.write_text(text)
        return str(file)

    def legend(self, text):
        """Waits until the legend contains this."""
        self.browser.wait_for_text(text, ".plots .plot-legend")

    def test_a_table_is_compared_until_it_is_removed(self):
        server = self.plots()
        table = self.evoctl(server, "history", "--csv")
        heading, *rows = table.splitlines()
        both = [f"{run},{row}" for run in (0, 1) for row in rows]
        sweep = "\n".join(["# evod sweep", f"replicate,{heading}", *both])
        field = self.browser.element(".plots input[type=file]")
        field.send_keys(self.file("saved.csv", table))
        self.browser.wait_for_text("Dashed: saved.csv", ".plots")
        self.legend("saved.csv")
        field.send_keys(self.file("wrong.csv", table.replace("\n2,0,", "\n2,x,")))
        self.browser.wait_for_text('wrong.csv: line 3, island: got "x", allowed: a number.', ".plots [role=alert]")
        self.legend("saved.csv")  # the earlier table stays
        field.send_keys(self.file("runs.csv", sweep))
        self.browser.wait_for_text("Dashed: runs.csv", ".plots")
        self.legend("runs.csv, replicate 0")
        self.assertEqual(self.browser.text(".plots [role=alert]"), "")
        self.browser.press("Remove", ".plots")
        self.browser.wait("!document.querySelector('.plots-file').checkVisibility()", "no compared file")
        self.browser.wait("!document.querySelector('.plots .plot-legend').innerText.includes('runs.csv')",
                          "no dashed lines")

    def test_a_dropped_table_is_compared(self):
        server = self.plots()
        self.browser.run("""const transfer = new DataTransfer();
            transfer.items.add(new File([arguments[0]], "dropped.csv"));
            const drop = new DragEvent("drop", { dataTransfer: transfer, bubbles: true });
            document.querySelector(".plots").dispatchEvent(drop);""",
                         self.evoctl(server, "history", "--csv"))
        self.browser.wait_for_text("Dashed: dropped.csv", ".plots")

    def test_physics_shows_the_motion_of_the_island(self):
        server = self.start(crate_count=3)
        control = self.client(server)
        control.run_to(60)
        self.browser.open(self.page(server))
        self.browser.panel("Physics")
        self.browser.wait_for_text("33 bodies", ".physics")
        for tick in (60, 90):
            control.run_to(tick)
            motion = control.call(get_motion=c.GetMotion(world="default")).motion
            self.assertEqual((motion.tick, motion.body_count), (tick, 33))
            shown = f"{motion.kinetic_energy:.6g}"
            self.browser.wait("document.querySelector('.physics .plot-area').ariaLabel.replaceAll(',', '')"
                              ".includes(arguments[0])", f"the energy at tick {tick}", f"kinetic energy: {shown} kg")
        self.browser.wait_for_text("The tick is short enough", ".physics .good")


if __name__ == "__main__":
    signal.signal(signal.SIGTERM, lambda *_: sys.exit(1))  # closes the browser
    unittest.main(argv=[sys.argv[0], *sys.argv[4:]])
