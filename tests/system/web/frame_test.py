"""The page in a frame of another page, such as a notebook, in a real Chromium: `evod --embed-in`."""
import http.server
import sys
import threading
import unittest

from page_case import Case


class Notebook(http.server.ThreadingHTTPServer):
    """A page at another origin, with a frame that shows `address`."""

    def __init__(self):
        super().__init__(("127.0.0.1", 0), Handler)
        self.address = ""
        threading.Thread(target=self.serve_forever, daemon=True).start()

    def end(self):
        self.shutdown()
        self.server_close()


class Handler(http.server.BaseHTTPRequestHandler):
    def do_GET(self):
        body = f'<!doctype html><iframe src="{self.server.address}" width="1200" height="600"></iframe>'.encode()
        self.send_response(200)
        self.send_header("Content-Type", "text/html")
        self.send_header("Content-Length", str(len(body)))
        self.end_headers()
        self.wfile.write(body)

    def log_message(self, *_):
        pass


class Frame(Case):
    def setUp(self):
        super().setUp()
        self.notebook = Notebook()
        self.addCleanup(self.notebook.end)
        self.addCleanup(self.browser.driver.switch_to.default_content)

    def show(self, host, *options):
        """Opens the other page under a name of its host, with the page of a server in its frame."""
        served = self.start("--speed", "1", "--start", *options)
        self.notebook.address = self.page(served, "#world=default")
        self.browser.open(f"http://{host}:{self.notebook.server_port}/", wait=False)
        self.browser.driver.switch_to.frame(0)
        return served

    def test_a_named_origin_shows_and_controls_a_world(self):
        for origin in (f"http://localhost:{self.notebook.server_port}", "http://localhost:*"):
            served = self.show("localhost", "--embed-in", origin)
            self.browser.wait_for_snapshot()
            answer = self.browser.request("set_speed", speed={"real_time_factor": 2})
            self.assertIn("value", answer, answer)
            self.assertEqual(self.client(served).world().speed.real_time_factor, 2)
            served.end()

    def test_other_origins_are_refused(self):
        for host, options in (("localhost", ()), ("127.0.0.1", ("--embed-in", "http://localhost:*")),
                              ("localhost", ("--embed-in", "http://localhost:1"))):
            served = self.show(host, *options)
            self.browser.wait("location.protocol === 'chrome-error:'", "the page that Chromium shows instead")
            self.assertIn("frame-ancestors", str(self.browser.log()))
            served.end()


if __name__ == "__main__":
    unittest.main(argv=[sys.argv[0], *sys.argv[4:]])
