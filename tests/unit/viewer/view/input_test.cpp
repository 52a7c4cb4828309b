#include "client/viewer/view/input.h"

#include <gtest/gtest.h>

namespace evod::viewer {
namespace {

using Key = sf::Keyboard;

sf::Event key(sf::Event::EventType type, Key::Key code, bool shift = false, bool control = false) {
    sf::Event event{};
    event.type = type;
    event.key = sf::Event::KeyEvent{};
    event.key.code = code;
    event.key.control = control;
    event.key.shift = shift;
    return event;
}
sf::Event press(Key::Key code, bool shift = false, bool control = false) {
    return key(sf::Event::KeyPressed, code, shift, control);
}
sf::Event release(Key::Key code) {
    return key(sf::Event::KeyReleased, code);
}
sf::Event text(char sign) {
    sf::Event event{};
    event.type = sf::Event::TextEntered;
    event.text.unicode = static_cast<sf::Uint32>(sign);
    return event;
}
sf::Event button(sf::Event::EventType type, sf::Mouse::Button which, int x, int y) {
    sf::Event event{};
    event.type = type;
    event.mouseButton = {which, x, y};
    return event;
}
sf::Event moved(int x, int y) {
    sf::Event event{};
    event.type = sf::Event::MouseMoved;
    event.mouseMove = {x, y};
    return event;
}
sf::Event wheel(float delta, int x, int y) {
    sf::Event event{};
    event.type = sf::Event::MouseWheelScrolled;
    event.mouseWheelScroll = {sf::Mouse::VerticalWheel, delta, x, y};
    return event;
}

struct InputTest : testing::Test {
    InputTest() {
        camera.set_viewport({0, 0, 1000, 1000});
        camera.set_island(500, 500);
    }
    std::optional<Action> handle(const sf::Event& event, Captured captured = {}) {
        return input.handle(event, captured, camera);
    }
    Camera camera;
    Input input;
};

TEST_F(InputTest, KeysReturnTheActionsOfTheHelp) {
    EXPECT_EQ(handle(press(Key::Space)), Action::PauseOrResume);
    EXPECT_EQ(handle(press(Key::Period)), Action::StepOne);
    EXPECT_EQ(handle(press(Key::Period, true)), Action::StepMany);
    EXPECT_EQ(handle(text('+')), Action::Faster);
    EXPECT_EQ(handle(text('?')), Action::Help);
    EXPECT_EQ(handle(press(Key::Tab)), Action::NextIsland);
    EXPECT_EQ(handle(press(Key::Escape)), Action::Close);
    EXPECT_EQ(handle(press(Key::F1)), Action::Help);
    EXPECT_EQ(handle(press(Key::Q, true)), Action::Quit) << "Shift is ignored by keys without a Shift binding";
    EXPECT_EQ(handle(press(Key::J)), std::nullopt);
    EXPECT_EQ(handle(text('x')), std::nullopt);
}

TEST_F(InputTest, FunctionKeysShowThePanels) {
    EXPECT_EQ(panel_key_of(handle(press(Key::F2)).value()), 2u);
    EXPECT_EQ(panel_key_of(handle(press(Key::F11)).value()), 11u);
    EXPECT_EQ(handle(press(Key::F12)), Action::Sidebar);
    EXPECT_EQ(handle(press(Key::F2)), std::nullopt) << "it is held down";
    EXPECT_EQ(panel_key_of(handle(press(Key::F4), {.keyboard = true}).value()), 4u)
        << "function keys are not text input";
    EXPECT_EQ(panel_key_of(Action::Quit), std::nullopt);
}

TEST_F(InputTest, AHeldKeyActsOnceButStepsRepeat) {
    EXPECT_EQ(handle(press(Key::Space)), Action::PauseOrResume);
    EXPECT_EQ(handle(press(Key::Space)), std::nullopt);
    handle(release(Key::Space));
    EXPECT_EQ(handle(press(Key::Space)), Action::PauseOrResume);
    EXPECT_EQ(handle(press(Key::Period)), Action::StepOne);
    EXPECT_EQ(handle(press(Key::Period)), Action::StepOne);
}

TEST_F(InputTest, AKeyReleasedInAnotherWindowActsAgain) {
    handle(press(Key::Space));
    sf::Event lost{};
    lost.type = sf::Event::LostFocus;
    handle(lost);
    EXPECT_EQ(handle(press(Key::Space)), Action::PauseOrResume);
}

TEST_F(InputTest, KeysWithControlBelongToTheDesktop) {
    EXPECT_EQ(handle(press(Key::Q, false, true)), std::nullopt);
}

TEST_F(InputTest, ShiftTabChoosesThePreviousIsland) {
    EXPECT_EQ(handle(press(Key::Tab, true)), Action::PreviousIsland);
}

TEST_F(InputTest, EventsOfWidgetsCauseNoActions) {
    const Point centre = camera.centre();
    const double zoom = camera.zoom();
    EXPECT_EQ(handle(press(Key::Space), {.keyboard = true}), std::nullopt);
    EXPECT_EQ(handle(text('+'), {.keyboard = true}), std::nullopt);
    handle(wheel(1, 500, 500), {.mouse = true});
    handle(button(sf::Event::MouseButtonPressed, sf::Mouse::Left, 10, 10), {.mouse = true});
    handle(moved(50, 50), {.mouse = true});
    EXPECT_EQ(camera.centre(), centre);
    EXPECT_EQ(camera.zoom(), zoom);
}

TEST_F(InputTest, DraggingPansTheCamera) {
    const Point before = camera.to_screen({250, 250});
    handle(button(sf::Event::MouseButtonPressed, sf::Mouse::Left, 100, 100));
    EXPECT_EQ(input.pointed_at(), std::nullopt);
    handle(moved(130, 80));
    handle(button(sf::Event::MouseButtonReleased, sf::Mouse::Left, 130, 80));
    handle(moved(500, 500));
    const Point after = camera.to_screen({250, 250});
    EXPECT_NEAR(after.x - before.x, 30, 1e-9);
    EXPECT_NEAR(after.y - before.y, -20, 1e-9);
    EXPECT_EQ(input.pointed_at(), (Point{500, 500}));
}

TEST_F(InputTest, AClickIsAPressWithoutADrag) {
    const Point centre = camera.centre();
    handle(button(sf::Event::MouseButtonPressed, sf::Mouse::Left, 100, 100));
    handle(moved(102, 101)); // a small movement during the click
    EXPECT_EQ(input.take_click(), std::nullopt);
    handle(button(sf::Event::MouseButtonReleased, sf::Mouse::Left, 102, 101));
    EXPECT_EQ(input.take_click(), (Point{100, 100}));
    EXPECT_EQ(input.take_click(), std::nullopt);
    EXPECT_EQ(camera.centre(), centre);

    handle(button(sf::Event::MouseButtonPressed, sf::Mouse::Left, 100, 100));
    handle(moved(130, 80));
    handle(moved(100, 100)); // a drag there and back is not a click
    handle(button(sf::Event::MouseButtonReleased, sf::Mouse::Left, 100, 100));
    EXPECT_EQ(input.take_click(), std::nullopt);

    handle(button(sf::Event::MouseButtonPressed, sf::Mouse::Left, 100, 100), {.mouse = true});
    handle(button(sf::Event::MouseButtonReleased, sf::Mouse::Left, 100, 100));
    EXPECT_EQ(input.take_click(), std::nullopt) << "the press was on a panel";
}

TEST_F(InputTest, TheWheelZoomsAtTheCursor) {
    const double zoom = camera.zoom();
    const Point held = camera.to_world({600, 400});
    handle(wheel(2, 600, 400));
    EXPECT_NEAR(camera.zoom(), zoom * 1.44, 1e-9);
    EXPECT_NEAR(camera.to_world({600, 400}).x, held.x, 1e-9);
    handle(wheel(-2, 600, 400));
    EXPECT_NEAR(camera.zoom(), zoom, 1e-9);
}

TEST_F(InputTest, HeldArrowKeysPanTheCamera) {
    const double x = camera.centre().x;
    handle(press(Key::Right));
    input.move(camera, 0.01);
    EXPECT_GT(camera.centre().x, x);
    handle(release(Key::Right));
    const Point there = camera.centre();
    input.move(camera, 0.01);
    EXPECT_EQ(camera.centre(), there);
}

} // namespace
} // namespace evod::viewer
