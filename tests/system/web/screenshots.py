#!/usr/bin/env python3
"""Screenshots of the page of a running server in the sizes of phones, tablets, laptops and zoomed windows, for people
who judge its layout:

    EVOD=build/release/bin/evod tests/system/web/screenshots.py http://127.0.0.1:7745/ FOLDER

Each file has the name SIZE-STATE.png. The states: `first` is what a new visitor sees; `used` is without the
introduction; each `--panel TITLE` adds a state with that panel open; `--theme light` changes the theme.
"""
import argparse
import base64
import pathlib
import sys

HERE = pathlib.Path(__file__).resolve().parent
sys.path[:0] = [str(HERE), str(HERE.parent)]

from browser import Browser  # noqa: E402

PHONE, TABLET = (390, 844), (820, 1180)
SIZES = (PHONE, TABLET, (1280, 720), (1366, 768), (1920, 1080), (640, 360), (320, 256))
TOUCHED = (PHONE, TABLET)


def show(browser, size):
    """Gives the page this size; phones and tablets have fingers instead of a mouse."""
    width, height = size
    browser.resize(width, height)
    browser.cdp("Emulation.setTouchEmulationEnabled", enabled=size in TOUCHED)


def save(browser, file):
    file.write_bytes(base64.b64decode(browser.cdp("Page.captureScreenshot", format="png")["data"]))


def main():
    parser = argparse.ArgumentParser(description="Takes screenshots of the page of a running server.")
    parser.add_argument("url")
    parser.add_argument("folder", type=pathlib.Path)
    parser.add_argument("--panel", action="append", default=[], help="the title of a panel; may be repeated")
    parser.add_argument("--size", action="append", default=[], help="for example 390x844; default: all sizes")
    parser.add_argument("--language", choices=("en", "de"), default="en", help="titles of panels are in this language")
    parser.add_argument("--theme", choices=("dark", "light"), default="dark")
    given = parser.parse_args()
    sizes = [tuple(map(int, size.split("x"))) for size in given.size] or SIZES
    given.folder.mkdir(parents=True, exist_ok=True)
    browser = Browser(introduces=True)
    for size in sizes:
        name = "x".join(map(str, size))
        browser.driver.get(given.url)
        browser.run("localStorage.clear(); localStorage.setItem('evod.theme', arguments[0]); "
                    "localStorage.setItem('evod.language', arguments[1])", given.theme, given.language)
        show(browser, size)
        browser.open(given.url)
        browser.wait("evod.app.world().history.is_complete", "the curve")
        save(browser, given.folder / f"{name}-first.png")
        browser.run("localStorage.setItem('evod.introduction', 'seen')")
        browser.reload()
        browser.wait("evod.app.world().history.is_complete", "the curve")
        save(browser, given.folder / f"{name}-used.png")
        for title in given.panel:
            browser.panel(title)
            browser.wait("document.querySelector('.panel-body [role=tabpanel]:not([hidden])').innerText.length > 20",
                         f"the panel {title}")
            save(browser, given.folder / f"{name}-{title.lower().replace(' ', '_')}.png")
    browser.close()


if __name__ == "__main__":
    main()
