"""A class in the page, in a real Chromium: a teacher and three students, each in a browser of their own."""
import csv
import io
import pathlib
import signal
import sqlite3
import sys
import tarfile
import tempfile
import unittest

from page_case import Case, access, c
from browser import Browser, Keys
import waiting

FIELD = "[data-panel=parameters] input.field[data-parameter={}]"


class Class(Case):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.students = [Browser() for _ in range(3)]
        cls.fox, cls.owl, cls.unnamed = cls.students

    @classmethod
    def tearDownClass(cls):
        for browser in cls.students:
            browser.close()
        super().tearDownClass()

    def setUp(self):
        super().setUp()
        self.teacher = self.browser
        admin, secret = self.token("ada", access.ADMIN), access.token_command(
            "add", "kay", "--role", "teacher", data=self.folder).strip()
        self.served = self.start("--require-token", generation_s=1.0, population_size=50)
        self.admin = self.come(self.served, admin)
        for browser in (self.teacher, *self.students):
            browser.driver.get(self.page(self.served))
            browser.run("sessionStorage.clear(); localStorage.removeItem('evod.panel')")
        self.teacher.open(self.page(self.served, f"#token={secret}"))

    def create(self):
        """The teacher creates the class bio2. Returns the link with which students join."""
        teacher = self.teacher
        teacher.panel("Class")
        teacher.wait("document.querySelector('#class-name')?.checkVisibility()", "the form of a new class")
        teacher.element("#class-name").send_keys("bio2")
        teacher.press("Create the class")
        teacher.press("Code to join")
        teacher.wait("document.querySelector('.class-code-qr svg')", "the QR code")
        link = teacher.wait("document.querySelector('.class-code-link').textContent", "the link")
        letters = teacher.text(".class-code-letters").replace(" ", "")
        self.assertRegex(letters, "^[A-Z]{6}$")
        self.assertEqual(link, self.page(self.served, f"#join={letters}"))
        teacher.element(".class-code").send_keys(Keys.ESCAPE)
        return link

    def join(self, browser, link, name):
        browser.open(link, wait=False)
        browser.wait("document.querySelector('#join-name')?.checkVisibility()", "the form to join")
        self.assertNotIn("join", browser.driver.current_url)
        browser.element("#join-name").send_keys(name, Keys.ENTER)
        browser.wait_for_snapshot()
        self.assertNotIn("join", browser.driver.current_url)
        return browser.value("evod.server.state.welcome.membership")

    def joined(self):
        link = self.create()
        members = [self.join(browser, link, name) for browser, name in zip(self.students, ("Fox", "Owl", ""))]
        self.teacher.wait("document.querySelectorAll('.wall-tile').length === 3", "three tiles")
        return members

    def tile(self, name):
        return self.teacher.wait(
            "[...document.querySelectorAll('.wall-tile')].find((e) => e.innerText.includes(arguments[0]))",
            f"the tile of {name}", name)

    def ticks(self):
        worlds = self.admin.call(list_worlds=c.ListWorlds()).worlds.worlds
        return {world.name: world.tick for world in worlds if world.name.startswith("bio2_")}

    def test_each_student_changes_the_own_world(self):
        members = self.joined()
        self.assertEqual([member["name"] for member in members[:2]], ["Fox", "Owl"])
        self.assertTrue(members[2]["name"])  # the server has made one up
        for number, (browser, member) in enumerate(zip(self.students, members)):
            browser.wait_for_text(f"You are {member['name']} in bio2, teacher kay.", ".part")
            self.assertEqual(browser.value("evod.server.worlds.names"), [member["world"]])
            self.assertEqual(browser.value("evod.app.world().name"), member["world"])
            browser.press("Run")
            browser.panel("Parameters")
            browser.wait("evod.app.world().parameters.set !== null", "the parameters")
            field = browser.element(FIELD.format("mutation_chance"))
            browser.type_into(field, f"0.{number + 1}")
            browser.press("Apply")
        for number, member in enumerate(members):
            waiting.until(lambda: abs(self.value_of(self.admin, "mutation_chance", member["world"]) - (number + 1) / 10)
                          < 1e-6, "the value of the student")
        waiting.until(lambda: min(self.ticks().values()) > 0, "all worlds run")

    def test_the_teacher_freezes_and_lets_go_on(self):
        self.joined()
        for browser in self.students:
            browser.press("Run")
        waiting.until(lambda: min(self.ticks().values()) > 0, "all worlds run")
        self.teacher.press("❄ Freeze")
        for browser in self.students:
            browser.wait_for_text("Your teacher has frozen the class.", ".banners")
            run = browser.wait(
                "[...document.querySelectorAll('.run-bar button')].find((e) => e.ariaDisabled === 'true')",
                "a greyed control")
            self.assertEqual(run.get_attribute("title"), "Your teacher has frozen the class.")
        frozen = self.ticks()
        self.assertEqual(self.fox.request("run", world="bio2_fox").get("code"), "CODE_FAILED_PRECONDITION")
        self.assertEqual(self.ticks(), frozen)
        self.teacher.wait("document.querySelectorAll('.wall-tile[data-frozen]').length === 3", "frozen tiles")
        self.teacher.press("❄ Go on")
        waiting.until(lambda: all(tick > frozen[world] for world, tick in self.ticks().items()), "all worlds go on")
        for browser in self.students:
            browser.wait("!document.querySelector('.banners').textContent.includes('frozen')", "no banner")

    def test_the_teacher_opens_a_world_and_returns(self):
        self.joined()
        self.tile("Fox").send_keys(Keys.ENTER)
        self.teacher.wait("evod.app.world().name === 'bio2_fox' && evod.app.world().snapshot",
                          "the world of the student")
        self.teacher.wait_for_text("You see the world of Fox (bio2).", ".banners")
        self.teacher.press("Run")
        waiting.until(lambda: self.ticks()["bio2_fox"] > 0, "the world runs")
        self.teacher.element("body").send_keys(Keys.ESCAPE)
        self.teacher.wait("document.activeElement.innerText.includes('Fox')", "the tile has the focus")

    def test_a_removed_student_learns_it_and_is_let_in_again(self):
        members = self.joined()
        self.teacher.press("Members")
        self.teacher.press("Remove: Owl")
        self.owl.wait_for_text("Your teacher has removed you from the class.", ".start")
        self.assertEqual(len(self.ticks()), 3)  # the world stays
        self.fox.reload()
        again = self.fox.value("evod.server.state.welcome.membership")
        self.assertEqual((again["name"], again["world"]), ("Fox", members[0]["world"]))
        self.teacher.press("Let in again: Owl")
        self.teacher.press("New code: Owl")
        code = self.teacher.wait("document.querySelector('.class-codes code')?.textContent", "the personal code")
        self.owl.element("#join-code").clear()
        self.owl.element("#join-code").send_keys(code, Keys.ENTER)
        self.owl.wait_for_text("You are Owl in bio2", ".part")

    def test_what_if_makes_a_world_of_the_student(self):
        self.joined()
        self.fox.press("What if?")
        self.fox.wait("evod.app.world().name === 'bio2_fox_2'", "the fork")
        self.assertEqual(self.fox.value("evod.server.worlds.names"), ["bio2_fox", "bio2_fox_2"])
        self.assertEqual(self.owl.value("evod.server.worlds.names"), ["bio2_owl"])
        self.fox.panel("Worlds")
        self.fox.press("Delete …")
        self.fox.press("Delete the world")
        self.fox.wait("evod.server.worlds.names.length === 1", "only the first world")

    def test_collecting_saves_runs_and_a_table(self):
        self.joined()
        folder = tempfile.mkdtemp(dir=self.folder)
        self.teacher.cdp("Browser.setDownloadBehavior", behavior="allow", downloadPath=folder)
        self.teacher.press("Run all")
        waiting.until(lambda: min(self.ticks().values()) > 120, "a generation of each world")
        self.teacher.press("❄ Freeze")
        self.teacher.press("Collect")
        self.teacher.wait_for_text("Collected 3 runs", ".class-wall .notices")
        saved = waiting.until(lambda: next(pathlib.Path(folder).glob("bio2.tar"), None), "the archive")
        with tarfile.open(saved) as archive:
            files = {member.name: archive.extractfile(member).read() for member in archive}
        self.assertEqual(len(files), 4)
        rows = list(csv.DictReader(io.StringIO(files.pop("bio2/students.csv").decode())))
        self.assertEqual({row["name"] for row in rows} & {"Fox", "Owl"}, {"Fox", "Owl"})
        self.assertTrue(all(float(row["fitness_best"]) > 0 and row["notes"] == "0" for row in rows), rows)
        for name, content in files.items():
            file = pathlib.Path(folder, pathlib.Path(name).name)
            file.write_bytes(content)
            with sqlite3.connect(file) as database:
                self.assertEqual(database.execute("PRAGMA integrity_check").fetchone(), ("ok",))

    def test_refusals_are_sentences_and_can_be_tried_again(self):
        link = self.create()
        self.join(self.fox, link, "Fox")
        self.owl.open(self.page(self.served, "#join=BBBBBB"), wait=False)
        self.owl.wait("document.querySelector('#join-name')?.checkVisibility()", "the form to join")
        self.owl.press("Join")
        self.owl.wait_for_text("No class has this code now.", ".join")
        code = self.owl.element("#join-code")
        code.clear()
        code.send_keys(link[-6:].lower())
        self.owl.element("#join-name").send_keys("Fox", Keys.ENTER)
        self.owl.wait_for_text("Another student has this name already.", ".join")
        name = self.owl.element("#join-name")
        name.clear()
        name.send_keys("Owl", Keys.ENTER)
        self.owl.wait_for_text("You are Owl in bio2", ".part")

    def test_keys_move_and_freeze(self):
        self.joined()
        first = self.teacher.wait("document.querySelector('.wall-tile')", "the tiles")
        first.send_keys(Keys.ARROW_RIGHT)
        self.assertTrue(self.teacher.value(
            "document.activeElement === document.querySelectorAll('.wall-tile')[1]"))
        self.assertRegex(self.teacher.value("document.activeElement.ariaLabel"),
                         r"^\S.*, generation \d+, best fitness ")
        self.teacher.driver.switch_to.active_element.send_keys("f")
        self.teacher.wait_for_text("❄ frozen", ".wall-bar")
        self.teacher.wait(
            "[...document.querySelectorAll('.class-wall [aria-live]')]"
            ".some((element) => element.textContent.includes('class is frozen'))",
            "the live region")
        self.teacher.driver.switch_to.active_element.send_keys(Keys.ESCAPE)
        self.teacher.wait("!document.querySelector('.class-wall')", "the page of the worlds")


if __name__ == "__main__":
    signal.signal(signal.SIGTERM, lambda *_: sys.exit(1))  # closes the browsers
    unittest.main(argv=[sys.argv[0], *sys.argv[4:]])
