"""evoview and the page, in a real Chromium, draw the same moment of a world. EVOVIEW names the viewer."""
import os
import pathlib
import signal
import sys
import unittest

import numpy

from page_case import Case, SMALL, plain
import png
import waiting

HERE = pathlib.Path(__file__).resolve().parent


@unittest.skipUnless("EVOVIEW" in os.environ, "evoview is not built")
class SamePlace(Case):
    """evoview and the page draw the same moment of a world."""

    def test_organisms_are_at_the_same_place(self):
        server = self.start(generation_s=60.0, population_size=15, food_count=0, poison_count=0)
        control = self.client(server)
        control.run_to(120)
        file = pathlib.Path(self.folder) / "evoview.png"
        under_xvfb = HERE.parent / "viewer" / "under_xvfb.sh"
        done = waiting.run([str(under_xvfb), os.environ["EVOVIEW"], "--server", f"127.0.0.1:{server.port}", "--skin",
                            "classic",
                            "--size", "790x720", "--screenshot", str(file), "--at-tick", "120", "--timeout", "600"],
                           capture_output=True, text=True)
        if done.returncode == 77:
            self.skipTest(done.stdout)
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
        browser = self.browser
        browser.open(self.page(server))
        self.shown_tick(120)
        browser.run("evod.app.world().set_look({ skin: 'classic', trails: false, perception: 'none', minimap: false })")
        organisms = browser.columns()["organisms"]
        x, y, radius = (numpy.array(organisms[name]) / 16 for name in ("x", "y", "radius"))
        of_page = plain.until(lambda: self.centres(browser.pixels(), x, y, radius), "the classic skin", pause_s=0.2)
        of_viewer = self.centres(png.decode(file.read_bytes()), x, y, radius)
        self.assertGreaterEqual(len(of_page), 10)
        self.assertEqual(of_page.keys(), of_viewer.keys())
        for i, place in of_page.items():
            with self.subTest(organism=organisms["id"][i]):
                numpy.testing.assert_allclose(place, of_viewer[i], atol=0.5)
                numpy.testing.assert_allclose(place, (x[i], y[i]), atol=0.5)

    @staticmethod
    def centres(pixels, x, y, radius):
        """Where the rings are of the organisms far from others, in px of the island. None: this is not the classic
        skin."""
        pixels = pixels.astype(float)
        ground, ring = numpy.array([204.0] * 3), numpy.array([104.0, 22, 148])
        inside = (pixels == ground).all(axis=2)
        if inside.mean() < 0.2:
            return None
        columns, rows = numpy.flatnonzero(inside.any(axis=0)), numpy.flatnonzero(inside.any(axis=1))
        left, top = columns[0], rows[0]
        zoom = (columns[-1] + 1 - left) / SMALL["island_width_px"]
        way = ring - ground
        share = ((pixels - ground) @ way) / (way @ way)  # of the ring's colour in a pixel
        beside = numpy.abs(pixels - ground - share[:, :, None] * way).max(axis=2)
        share[(beside > 12) | (share < 0.05)] = 0
        found = {}
        for i in range(len(x)):
            reach = radius[i] + 4
            others = numpy.hypot(numpy.delete(x, i) - x[i], numpy.delete(y, i) - y[i]) - numpy.delete(radius, i)
            walls = min(x[i], y[i], SMALL["island_width_px"] - x[i], SMALL["island_height_px"] - y[i])
            if others.min() < 2 * reach or walls < reach:
                continue
            u0, u1 = (int(round(left + (x[i] + side * reach) * zoom)) for side in (-1, 1))
            v0, v1 = (int(round(top + (y[i] + side * reach) * zoom)) for side in (-1, 1))
            part = share[v0:v1, u0:u1]
            v, u = numpy.mgrid[v0:v1, u0:u1] + 0.5
            found[i] = ((part * u).sum() / part.sum() - left) / zoom, ((part * v).sum() / part.sum() - top) / zoom
        return found


if __name__ == "__main__":
    signal.signal(signal.SIGTERM, lambda *_: sys.exit(1))  # closes the browser
    unittest.main(argv=[sys.argv[0], *sys.argv[4:]])
