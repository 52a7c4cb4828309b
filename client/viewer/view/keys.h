// Keys: the table that assigns actions to keys. The help window is generated from it.
//
// Signs (+ − [ ?) are matched as typed characters, so that they work with every keyboard layout. All other keys are
// matched by key code.
//
// Threads      none; constants and pure functions.
#pragma once

#include "client/viewer/panels/panels.h"

#include <SFML/Window/Event.hpp>

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace evod::viewer {

enum class Action {
    PauseOrResume,
    StepOne,
    StepMany,
    Faster,
    Slower,
    RealTime,
    MaxSpeed,
    NextIsland,
    PreviousIsland,
    NextWorld,
    ReplayOrLive,
    PreviousGeneration,
    NextGeneration,
    AllIslands,
    Fit,
    Screenshot,
    CopyLink,
    Sidebar,
    NextColouring,
    Radii,
    Forces,
    Trails,
    Follow,
    Help,
    Close, // closes a menu, or else the help; pressed twice without these: closes the window
    Quit,
    FirstPanel, // FirstPanel + n shows the panel with the function key F(2 + n)
};

/// The function key of the panel that the action shows, such as 4 for F4; nullopt for any other action.
std::optional<unsigned> panel_key_of(Action action);

constexpr unsigned step_many_ticks = 60;

struct KeyBinding {
    Action action;
    sf::Keyboard::Key key = sf::Keyboard::Unknown;
    char sign = 0; // a typed character; if set, `key` is unused
    bool control = false;
    bool shift = false;      // if no binding has Shift, Shift is ignored
    std::string_view help{}; // empty: the key has the same action as the entry before it
};

/// The bindings of all keys except those that show panels.
std::span<const KeyBinding> key_bindings();

/// The action of a pressed key; nullopt if it has none. F2 to F11 show a panel.
std::optional<Action> action_of(const sf::Event::KeyEvent& key);
std::optional<Action> action_of_sign(sf::Uint32 sign);
bool is_function_key(sf::Keyboard::Key key);

/// The name of a key as the help shows it: "Page Up", "Q".
std::string name_of(sf::Keyboard::Key key);

/// A line of the help window.
struct HelpLine {
    std::string keys, text;
};
/// The help on the keys of the window and on the mouse.
std::vector<HelpLine> help_lines();
/// The help on panels: the key that shows each panel.
std::vector<HelpLine> help_lines(const Panels& panels);

} // namespace evod::viewer
