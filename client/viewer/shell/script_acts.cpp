#include "client/viewer/shell/script_acts.h"

#include <SFML/System/String.hpp>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <iterator>
#include <memory>
#include <utility>

namespace evod::viewer::acts {

namespace {

using Key = sf::Keyboard;
using Host = Script::Host;
using Run = Script::Run;

/// Returns the names as a list: "a, b, c".
std::string comma_list(const std::vector<std::string>& names) {
    std::string text;
    for (const std::string& name : names) {
        text += (text.empty() ? "" : ", ") + name;
    }
    return text;
}

// ---- keys ------------------------------------------------------------------------------------------------------

struct KeyName {
    std::string_view name;
    Key::Key key;
};
constexpr KeyName key_names[] = {
    {"Space", Key::Space},
    {"Enter", Key::Enter},
    {"Escape", Key::Escape},
    {"Tab", Key::Tab},
    {"Backspace", Key::Backspace},
    {"Delete", Key::Delete},
    {"Home", Key::Home},
    {"End", Key::End},
    {"PageUp", Key::PageUp},
    {"PageDown", Key::PageDown},
    {"Left", Key::Left},
    {"Right", Key::Right},
    {"Up", Key::Up},
    {"Down", Key::Down},
    {".", Key::Period},
};

struct Chord {
    Key::Key key = Key::Unknown;
    sf::Uint32 sign = 0; // a typed character; if set, `key` is unused
    bool control = false, shift = false, alt = false;
};

/// Parses a key combination such as "F4", "Ctrl+A" or "+". Returns nullopt if there is no such key.
std::optional<Chord> parse_chord(std::string_view text) {
    Chord chord;
    const auto take = [&](std::string_view modifier) {
        const bool there = text.size() > modifier.size() && text.starts_with(modifier);
        text.remove_prefix(there ? modifier.size() : 0);
        return there;
    };
    for (bool more = true; more;) {
        more = false;
        for (const auto& [modifier, held] :
             {std::pair{"Ctrl+", &chord.control}, {"Shift+", &chord.shift}, {"Alt+", &chord.alt}}) {
            if (take(modifier)) {
                *held = more = true;
            }
        }
    }
    if (const auto* found = std::ranges::find(key_names, text, &KeyName::name); found != std::end(key_names)) {
        chord.key = found->key;
    } else if (text.size() == 1 && text[0] >= 'A' && text[0] <= 'Z') {
        chord.key = static_cast<Key::Key>(Key::A + (text[0] - 'A'));
    } else if (text.size() == 1 && std::isgraph(static_cast<unsigned char>(text[0])) != 0 &&
               std::isalpha(static_cast<unsigned char>(text[0])) == 0) {
        chord.sign = static_cast<unsigned char>(text[0]);
    } else if (text.size() > 1 && text[0] == 'F') {
        const auto number = number_in<int>(std::string{text.substr(1)});
        if (!number || *number < 1 || *number > 12) {
            return std::nullopt;
        }
        chord.key = static_cast<Key::Key>(Key::F1 + *number - 1);
    } else {
        return std::nullopt;
    }
    return chord;
}

void send_key(Host& host, bool pressed, Key::Key key, const Chord& held) {
    sf::Event event{};
    event.type = pressed ? sf::Event::KeyPressed : sf::Event::KeyReleased;
    event.key = sf::Event::KeyEvent{};
    event.key.code = key;
    event.key.alt = held.alt;
    event.key.control = held.control;
    event.key.shift = held.shift;
    host.send(event);
}

void send_text(Host& host, const std::string& utf8) {
    for (const sf::Uint32 sign : sf::String::fromUtf8(utf8.begin(), utf8.end())) {
        sf::Event event{};
        event.type = sf::Event::TextEntered;
        event.text.unicode = sign;
        host.send(event);
    }
}

void send_chord(Host& host, const Chord& chord) {
    if (chord.sign != 0) {
        send_text(host, std::string(1, static_cast<char>(chord.sign)));
        return;
    }
    const std::pair<bool, Key::Key> modifiers[] = {
        {chord.control, Key::LControl}, {chord.shift, Key::LShift}, {chord.alt, Key::LAlt}};
    for (const auto& [held, key] : modifiers) {
        if (held) {
            send_key(host, true, key, chord);
        }
    }
    send_key(host, true, chord.key, chord);
    send_key(host, false, chord.key, chord);
    for (const auto& [held, key] : modifiers) {
        if (held) {
            send_key(host, false, key, {});
        }
    }
}

} // namespace

std::optional<Acts> press(std::string_view key) {
    const auto chord = parse_chord(key);
    if (!chord) {
        return std::nullopt;
    }
    return Acts{[chord = *chord](Run& run) -> Waits {
                    send_chord(run.host, chord);
                    ++run.actions;
                    return "";
                },
                [](Run& run) -> Waits {
                    if (std::string problem = run.host.key_problem(); !problem.empty()) {
                        return usage(std::move(problem));
                    }
                    return "";
                }};
}

Acts type(const std::string& text) {
    return {[text](Run& run) -> Waits {
                if (!run.host.typed_text()) {
                    return "no field has the keyboard focus";
                }
                send_text(run.host, text);
                ++run.actions;
                return "";
            },
            [text](Run& run) -> Waits {
                const auto typed = run.host.typed_text();
                if (typed && typed->find(text) == std::string::npos) {
                    return usage("the field contains " + in_quotes(*typed));
                }
                return "";
            }};
}

// ---- mouse -----------------------------------------------------------------------------------------------------

namespace {

void send_mouse_move(Host& host, Point place) {
    sf::Event event{};
    event.type = sf::Event::MouseMoved;
    event.mouseMove = {static_cast<int>(place.x), static_cast<int>(place.y)};
    host.send(event);
}

void send_button(Host& host, sf::Event::EventType type, Point place, sf::Mouse::Button button = sf::Mouse::Left) {
    sf::Event event{};
    event.type = type;
    event.mouseButton = {button, static_cast<int>(place.x), static_cast<int>(place.y)};
    host.send(event);
}

void send_click(Host& host, Point place, sf::Mouse::Button button, bool with_control = false) {
    const Chord held{.control = with_control};
    if (with_control) {
        send_key(host, true, Key::LControl, held);
    }
    send_button(host, sf::Event::MouseButtonPressed, place, button);
    send_button(host, sf::Event::MouseButtonReleased, place, button);
    if (with_control) {
        send_key(host, false, Key::LControl, {});
    }
}

/// Finds the only widget with this name. Returns null if there is none. If several widgets have the name, returns an
/// error that lists their full names.
core::Result<const MarkedWidget*> only(const Host& host, const std::string& name) {
    const auto found = host.find(name);
    if (found.size() < 2) {
        return found.empty() ? nullptr : found.front();
    }
    std::vector<std::string> names;
    for (const MarkedWidget* widget : found) {
        names.push_back(widget->full_name());
    }
    return usage(std::to_string(found.size()) + " widgets have the name " + in_quotes(name) + ": " + comma_list(names));
}

/// Returns why the user cannot use the widget now; empty if he can. Scrolls to a widget that is out of sight.
Waits obstacle(Run& run, const std::string& name) {
    const auto found = only(run.host, name);
    if (!found) {
        return found.error();
    }
    const MarkedWidget* widget = *found;
    if (widget == nullptr) {
        if (std::string absence = run.host.absence(name); !absence.empty()) {
            return usage(std::move(absence));
        }
        return "no widget " + in_quotes(name) + " is on the screen";
    }
    if (!widget->enabled) {
        return in_quotes(name) + " is disabled" + (widget->note.empty() ? "" : ": " + widget->note);
    }
    if (!widget->visible) {
        run.host.reveal(widget->full_name());
        run.actions += run.scrolled ? 0 : 1;
        run.scrolled = true;
        return in_quotes(name) + " is scrolled out of sight";
    }
    return "";
}

/// Moves the mouse to a widget as soon as it is enabled and visible.
Waits move_to(Run& run, const std::string& name) {
    auto waits = obstacle(run, name);
    if (waits && waits->empty()) {
        send_mouse_move(run.host, run.host.find(name).front()->centre());
    }
    return waits;
}

/// Moves the mouse to a widget, and waits until nothing else is under the mouse.
Waits point_at(Run& run, const std::string& name) {
    auto waits = move_to(run, name);
    if (!waits || !waits->empty()) {
        return waits;
    }
    const MarkedWidget& widget = *run.host.find(name).front();
    const unsigned hovered = run.host.hovered();
    if (hovered == 0 || (widget.id != 0 && hovered != widget.id)) {
        return in_quotes(name) + " does not react to clicks, or is covered";
    }
    return "";
}

Waits click_on(Run& run, const std::string& name, sf::Mouse::Button button = sf::Mouse::Left, bool control = false) {
    auto waits = point_at(run, name);
    if (waits && waits->empty()) {
        send_click(run.host, run.host.find(name).front()->centre(), button, control);
        ++run.actions;
    }
    return waits;
}

/// Moves the mouse to a place of an island as soon as it is on the screen.
Waits move_to(Run& run, const Script::IslandPlace& place) {
    const auto point = run.host.locate(place);
    if (!point) {
        return place.organism ? "organism " + std::to_string(*place.organism) + " is not on the screen"
                              : std::string{"this place is not on the screen"};
    }
    send_mouse_move(run.host, *point);
    return "";
}

} // namespace

Acts click(const std::string& widget, sf::Mouse::Button button) {
    return {[widget](Run& run) { return move_to(run, widget); },
            [widget, button](Run& run) { return click_on(run, widget, button); }};
}

Acts click(const Script::IslandPlace& place) {
    return {[place](Run& run) { return move_to(run, place); },
            [place](Run& run) -> Waits {
                if (auto waits = move_to(run, place); !waits->empty()) {
                    return waits; // a moving organism may have left the screen
                }
                if (run.host.covered()) {
                    return "the place is covered";
                }
                send_click(run.host, *run.host.locate(place), sf::Mouse::Left);
                ++run.actions;
                return "";
            },
            [place](Run& run) -> Waits {
                const auto selected = run.host.selected();
                if (place.organism && selected != place.organism) {
                    return usage("the click has selected " +
                                 (selected ? "organism " + std::to_string(*selected) : "no organism"));
                }
                return "";
            }};
}

std::optional<core::Result<Script::IslandPlace>> island_place(std::string_view kind, const std::string& word) {
    Script::IslandPlace place;
    if (kind == "organism") {
        place.organism = number_in<std::uint32_t>(word);
        return place.organism ? core::Result<Script::IslandPlace>{place}
                              : core::Result<Script::IslandPlace>{usage("a whole number")};
    }
    if (kind != "at") {
        return std::nullopt;
    }
    const std::size_t comma = word.find(',');
    if (comma != std::string::npos) {
        const double outside = -1;
        place.at = {number_in<double>(word.substr(0, comma)).value_or(outside),
                    number_in<double>(word.substr(comma + 1)).value_or(outside)};
    }
    const Rectangle island{0, 0, 1, 1};
    if (comma == std::string::npos || !island.contains(place.at)) {
        return usage("two numbers from 0 to 1, such as 0.4,0.6");
    }
    return place;
}

// ---- values ----------------------------------------------------------------------------------------------------

namespace {

/// Returns whether two values of a widget are equal: as numbers if both are numbers, otherwise as text, in which _
/// counts as a space. Sliders store some numbers with single precision.
bool same_value(const std::string& a, const std::string& b) {
    constexpr double tolerance = 1e-6;
    const auto x = number_in<double>(a), y = number_in<double>(b);
    const auto plain = [](std::string text) {
        std::ranges::replace(text, '_', ' ');
        return text;
    };
    return plain(a) == plain(b) || (x && y && std::abs(*x - *y) <= tolerance * std::max(std::abs(*x), std::abs(*y)));
}

/// Sets the value of a widget: replaces the text of a field, chooses an entry of a drop-down, or switches a check box.
class Setting {
  public:
    Setting(std::string name, std::string text) : name_{std::move(name)}, text_{std::move(text)} {}

