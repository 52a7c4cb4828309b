"""A headless Chromium that shows the page of a server, through Debian's Selenium, and what the page knows, for tests.

The page offers its objects as `evod` for tests (client/web/src/page/main.ts): evod.server is the connection, evod.app
the page, evod.figures() and evod.columns() return what the worker measures and draws. Scripts here read them; what a
user does is done by clicks, keys and touches.
"""
import atexit
import base64
import contextlib
import json
import os

from selenium import webdriver
from selenium.common.exceptions import StaleElementReferenceException, WebDriverException
from selenium.webdriver.chrome.service import Service
from selenium.webdriver.common.by import By
from selenium.webdriver.common.keys import Keys  # noqa: F401  (for the tests)

import png
import waiting

DRIVER = os.environ.get("CHROMEDRIVER", "/usr/bin/chromedriver")
TABS = "[...document.querySelectorAll('.column > .tabs [role=tab]')]"  # of the panels
WIDTH, HEIGHT = 1280, 720
WAIT_S = 300  # for one step of the browser, on a machine that is busy with other work


def started(options, tries=3):
    """Another program may take the port that Selenium has found for the driver."""
    try:
        return webdriver.Chrome(service=Service(DRIVER), options=options)
    except WebDriverException:
        if tries == 1:
            raise
        return started(options, tries - 1)


