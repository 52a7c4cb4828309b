// Keys: which key asks for what. The one table; the help is made from it.
//
// Signs (+ − [ ?) are taken as text, so that they are found wherever a keyboard layout has them; everything else by
// key.
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
    PastOrPresent,
    PreviousGeneration,
    NextGeneration,
    Beside,
    OtherHalf,
    LinkCameras,
    AllIslands,
    Fit,
    Screenshot,
    NextColouring,
    Radii,
    Forces,
    Trails,
    Follow,
    Start, // to the start screen
    Help,
    Close, // a menu, or else the help, the panel in front; where there is none the window, asked for twice
    Quit,
    FirstPanel, // and from here on the panels after it, by index
};

/// Which panel is to be shown or hidden; nullopt if that is not what the action says.
std::optional<std::size_t> panel_of(Action action);

constexpr unsigned step_many_ticks = 60;

struct KeyBinding {
    Action action;
    sf::Keyboard::Key key = sf::Keyboard::Unknown;
    char sign = 0; // instead of a key
    bool control = false;
    bool shift = false;      // a key without one that has it does the same with Shift
    std::string_view help{}; // empty: another key for what the one before does
};

/// All keys but those of the panels.
std::span<const KeyBinding> key_bindings();

/// What a key asks for that was pressed; a function key after the help's shows or hides a panel.
std::optional<Action> action_of(const sf::Event::KeyEvent& key);
std::optional<Action> action_of_sign(sf::Uint32 sign);
bool is_function_key(sf::Keyboard::Key key);

/// "Page Up", "Q"
std::string name_of(sf::Keyboard::Key key);

/// A line of the help.
struct HelpLine {
    std::string keys, text;
};
/// The keys of the window and what the mouse does.
std::vector<HelpLine> help_lines();
/// The key of each panel, followed by those that the panel takes itself.
std::vector<HelpLine> help_lines(const Panels& panels);

} // namespace evod::viewer
