#include "client/viewer/stage/input.h"

#include <cmath>

namespace evod::viewer {

namespace {

using Key = sf::Keyboard;

struct KeyBinding {
    Key::Key key;
    Action action;
};
constexpr KeyBinding key_bindings[] = {
    {Key::Space, Action::PauseOrResume},
    {Key::M, Action::MaxSpeed},
    {Key::Tab, Action::NextIsland},
    {Key::PageDown, Action::NextIsland},
    {Key::PageUp, Action::PreviousIsland},
    {Key::W, Action::NextWorld},
    {Key::P, Action::PastOrPresent},
    {Key::B, Action::Beside},
    {Key::X, Action::OtherHalf},
    {Key::K, Action::LinkCameras},
    {Key::I, Action::AllIslands},
    {Key::F, Action::Fit},
    {Key::Home, Action::Fit},
    {Key::C, Action::NextColouring},
    {Key::V, Action::Radii},
    {Key::G, Action::Forces},
    {Key::T, Action::Trails},
    {Key::L, Action::Follow},
    {Key::S, Action::Screenshot},
    {Key::Backspace, Action::Start},
    {Key::H, Action::Help},
    {Key::F1, Action::Help},
    {Key::Q, Action::Quit},
    {Key::Escape, Action::Close},
};

struct SignBinding {
    sf::Uint32 sign;
    Action action;
};
constexpr SignBinding sign_bindings[] = {
    {'+', Action::Faster},
    {'=', Action::Faster},
    {'-', Action::Slower},
    {'_', Action::Slower},
    {'1', Action::RealTime},
    {'?', Action::Help},
    {'[', Action::PreviousGeneration},
    {']', Action::NextGeneration},
};

constexpr HelpLine lines[] = {
    {"Space", "run, pause, go on"},
    {".", "one tick, then pause"},
    {"Shift + .", "60 ticks, then pause"},
    {"+   -", "twice, half as fast"},
    {"1", "as fast as real time"},
    {"M", "as fast as the server can; again: as before"},
    {"Tab   Page Up   Page Down", "next or previous island"},
    {"I", "all islands at once, or one"},
    {"W", "next world"},
    {"P", "the past of the world; again: the present"},
    {"[   ]", "in the past: the generation before, the next one"},
    {"B", "a second world beside; again: only the one with the focus"},
    {"X   click", "the keys act on the other half"},
    {"K", "all cameras show the same part, or each its own"},
    {"Wheel", "zoom at the cursor"},
    {"Drag   arrow keys", "move the picture"},
    {"F   Home", "show the whole island"},
    {"Click", "select an organism; beside them: nobody"},
    {"L", "follow who is selected; again: no more"},
    {"C", "colour by a gene, health, lineage, nothing"},
    {"V   G   T", "show perception radii, forces, trails"},
    {"S", "save the picture as PNG"},
    {"Backspace", "to the start screen: another server, another token"},
    {"H   F1", "show or hide this help"},
    {"Esc", "close the help, else the panel in front, else quit"},
    {"Q", "quit; the worlds run on"},
};

// One panel for each: F1 is the help.
constexpr Key::Key first_panel_key = Key::F2, last_panel_key = Key::F12;
constexpr std::size_t panel_key_count = last_panel_key - first_panel_key + 1;

constexpr double zoom_of_one_notch = 1.2;
constexpr double pan_pixels_per_s = 700;
constexpr double click_pixels_max = 4;

} // namespace

std::span<const HelpLine> help_lines() {
    return lines;
}

std::optional<std::size_t> panel_of(Action action) {
    return action < Action::FirstPanel
               ? std::nullopt
               : std::optional{static_cast<std::size_t>(action) - static_cast<std::size_t>(Action::FirstPanel)};
}

std::string panel_key(std::size_t index) {
    return index < panel_key_count ? "F" + std::to_string(index + 2) : "";
}

std::optional<Action> Input::press(const sf::Event::KeyEvent& key) {
    const bool repeated = !held_.insert(key.code).second;
    if (key.control || key.alt || key.system) {
        return std::nullopt;
    }
    if (key.code == Key::Period) {
        return key.shift ? Action::StepMany : Action::StepOne;
    }
    if (repeated) {
        return std::nullopt;
    }
    if (key.code == Key::Tab && key.shift) {
        return Action::PreviousIsland;
    }
    if (key.code >= first_panel_key && key.code <= last_panel_key) {
        return static_cast<Action>(static_cast<int>(Action::FirstPanel) + key.code - first_panel_key);
    }
    for (const KeyBinding& binding : key_bindings) {
        if (binding.key == key.code) {
            return binding.action;
        }
    }
    return std::nullopt;
}

std::optional<Action> Input::handle(const sf::Event& event, Captured captured, Camera& camera) {
    switch (event.type) {
    case sf::Event::Closed:
        return Action::Quit;
    case sf::Event::LostFocus: // the releases will be told to somebody else
        held_.clear();
        dragging_ = false;
        pressed_at_.reset();
        break;
    case sf::Event::KeyPressed:
        if (!captured.keyboard || (event.key.code >= Key::F1 && event.key.code <= last_panel_key)) { // no text
            return press(event.key);
        }
        break;
    case sf::Event::KeyReleased:
        held_.erase(event.key.code);
        break;
    case sf::Event::TextEntered:
        if (!captured.keyboard) {
            for (const SignBinding& binding : sign_bindings) {
                if (binding.sign == event.text.unicode) {
                    return binding.action;
                }
            }
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
            break; // a hand that clicks trembles
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
                           std::pow(zoom_of_one_notch, event.mouseWheelScroll.delta));
        }
        break;
    default:
        break;
    }
    return std::nullopt;
}

void Input::move(Camera& camera, double seconds) const {
    const auto held = [this](Key::Key key) { return held_.contains(key) ? 1.0 : 0.0; };
    const double pixels = pan_pixels_per_s * seconds;
    // An arrow moves the eye, so the picture goes the other way.
    camera.pan({pixels * (held(Key::Left) - held(Key::Right)), pixels * (held(Key::Up) - held(Key::Down))});
}

} // namespace evod::viewer