    Waits begin(Run& run) {
        auto waits = move_to(run, name_);
        if (waits && waits->empty()) {
            kind_ = run.host.find(name_).front()->kind;
            entry_ = run.host.find(name_).front()->full_name() + ": " + text_;
            if (kind_ == Kind::CheckBox && text_ != "on" && text_ != "off") {
                return usage(in_quotes(name_) + " is a check box: got " + in_quotes(text_) + ", allowed on, off");
            }
        }
        return waits;
    }
    Waits click(Run& run) {
        const auto found = run.host.find(name_);
        if (kind_ == Kind::CheckBox && found.size() == 1 && found.front()->value == text_) {
            return "";
        }
        return click_on(run, name_, sf::Mouse::Left, kind_ != Kind::DropDown && kind_ != Kind::CheckBox);
    }
    Waits select_all_or_point_at_entry(Run& run) {
        if (kind_ == Kind::CheckBox) {
            return "";
        }
        if (kind_ == Kind::DropDown) {
            return with_entries(run, move_to(run, entry_));
        }
        if (!run.host.typed_text()) {
            return in_quotes(name_) + " is not a field";
        }
        send_chord(run.host, {.key = Key::A, .control = true});
        return "";
    }
    Waits type_or_choose(Run& run) {
        if (kind_ == Kind::CheckBox) {
            return "";
        }
        if (kind_ == Kind::DropDown) {
            return with_entries(run, click_on(run, entry_));
        }
        if (text_.empty()) {
            send_chord(run.host, {.key = Key::Delete});
        }
        send_text(run.host, text_);
        ++run.actions;
        return "";
    }
    Waits confirm(Run& run) {
        if (kind_ == Kind::CheckBox || kind_ == Kind::DropDown) {
            return "";
        }
        if (const auto typed = run.host.typed_text(); typed != text_) {
            return usage(in_quotes(name_) + " does not accept this text; it contains " + in_quotes(typed.value_or("")));
        }
        send_chord(run.host, {.key = Key::Enter});
        ++run.actions;
        return "";
    }
    /// Waits until the widget shows the value. A widget that has left the screen has used the value.
    Waits check(Run& run) const {
        const auto found = run.host.find(name_);
        if (found.size() == 1 && found.front()->value && !same_value(*found.front()->value, text_)) {
            return in_quotes(name_) + " is " + in_quotes(*found.front()->value);
        }
        return "";
    }

  private:
    using Kind = MarkedWidget::Kind;

    /// Adds the entries of the open drop-down to what the line waits for.
    Waits with_entries(const Run& run, Waits waits) const {
        const auto found = run.host.find(name_);
        if (waits && !waits->empty() && found.size() == 1 && !found.front()->choices.empty()) {
            return in_quotes(name_) + " offers " + comma_list(found.front()->choices);
        }
        return waits;
    }

    std::string name_, text_;
    std::string entry_;       // of a drop-down: the name of the entry to choose
    Kind kind_ = Kind::Other; // determined before the click, because a choice may remove the drop-down
};

} // namespace

Acts set(const std::string& widget, const std::string& text) {
    const auto setting = std::make_shared<Setting>(widget, text);
    return {[setting](Run& run) { return setting->begin(run); },
            [setting](Run& run) { return setting->click(run); },
            [setting](Run& run) { return setting->select_all_or_point_at_entry(run); },
            [setting](Run& run) { return setting->type_or_choose(run); },
            [setting](Run& run) { return setting->confirm(run); },
            [setting](Run& run) { return setting->check(run); }};
}

} // namespace evod::viewer::acts
