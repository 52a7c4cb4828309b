// Keys: the table of keys and their actions, from which the help window is generated.
//
// Signs (+ − [ ?) are matched as text, so that they work with every keyboard layout; all others are matched by key.
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
    Beside,
    OtherPane,
    LinkCameras,
    AllIslands,
    Fit,
    Screenshot,
    NextColouring,
    Radii,
    Forces,
    Trails,
    Follow,
    StartScreen,
    Help,
    Close, // a menu, else the help, else the panel in front; else, if pressed twice, the window
    Quit,
    FirstPanel, // values from here on are panels, by index
};

/// The panel that the action shows or hides; nullopt for any other action.
std::optional<std::size_t> panel_of(Action action);

constexpr unsigned step_many_ticks = 60;

struct KeyBinding {
    Action action;
    sf::Keyboard::Key key = sf::Keyboard::Unknown;
    char sign = 0; // instead of a key
    bool control = false;
    bool shift = false;      // a key without a Shift binding acts the same with Shift
    std::string_view help{}; // empty: another key for the action before it
};

/// All keys except those of the panels.
std::span<const KeyBinding> key_bindings();

/// The action of a pressed key. F2 to F12 show or hide a panel.
std::optional<Action> action_of(const sf::Event::KeyEvent& key);
std::optional<Action> action_of_sign(sf::Uint32 sign);
bool is_function_key(sf::Keyboard::Key key);

/// "Page Up", "Q"
std::string name_of(sf::Keyboard::Key key);

/// A line of the help window.
struct HelpLine {
    std::string keys, text;
};
/// The keys of the window, and the mouse.
std::vector<HelpLine> help_lines();
/// The key that shows each panel, followed by the keys that the panels use.
std::vector<HelpLine> help_lines(const Panels& panels);

} // namespace evod::viewer
