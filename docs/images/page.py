#!/usr/bin/python3
"""Makes the images of the page in a browser: docs/images/page.py. Build the preset release first.

They show a world of seed 7. The packages python3-selenium, python3-pil and chromium-driver are needed.
"""
import base64
import io
import pathlib
import subprocess
import sys
import tempfile

from PIL import Image
from selenium.webdriver.support.ui import Select

HERE = pathlib.Path(__file__).resolve().parent
ROOT = HERE.parent.parent
sys.path[:0] = [str(ROOT / "tests/system/web"), str(ROOT / "tests/system")]
import browser  # noqa: E402
import waiting  # noqa: E402

BIN = ROOT / "build/release/bin"
PORT, HTTP_PORT = 42790, 42791
BYTES_MAX = 200_000


def evoctl(*arguments, check=True):
    return subprocess.run([BIN / "evoctl", "--server", f"127.0.0.1:{PORT}", *arguments], check=check,
                          stdout=subprocess.DEVNULL,
                          stderr=None if check else subprocess.DEVNULL).returncode == 0


def save(page, name, part=None):
    """Saves the whole page, or the part of it that a CSS selector names."""
    page.run("""document.activeElement.blur();
        document.querySelectorAll(".column, .column *").forEach((element) => { element.scrollTop = 0; });""")
    page.result("""(async () => {
        for (let frame = 0; frame < 30; ++frame) await new Promise(requestAnimationFrame);
    })()""")  # the worker draws meanwhile
    clip = part and page.value("""(({ x, y, width, height }) =>
            ({ x: x - 8, y: y - 8, width: width + 16, height: height + 16, scale: 1 }))(
        document.querySelector(arguments[0]).getBoundingClientRect())""", part)
    shot = page.cdp("Page.captureScreenshot", format="png", **({"clip": clip} if clip else {}))["data"]
    image = Image.open(io.BytesIO(base64.b64decode(shot))).convert("RGB")
    image.quantize(256, Image.Quantize.MAXCOVERAGE, 4, dither=Image.Dither.NONE).save(HERE / name, optimize=True)
    size = (HERE / name).stat().st_size
    assert size <= BYTES_MAX, f"{name}: {size} bytes, allowed at most {BYTES_MAX}"


def show(page, tick, panel, shown):
    """Runs the world to a tick, pauses it, and shows its healthiest organism and a panel."""
    page.take_part()
    page.click("Run" if page.value("evod.app.world().control.state") == "RUN_STATE_WAITING" else "Resume")
    page.wait("evod.app.world().snapshot.tick >= arguments[0]", f"tick {tick}", tick)
    page.wait("evod.app.world().control.state === 'RUN_STATE_RUNNING'", "the run")
    page.click("Pause")
    page.wait("evod.app.world().control.state === 'RUN_STATE_PAUSED'", "the pause")
    page.click(page.element(".healthiest .link"))
    page.panel(panel)
    page.wait("document.querySelector('.panel-body').innerText.includes(arguments[0])", "the panel", shown)


def show_breeding(page):
    """Saves a pick of the first breeding, and its last child."""
    page.resize(1280, 1400)
    page.panel("Glass box")
    page.wait_for_text("Play the 25 picks")
    page.type_into(page.element(".glass-generation"), "1")
    page.wait_for_text("generation 1:", ".glass-box")
    page.wait_for_text("Play the 25 picks")

    def move(label, times=1):
        for _ in range(times):
            page.click(label)
    move("To the next stage (Page Down)")
    move("One step forward (→)", 9)
    page.wait_for_text("step 10 of")
    save(page, "glass_box_picks.png", ".glass-box")
    move("To the next stage (Page Down)")
    move("One step forward (→)", 26)
    page.wait_for_text("step 52 of")
    save(page, "glass_box_child.png", ".glass-box")


def show_panels(page):
    """Saves panels of the column: some parameters, plots and the family tree."""
    page.resize(1280, 1700)
    page.panel("Parameters")
    page.type_into(page.element("[data-panel=parameters] input[type=search]"), "poison count")
    page.wait("!document.querySelector('[data-panel=parameters]').innerText.includes('Poison harm')", "the search")
    save(page, "page_parameters.png", "[data-panel=parameters]")
    page.panel("Plots")
    page.wait_for_text("compare with", "[data-panel=plots]")
    page.wait("document.querySelector('[data-panel=plots] canvas')", "a plot")
    save(page, "page_plots.png", "[data-panel=plots]")
    page.panel("Family tree")
    Select(page.element("select[aria-label='What to show']")).select_by_visible_text("whole generation")
    page.wait_for_text("common ancestor", "[data-panel=family]")
    save(page, "page_family_tree.png", "[data-panel=family]")


def main():
    with tempfile.TemporaryDirectory() as folder:
        server = subprocess.Popen([BIN / "evod", "--port", str(PORT), "--web", "--http-port", str(HTTP_PORT), "--seed",
                                   "7",
                                   "--speed", "max", "--data", folder], stdout=subprocess.DEVNULL,
                                  stderr=subprocess.DEVNULL)
        try:
            waiting.until(lambda: evoctl("status", check=False), "the server")
            evoctl("run", "14", "--wait")
            evoctl("speed", "1")
            page = browser.Browser("--lang=en")
            page.resize(1280, 800)
            page.open(f"http://127.0.0.1:{HTTP_PORT}/")
            show(page, 33_900, "Overview", "Show evolution")
            save(page, "page.png")
            show_breeding(page)
            show_panels(page)
            page.cdp("Emulation.setTouchEmulationEnabled", enabled=True)
            page.cdp("Emulation.setDeviceMetricsOverride", width=820, height=1180, deviceScaleFactor=1, mobile=True)
            page.open(f"http://127.0.0.1:{HTTP_PORT}/")
            show(page, 34_080, "Organism", "Parents: ")
            save(page, "page_tablet.png")
            page.close()
        finally:
            server.terminate()
            server.wait()


if __name__ == "__main__":
    main()
