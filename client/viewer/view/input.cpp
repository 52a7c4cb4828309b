#include "client/viewer/view/input.h"

#include <cmath>

namespace evod::viewer {

namespace {

using Key = sf::Keyboard;

constexpr double wheel_zoom_factor = 1.2;
constexpr double pan_pixels_per_s = 700;
constexpr double click_pixels_max = 4;

} // namespace

std::optional<Action> Input::press(const sf::Event::KeyEvent& key) {
    const bool repeated = !held_.insert(key.code).second;
    const auto action = action_of(key);
    return repeated && action != Action::StepOne && action != Action::StepMany ? std::nullopt : action;
}

std::optional<Action> Input::handle(const sf::Event& event, Captured captured, Camera& camera) {
    switch (event.type) {
    case sf::Event::Closed:
        return Action::Quit;
    case sf::Event::LostFocus: // another window will receive the key releases
        held_.clear();
        dragging_ = false;
        pressed_at_.reset();
        break;
    case sf::Event::KeyPressed:
        if (!captured.keyboard || is_function_key(event.key.code)) { // function keys are never text input
            return press(event.key);
        }
        break;
    case sf::Event::KeyReleased:
        held_.erase(event.key.code);
        break;
    case sf::Event::TextEntered:
        if (!captured.keyboard) {
            return action_of_sign(event.text.unicode);
        }
        break;
    case sf::Event::MouseButtonPressed:
        dragging_ = !captured.mouse && event.mouseButton.button != sf::Mouse::Right;
        mouse_ = Point{double(event.mouseButton.x), double(event.mouseButton.y)};
        pressed_at_ = dragging_ && event.mouseButton.button == sf::Mouse::Left ? mouse_ : std::nullopt;
        break;
    case sf::Event::MouseButtonReleased:
        dragging_ = false;
        clicked_ = std::exchange(pressed_at_, std::nullopt);
        break;
    case sf::Event::MouseMoved: {
        const Point now{double(event.mouseMove.x), double(event.mouseMove.y)};
        if (pressed_at_ && std::hypot(now.x - pressed_at_->x, now.y - pressed_at_->y) < click_pixels_max) {
            break; // a small movement during a click is not a drag
        }
        if (dragging_ && mouse_) {
            camera.pan({now.x - mouse_->x, now.y - mouse_->y});
            pressed_at_.reset();
        }
        mouse_ = now;
        break;
    }
    case sf::Event::MouseLeft:
        mouse_.reset();
        break;
    case sf::Event::MouseWheelScrolled:
        if (!captured.mouse && event.mouseWheelScroll.wheel == sf::Mouse::VerticalWheel) {
            camera.zoom_at({double(event.mouseWheelScroll.x), double(event.mouseWheelScroll.y)},
                           std::pow(wheel_zoom_factor, event.mouseWheelScroll.delta));
        }
        break;
    default:
        break;
    }
    return std::nullopt;
}

bool Input::moves_camera(const sf::Event& event) {
    return event.type == sf::Event::KeyPressed && event.key.code >= Key::Left && event.key.code <= Key::Down;
}

void Input::move(Camera& camera, double seconds) const {
    const auto held = [this](Key::Key key) { return held_.contains(key) ? 1.0 : 0.0; };
    const double pixels = pan_pixels_per_s * seconds;
    // An arrow key moves the camera, so the drawn island moves in the opposite direction.
    camera.pan({pixels * (held(Key::Left) - held(Key::Right)), pixels * (held(Key::Up) - held(Key::Down))});
}

} // namespace evod::viewer
