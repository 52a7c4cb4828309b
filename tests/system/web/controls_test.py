"""Changes in a real Chromium: parameters, undo and the run bar of the page happen once on the server."""
import signal
import sys
import unittest

from page_case import Case, c, plain, w
from browser import Keys


class Controls(Case):
    def setUp(self):
        super().setUp()
        self.served = self.start()
        self.control = self.client(self.served)
        self.control.call(subscribe_events=c.SubscribeEvents())
        self.browser.open(self.page(self.served))

    def field(self, name, kind="field"):
        """The field or the slider of a parameter that can be seen."""
        return self.browser.wait("[...document.querySelectorAll(arguments[0])].find((e) => e.checkVisibility())", name,
                                 f"[data-panel=parameters] .{kind}[data-parameter={name}]")

    def wait_enabled(self, name, enabled=True):
        self.browser.wait("document.querySelector(arguments[0])?.disabled === arguments[1]",
                          f"{name} enabled: {enabled}",
                          f".parameters [data-parameter={name}]", not enabled)

    def wait_value(self, name, text):
        """Waits until the field of a parameter contains the text."""
        self.browser.wait("document.querySelector(arguments[0]).value === arguments[1]", f"{name} {text}",
                          f".parameters .field[data-parameter={name}]", text)

    def changed(self, name):
        """The value of a parameter in the next event about it."""
        event = self.control.next_event("parameters_changed",
                                        lambda event: event.parameters_changed.changed[0].name == name)
        state = event.parameters_changed.changed[0]
        value = state.pending if state.HasField("pending") else state.value
        return getattr(value, value.WhichOneof("kind"))

    def test_the_page_opens_watching(self):
        browser = self.browser
        before = self.control.world()
        self.assertFalse(browser.value("evod.server.access.taking_part"))
        browser.panel("Parameters")
        browser.wait_for_text("You are watching. Press “Take part” to change worlds.", "[data-panel=parameters]")
        self.assertFalse(self.field("mutation_chance").is_enabled())
        for label in ("Run", "One generation"):
            browser.click(label)
            browser.wait_for_text("Press “Take part”", ".notices")
        browser.element("body").send_keys(Keys.SPACE)
        self.assertEqual(self.control.world(), before)
        browser.take_part()
        self.wait_enabled("mutation_chance")
        browser.take_part(False)
        self.wait_enabled("mutation_chance", False)

    def test_a_refused_action_offers_to_take_part(self):
        self.browser.click("Run")
        self.browser.press("Take part", ".notices")
        self.browser.wait("evod.server.access.taking_part", "taking part")
        self.browser.take_part(False)

    def test_a_waiting_world_can_be_started_on_its_island(self):
        self.browser.press("▶ Start", ".pane-stage")
        self.control.wait_world(lambda world: world.state == w.RUN_STATE_RUNNING, "default")
        self.browser.wait("!document.querySelector('.pane-start').checkVisibility()", "no button on a running world")
        self.browser.take_part(False)

    def test_a_field_and_a_slider_change_the_server(self):
        browser = self.browser
        browser.take_part()
        browser.panel("Parameters")
        self.wait_enabled("mutation_chance")
        browser.type_into(self.field("mutation_chance"), "0.25")
        browser.press("Apply")
        self.assertEqual(self.changed("mutation_chance"), 0.25)
        browser.wait_for_text("no edits", "[data-panel=parameters]")
        browser.click(browser.value("document.querySelector('.parameters .check input')"))  # apply at once
        self.field("mutation_chance", "parameter-slider").send_keys(Keys.ARROW_RIGHT)
        moved = self.changed("mutation_chance")
        self.assertGreater(moved, 0.25)
        self.assertEqual(self.value_of(self.control, "mutation_chance"), moved)
        browser.press("Undo")
        self.assertEqual(self.changed("mutation_chance"), 0.25)

    def test_undo_reverses_changes_and_placings(self):
        browser = self.browser
        browser.take_part()
        browser.press("Food")
        left, top, width, height = browser.canvas()
        browser.click_at(left + width / 4, top + height / 3)
        placed = self.control.next_event("placed").placed
        browser.wait("evod.app.world().undo.next_undo === 'placed 1 food'", "the placed food in the history")
        browser.panel("Parameters")
        self.wait_enabled("mutation_chance")
        before = self.value_of(self.control, "mutation_chance")
        browser.type_into(self.field("mutation_chance"), "0.25")
        self.field("mutation_chance").send_keys(Keys.CONTROL, "z")  # the field undoes its own text
        browser.type_into(self.field("mutation_chance"), "0.25")
        browser.press("Apply")
        self.assertEqual(self.changed("mutation_chance"), 0.25)
        browser.wait("evod.app.world().undo.next_undo === 'Mutation chance'", "the change in the history")
        browser.element("body").send_keys(Keys.CONTROL, "z")
        self.assertEqual(self.changed("mutation_chance"), before)
        browser.wait("evod.app.world().undo.next_undo === 'placed 1 food'", "the end of the first undo")
        browser.press("Undo", ".tools")
        self.assertEqual(self.control.next_event("removed").removed.food, placed.food)
        browser.wait("evod.app.world().undo.next_redo === 'placed 1 food'", "the end of the second undo")
        browser.element("body").send_keys(Keys.CONTROL, Keys.SHIFT, "z")
        self.assertEqual(len(self.control.next_event("placed").placed.food), 1)
        browser.wait("evod.app.world().undo.next_redo === 'Mutation chance'", "the end of the redo")
        browser.element("body").send_keys(Keys.CONTROL, "y")
        self.assertEqual(self.changed("mutation_chance"), 0.25)

    def test_the_run_bar_controls_the_world(self):
        browser = self.browser
        browser.take_part()
        browser.press("Max")
        self.control.wait_world(lambda world: world.speed.max, "default")
        browser.wait("evod.app.world().control.speed?.max", "the maximum speed")
        browser.press("One generation")
        self.control.wait_world(lambda world: world.tick == 120 and world.state == w.RUN_STATE_WAITING, "default")
        self.shown_tick(120)
        browser.press("Max")
        self.control.wait_world(lambda world: world.speed.real_time_factor == 1, "default")
        browser.press("Double the speed")
        self.control.wait_world(lambda world: world.speed.real_time_factor == 2, "default")
        browser.wait("document.querySelector('.run-bar .run').textContent !== 'Pause'", "a stopped world")
        browser.press(browser.text(".run-bar .run"), ".run-bar")
        self.control.wait_world(lambda world: world.state == w.RUN_STATE_RUNNING, "default")
        browser.wait_for_text("Pause", ".run-bar")
        browser.press("Pause")
        self.control.wait_world(lambda world: world.state == w.RUN_STATE_PAUSED, "default")
        browser.wait_for_text("Resume", ".run-bar")

    def test_a_refused_value_is_explained_at_its_field(self):
        browser = self.browser
        browser.take_part()
        browser.panel("Parameters")
        self.wait_enabled("mutation_chance")
        browser.type_into(browser.element(".parameters [type=search]"), "spawn margin")
        browser.type_into(self.field("spawn_margin_px"), "300")
        refused = self.control.call(plain.INVALID, set_parameters=plain.set_parameters("default",
                                                                                       spawn_margin_px=300.0)).status
        self.assertEqual(refused.violations[0].got, "300")
        browser.press("Apply")
        allowed = refused.violations[0].allowed
        browser.wait_for_text(f"got 300, allowed {allowed}", ".parameter[data-name=spawn_margin_px] .error")
        self.assertNotEqual(self.value_of(self.control, "spawn_margin_px"), 300)
        self.assertEqual(self.field("spawn_margin_px").get_attribute("aria-invalid"), "true")

    def test_two_pages_see_each_others_changes(self):
        browser, first = self.browser, self.browser.driver.current_window_handle
        browser.take_part()
        browser.panel("Parameters")
        self.wait_enabled("mutation_step")
        browser.driver.switch_to.new_window("window")
        second = browser.driver.current_window_handle
        try:
            browser.resize(800, 700)
            browser.open(self.page(self.served))
            browser.take_part()
            browser.panel("Parameters")
            self.wait_enabled("mutation_step")
            browser.type_into(self.field("mutation_step"), "21")
            browser.press("Apply")
            self.assertEqual(self.changed("mutation_step"), 21)
            browser.driver.switch_to.window(first)
            self.wait_value("mutation_step", "21")
            browser.wait_for_text("set mutation_step to 21", ".notices")
            browser.type_into(self.field("mutation_step"), "22")
            browser.press("Apply")
            self.assertEqual(self.changed("mutation_step"), 22)
            browser.driver.switch_to.window(second)
            self.wait_value("mutation_step", "22")
        finally:
            for handle in browser.driver.window_handles:
                if handle != first:
                    browser.driver.switch_to.window(handle)
                    browser.driver.close()
            browser.driver.switch_to.window(first)


if __name__ == "__main__":
    signal.signal(signal.SIGTERM, lambda *_: sys.exit(1))  # closes the browser
    unittest.main(argv=[sys.argv[0], *sys.argv[4:]])
