"""Who the user of the page is, in a real Chromium: tokens, links with tokens, and what each role can do."""
import signal
import sys
import unittest

from page_case import Case, access, w
from browser import Keys


class Roles(Case):
    def setUp(self):
        super().setUp()
        self.viewer, self.controller = self.token("vera", access.VIEWER), self.token("carl", access.CONTROLLER)
        self.admin_secret = self.token("ada", access.ADMIN)
        self.served = self.start("--require-token")
        self.admin = self.come(self.served, self.admin_secret)

    def enter(self, secret):
        self.browser.open(self.page(self.served, f"#world=default&token={secret}"))

    def test_a_token_leaves_the_address_and_stays_in_the_tab(self):
        browser = self.browser
        self.enter(self.controller)
        self.assertNotIn("token", browser.driver.current_url)
        self.assertNotIn(self.controller, browser.value("document.documentElement.outerHTML"))
        self.assertEqual(browser.value("document.cookie"), "")
        browser.reload()
        self.assertEqual(browser.value("evod.server.access.role"), "ROLE_CONTROLLER")
        self.assertEqual(browser.value("evod.server.state.welcome.user"), "carl")
        for url in browser.requested():
            self.assertNotIn(self.controller, url)
        self.assertNotIn(self.controller, self.served.output())

    def follow(self, fragment):
        """Follows a link to the page that is open."""
        self.browser.run("location.hash = arguments[0]", fragment)

    def test_the_page_shows_who_the_user_is(self):
        self.enter(self.viewer)
        self.browser.wait_for_text("vera (viewer)", ".session")

    def test_a_link_does_not_replace_a_token_unasked(self):
        browser = self.browser
        self.enter(self.controller)
        self.follow(f"#world=default&token={self.viewer}")
        browser.wait_for_text("The link contains another token. You are connected as carl (controller).", ".banners")
        self.assertNotIn("token", browser.driver.current_url)
        browser.press("Keep mine")
        browser.wait("!document.querySelector('.banners').textContent.includes('token')", "no question")
        browser.wait_for_text("carl (controller)", ".session")
        self.follow(f"#token={self.viewer}")
        browser.press("Use the token of the link")
        browser.wait_for_text("vera (viewer)", ".session")
        browser.driver.get("about:blank")
        self.enter(self.controller)
        browser.wait_for_text("You are connected as vera (viewer).", ".banners")
        browser.reload()
        browser.wait_for_text("vera (viewer)", ".session")

    def test_a_viewer_changes_nothing(self):
        browser = self.browser
        self.enter(self.viewer)
        browser.wait_for_text("You are a viewer: read-only.")
        self.assertFalse(browser.element(".part .button").is_displayed())
        before = self.admin.world()
        run = browser.button("Run")
        self.assertEqual(run.get_attribute("aria-disabled"), "true")
        self.assertEqual(run.get_attribute("title"), "You are connected as a viewer: read-only.")
        browser.click(run)
        browser.wait_for_text("You are connected as a viewer: read-only.", ".notices")
        browser.panel("Parameters")
        browser.wait_for_text("You are connected as a viewer: read-only.", "[data-panel=parameters]")
        enabled = ("[...document.querySelectorAll('[data-panel=parameters] [data-parameter]')]"
                   ".filter((e) => !e.disabled)")
        self.assertEqual(browser.value(f"{enabled}.length"), 0)
        half = {"name": "mutation_chance", "value": {"real": 0.5}}
        for kind, fields in (("run", {"world": "default"}), ("set_parameters",
                                                             {"world": "default", "parameters": [half]}),
                             ("delete_world", {"world": "default"}), ("shut_down", {})):
            answer = browser.request(kind, **fields)
            self.assertEqual(answer.get("code"), "CODE_PERMISSION_DENIED", answer)
        self.assertEqual(self.admin.world(), before)

    def test_a_controller_can(self):
        self.enter(self.controller)
        self.browser.take_part()
        self.browser.press("One generation")
        self.admin.wait_world(lambda world: world.tick == 120 and world.state == w.RUN_STATE_WAITING, "default")
        new = self.browser.button("New …")
        self.assertEqual(new.get_attribute("title"), "Only the role admin may create and delete worlds.")
        self.browser.take_part(False)

    def test_a_wrong_token_asks_for_the_right_one(self):
        browser = self.browser
        browser.open(self.page(self.served, "#token=evod_" + "0" * 64), wait=False)
        browser.wait("document.querySelector('#token')?.checkVisibility()", "the field for a token")
        browser.wait("document.querySelector('.start [role=status]').textContent.includes('token')", "the reason")
        browser.element("#token").send_keys(self.viewer, Keys.ENTER)
        browser.wait_for_snapshot()
        self.assertEqual(browser.value("evod.server.access.role"), "ROLE_VIEWER")

    def test_without_a_token_the_page_asks_for_one(self):
        browser = self.browser
        browser.open(self.page(self.served), wait=False)
        browser.run("sessionStorage.clear()")
        browser.driver.refresh()
        browser.wait_for_text("The server requires a token.")
        self.assertEqual(browser.value("document.activeElement.id"), "token")


class WithoutTokens(Case):
    def test_a_link_with_a_token_does_not_lock_the_tab_out(self):
        browser, served = self.browser, self.start()
        browser.open(self.page(served, "#token=abc"), wait=False)
        browser.wait("document.querySelector('#token')?.checkVisibility()", "the field for a token")
        browser.press("Connect")
        browser.wait_for_snapshot()
        browser.wait_for_text("admin", ".session")
        browser.run("location.hash = '#token=abc'")
        browser.press("Use the token of the link")
        browser.wait_for_text("token", ".notices")  # the reason of the server
        browser.wait_for_text("admin", ".session")
        browser.reload()
        browser.wait_for_text("admin", ".session")


if __name__ == "__main__":
    signal.signal(signal.SIGTERM, lambda *_: sys.exit(1))  # closes the browser
    unittest.main(argv=[sys.argv[0], *sys.argv[4:]])
