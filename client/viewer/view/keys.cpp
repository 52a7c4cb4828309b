#include "client/viewer/view/keys.h"

#include <algorithm>
#include <iterator>
#include <utility>

namespace evod::viewer {

namespace {

using Key = sf::Keyboard;

constexpr KeyBinding bindings[] = {
    {.action = Action::PauseOrResume, .key = Key::Space, .help = "run, pause, resume"},
    {.action = Action::StepOne, .key = Key::Period, .help = "one tick, then pause"},
    {.action = Action::StepMany, .key = Key::Period, .shift = true, .help = "60 ticks, then pause"},
    {.action = Action::Faster, .sign = '+', .help = "double the speed"},
    {.action = Action::Faster, .sign = '='},
    {.action = Action::Slower, .sign = '-', .help = "halve the speed"},
    {.action = Action::Slower, .sign = '_'},
    {.action = Action::RealTime, .sign = '1', .help = "real time"},
    {.action = Action::MaxSpeed, .key = Key::M, .help = "maximum speed; again: the previous speed"},
    {.action = Action::NextIsland, .key = Key::Tab, .help = "next island"},
    {.action = Action::NextIsland, .key = Key::PageDown},
    {.action = Action::PreviousIsland, .key = Key::Tab, .shift = true, .help = "previous island"},
    {.action = Action::PreviousIsland, .key = Key::PageUp},
    {.action = Action::AllIslands, .key = Key::I, .help = "show all islands, or only the chosen one"},
    {.action = Action::NextWorld, .key = Key::W, .help = "next world"},
    {.action = Action::ReplayOrLive, .key = Key::P, .help = "replay the run of the world; again: the live world"},
    {.action = Action::PreviousGeneration, .sign = '[', .help = "in a replay: the previous generation"},
    {.action = Action::NextGeneration, .sign = ']', .help = "in a replay: the next generation"},
    {.action = Action::Fit, .key = Key::F, .help = "show the whole island"},
    {.action = Action::Fit, .key = Key::Home},
    {.action = Action::Follow, .key = Key::L, .help = "follow the selected organism; again: stop"},
    {.action = Action::NextColouring, .key = Key::C, .help = "colour by a gene, health, nothing"},
    {.action = Action::Radii, .key = Key::V, .help = "perception radii: of the organism at the mouse, of all, of none"},
    {.action = Action::Forces, .key = Key::G, .help = "forces: of the organism at the mouse, of all, of none"},
    {.action = Action::Trails, .key = Key::T, .help = "show or hide trails"},
    {.action = Action::Screenshot, .key = Key::S, .help = "save the window as PNG in the working folder"},
    {.action = Action::CopyLink,
     .key = Key::C,
     .control = true,
     .help = "copy a link that shows this moment in a browser"},
    {.action = Action::Sidebar, .key = Key::F12, .help = "collapse the sidebar; again: show it"},
    {.action = Action::Help, .key = Key::H, .help = "show or hide this help"},
    {.action = Action::Help, .key = Key::F1},
    {.action = Action::Help, .sign = '?'},
    {.action = Action::Close, .key = Key::Escape, .help = "close a menu or the help; twice: quit"},
    {.action = Action::Quit, .key = Key::Q, .help = "quit at once; the worlds continue"},
};

/// Mouse gestures, and keys that act as long as they are held down, with their texts in the help.
constexpr std::pair<std::string_view, std::string_view> gestures[] = {
    {"Wheel", "zoom at the cursor"},
    {"Drag   ← → ↑ ↓", "move the camera"},
    {"Click", "select an organism; on empty space: select none"},
    {"", "also chooses this island"},
};

constexpr Key::Key first_panel_key = Key::F2, last_panel_key = Key::F11;

constexpr std::pair<Key::Key, std::string_view> names[] = {
    {Key::Space, "Space"}, {Key::Tab, "Tab"}, {Key::PageUp, "Page Up"}, {Key::PageDown, "Page Down"},
    {Key::Home, "Home"},   {Key::End, "End"}, {Key::Enter, "Enter"},    {Key::Escape, "Esc"},
    {Key::Period, "."},    {Key::Left, "←"},  {Key::Right, "→"},        {Key::Up, "↑"},
    {Key::Down, "↓"},
};

std::string stroke(const std::string& key, bool control, bool shift) {
    return (control ? "Ctrl+" : "") + std::string{shift ? "Shift+" : ""} + key;
}

/// Adds a line to the help. If `text` is empty, adds the key to the last line instead.
void add(std::vector<HelpLine>& lines, const std::string& keys, std::string_view text) {
    if (text.empty()) {
        lines.back().keys += "   " + keys;
    } else {
        lines.push_back({keys, std::string{text}});
    }
}

} // namespace

std::optional<unsigned> panel_key_of(Action action) {
    const int beyond = static_cast<int>(action) - static_cast<int>(Action::FirstPanel);
    return beyond < 0 ? std::nullopt : std::optional{static_cast<unsigned>(first_panel_key - Key::F1 + 1 + beyond)};
}

std::span<const KeyBinding> key_bindings() {
    return bindings;
}

std::optional<Action> action_of(const sf::Event::KeyEvent& key) {
    if (key.alt || key.system) {
        return std::nullopt; // key combinations for the desktop
    }
    if (!key.control && key.code >= first_panel_key && key.code <= last_panel_key) {
        return static_cast<Action>(static_cast<int>(Action::FirstPanel) + key.code - first_panel_key);
    }
    const auto find = [&](bool shift) {
        return std::ranges::find_if(bindings, [&](const KeyBinding& binding) {
            return binding.sign == 0 && binding.key == key.code && binding.control == key.control &&
                   binding.shift == shift;
        });
    };
    const auto* found = find(key.shift);
    found = found == std::end(bindings) ? find(false) : found;
    return found == std::end(bindings) ? std::nullopt : std::optional{found->action};
}

std::optional<Action> action_of_sign(sf::Uint32 sign) {
    const auto* found = std::ranges::find_if(bindings, [&](const KeyBinding& binding) {
        return binding.sign != 0 && static_cast<sf::Uint32>(binding.sign) == sign;
    });
    return found == std::end(bindings) ? std::nullopt : std::optional{found->action};
}

bool is_function_key(sf::Keyboard::Key key) {
    return key >= Key::F1 && key <= Key::F12;
}

std::string name_of(sf::Keyboard::Key key) {
    if (key >= Key::A && key <= Key::Z) {
        return {static_cast<char>('A' + (key - Key::A))};
    }
    if (is_function_key(key)) {
        return "F" + std::to_string(key - Key::F1 + 1);
    }
    const auto* found = std::ranges::find(names, key, [](const auto& name) { return name.first; });
    return found == std::end(names) ? "" : std::string{found->second};
}

std::vector<HelpLine> help_lines() {
    std::vector<HelpLine> lines;
    for (const KeyBinding& binding : bindings) {
        const std::string key = binding.sign != 0 ? std::string(1, binding.sign) : name_of(binding.key);
        add(lines, stroke(key, binding.control, binding.shift), binding.help);
    }
    for (const auto& [hand, text] : gestures) {
        lines.push_back({std::string{hand}, std::string{text}});
    }
    return lines;
}

std::vector<HelpLine> help_lines(const Panels& panels) {
    std::vector<HelpLine> lines;
    for (std::size_t i = 0; i < panels.titles().size(); ++i) {
        lines.push_back({panels.key_of(i), "show the panel " + std::string{panels.titles()[i]}});
    }
    return lines;
}

} // namespace evod::viewer