class Browser:
    """introduces: the page shows its introduction, as to a new visitor."""

    def __init__(self, *arguments, introduces=False):
        options = webdriver.ChromeOptions()
        for argument in ("--headless=new", "--use-angle=swiftshader", "--enable-unsafe-swiftshader",
                         "--disable-dev-shm-usage",
                         "--disable-background-networking", "--disable-component-update", "--no-first-run",
                         "--force-device-scale-factor=1", f"--window-size={WIDTH},{HEIGHT}", *arguments):
            options.add_argument(argument)
        if os.geteuid() == 0:
            options.add_argument("--no-sandbox")  # Chromium has none for root
        options.set_capability("goog:loggingPrefs", {"browser": "ALL", "performance": "ALL"})
        self.driver = started(options)
        atexit.register(self.close)  # if the test is terminated
        self.driver.set_page_load_timeout(WAIT_S)
        self.driver.set_script_timeout(WAIT_S)
        self.resize(WIDTH, HEIGHT)
        if not introduces:
            self.cdp("Page.addScriptToEvaluateOnNewDocument", source="""try {
                localStorage.setItem("evod.introduction", "seen"); } catch { /* about:blank has no storage */ }""")

    def close(self):
        atexit.unregister(self.close)
        self.driver.quit()

    def cdp(self, method, **parameters):
        """A command of the Chrome DevTools Protocol."""
        return self.driver.execute_cdp_cmd(method, parameters)

    def resize(self, width, height):
        """Sets the size of the page, in CSS pixels, and that the user prefers a dark page. Both hold for the present
        tab."""
        self.cdp("Emulation.setDeviceMetricsOverride", width=width, height=height, deviceScaleFactor=1, mobile=False)
        self.cdp("Emulation.setEmulatedMedia", features=[{"name": "prefers-color-scheme", "value": "dark"}])

    # ---- the page ----

    def open(self, url, wait=True):
        """Opens a page as a new visitor does: with nothing stored in this tab."""
        self.driver.get("about:blank")
        self.driver.get(url)
        if wait:
            self.wait_for_snapshot()

    def reload(self):
        self.driver.refresh()
        self.wait_for_snapshot()

    def run(self, script, *arguments):
        return self.driver.execute_script(script, *arguments)

    def value(self, expression, *arguments):
        return self.run(f"return {expression}", *arguments)

    def result(self, expression, *arguments):
        """The result of a promise as a dictionary: {"value": …}, or {"message": …, "code": …} if it was rejected. Whole
        numbers beyond 2^53 become text, typed arrays lists."""
        return json.loads(self.driver.execute_async_script(f"""
            const done = arguments[arguments.length - 1];
            const plain = (key, value) => typeof value === "bigint" ? String(value)
              : ArrayBuffer.isView(value) ? Array.from(value) : value;
            Promise.resolve().then(() => {expression})
              .then((value) => done(JSON.stringify({{ value: value ?? null }}, plain)),
                    (error) => done(JSON.stringify({{ message: String(error.message), code: error.code ?? "" }})));
            """, *arguments))

    def request(self, kind, **fields):
        """What the server answers to a request that the page sends, whatever its controls allow."""
        return self.result("evod.server.request(arguments[0], arguments[1])", kind, fields)

    def wait(self, expression, what, *arguments):
        """The first true value of an expression of the page."""
        def look():
            with contextlib.suppress(WebDriverException):  # while another page loads
                return self.value(expression, *arguments)
        try:
            return waiting.until(look, what, pause_s=0.05)
        except AssertionError as late:
            with contextlib.suppress(WebDriverException):
                raise AssertionError(f"{late}; the page shows: {self.text()!r}; its log: {self.log()}") from None
            raise

    def wait_for_snapshot(self):
        self.wait("globalThis.evod?.app?.world().snapshot != null", "a drawn snapshot")

    def wait_for_text(self, text, css="body"):
        """Waits until an element that can be seen contains the text."""
        self.wait("""[...document.querySelectorAll(arguments[1])]
                      .some((e) => e.checkVisibility() && e.innerText.includes(arguments[0]))""",
                   f"the text {text!r}", text, css)

    def text(self, css="body"):
        return self.value("document.querySelector(arguments[0])?.innerText", css)

    def snapshot(self):
        """What the drawn snapshot says besides its entities."""
        return self.result("evod.app.world().snapshot")["value"]

    def columns(self):
        """The entities of the newest snapshot, as the worker has decoded it: {"organisms": {"id": […], …}, …}, in 1/16
        px."""
        return self.result("evod.columns(0)")["value"]

    def figures(self):
        return self.result("evod.figures()")["value"]

    def log(self):
        """The messages in the console since the last call, as (level, text)."""
        return [(entry["level"], entry["message"]) for entry in self.driver.get_log("browser")]

    def requested(self):
        """The addresses that the page has requested since the last call."""
        messages = [json.loads(entry["message"])["message"] for entry in self.driver.get_log("performance")]
        return [message["params"]["request"]["url"] if "request" in message["params"] else message["params"]["url"]
                for message in messages if message["method"] in ("Network.requestWillBeSent",
                                                                 "Network.webSocketCreated")]

    # ---- what a user does ----

    def element(self, css):
        self.wait("document.querySelector(arguments[0]) !== null", f"an element {css}", css)
        return self.driver.find_element(By.CSS_SELECTOR, css)

    def button(self, label, within="body"):
        """The button with this text or name that can be seen."""
        found = self.found_button(label, within)
        assert found is not None, f"no button {label!r} in {self.text(within)!r}"
        return found

    def found_button(self, label, within="body"):
        """As button(). None: there is none now."""
        return self.value(
            """[...document.querySelectorAll(`${arguments[1]} button`)].find((e) => e.checkVisibility() &&
            (e.textContent === arguments[0] || e.getAttribute("aria-label") === arguments[0]))""", label, within)

    def click(self, target):
        """Clicks on an element, or on the button with this text."""
        element = self.button(target) if isinstance(target, str) else target
        with contextlib.suppress(StaleElementReferenceException):
            self.run("arguments[0].scrollIntoView({ block: 'center' })", element)
        element.click()

    def press(self, label, within="body"):
        """Clicks on the button with this text as soon as it is there and can act."""
        def clicked():
            with contextlib.suppress(StaleElementReferenceException):  # the page has made another one
                button = self.found_button(label, within)
                if button is not None and button.is_enabled() and button.get_attribute("aria-disabled") != "true":
                    self.click(button)
                    return True
            return False
        try:
            waiting.until(clicked, f"the button {label!r} enabled", pause_s=0.05)
        except AssertionError as late:
            raise AssertionError(f"{late}; the page shows: {self.text(within)!r}") from None

    def panels(self):
        """The titles of all panels."""
        return self.value(f"{TABS}.map((tab) => tab.textContent)")

    def panel(self, title):
        """Opens a panel by its tab."""
        self.click(self.value(f"{TABS}.find((tab) => tab.textContent === arguments[0])", title))

    def type_into(self, element, text):
        """Replaces the text of a field, and leaves the field by Enter."""
        element.click()
        element.send_keys(Keys.CONTROL, "a")
        element.send_keys(text, Keys.ENTER)

    def take_part(self, part=True):
        if self.value("evod.server.access.taking_part") != part:
            self.click(self.element(".part .button"))
        self.wait("evod.server.access.taking_part === arguments[0]", "taking part", part)

    def set_camera(self, x_px, y_px, zoom):
        """Shows the island at this scale, which a user can only come near with the wheel."""
        self.run("evod.app.panes.focused.pane.view.set({ x_px: arguments[0], y_px: arguments[1], zoom: arguments[2] })",
                 x_px, y_px, zoom)

    def canvas(self):
        """The place of the canvas: its left, top, width and height in CSS pixels."""
        return self.value("""(({ left, top, width, height }) => [left, top, width, height])(
            document.querySelector(".pane-canvas").getBoundingClientRect())""")

    def pixels(self):
        """What the canvas shows, as an array of shape (height, width, 3)."""
        left, top, width, height = self.canvas()
        shot = self.cdp("Page.captureScreenshot", format="png", optimizeForSpeed=True,
                        clip=dict(x=left, y=top, width=width, height=height, scale=1))
        return png.decode(base64.b64decode(shot["data"]))

    def click_at(self, x, y):
        """Clicks on a point of the page with the mouse."""
        for kind in ("mousePressed", "mouseReleased"):
            self.cdp("Input.dispatchMouseEvent", type=kind, x=x, y=y, button="left", clickCount=1)

    def tap(self, x, y):
        """Touches a point of the page for a moment."""
        self.cdp("Emulation.setTouchEmulationEnabled", enabled=True)
        self.cdp("Input.dispatchTouchEvent", type="touchStart", touchPoints=[{"x": x, "y": y}])
        self.cdp("Input.dispatchTouchEvent", type="touchEnd", touchPoints=[])
