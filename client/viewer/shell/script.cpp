#include "client/viewer/shell/script.h"

#include "client/viewer/world/viewed_world.h"

#include <SFML/System/String.hpp>

#include <algorithm>
#include <cctype>
#include <charconv>
#include <iterator>
#include <memory>
#include <utility>

namespace evod::viewer {

namespace {

using Key = sf::Keyboard;
using Host = Script::Host;
using Acts = std::vector<Script::Act>;

constexpr double timeout_s_default = 60, timeout_s_max = 86'400;

core::Error usage(std::string what) {
    return {.kind = core::Error::Kind::Usage, .what = std::move(what)};
}

std::string in_quotes(std::string_view text) {
    return "\"" + std::string{text} + "\"";
}

/// Returns the names as a list: "a, b, c".
std::string comma_list(const std::vector<std::string>& names) {
    std::string text;
    for (const std::string& name : names) {
        text += (text.empty() ? "" : ", ") + name;
    }
    return text;
}

// ---- words -----------------------------------------------------------------------------------------------------

/// Splits a line into words and removes the quotes. Returns an error if a quote is not closed.
core::Result<std::vector<std::string>> words_of(std::string_view line) {
    std::vector<std::string> words;
    for (std::size_t i = 0; i < line.size();) {
        if (std::isspace(static_cast<unsigned char>(line[i])) != 0) {
            ++i;
        } else if (line[i] == '#') {
            break;
        } else if (line[i] == '"') {
            const std::size_t end = line.find('"', i + 1);
            if (end == std::string_view::npos) {
                return usage("word " + std::to_string(words.size() + 1) + ": the quote is not closed");
            }
            words.emplace_back(line.substr(i + 1, end - i - 1));
            i = end + 1;
        } else {
            std::size_t end = i;
            while (end < line.size() && std::isspace(static_cast<unsigned char>(line[end])) == 0) {
                ++end;
            }
            words.emplace_back(line.substr(i, end - i));
            i = end;
        }
    }
    return words;
}

template <class Number>
std::optional<Number> number_in(const std::string& word) {
    Number number{};
    const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), number);
    return error == std::errc{} && end == word.data() + word.size() ? std::optional{number} : std::nullopt;
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
    event.key = {.code = key, .alt = held.alt, .control = held.control, .shift = held.shift, .system = false};
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

void press(Host& host, const Chord& chord) {
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

Script::Act press_act(Chord chord) {
    return [chord](Host& host) -> core::Result<bool> {
        press(host, chord);
        return true;
    };
}

Script::Act type_act(std::string text) {
    return [text = std::move(text)](Host& host) -> core::Result<bool> {
        send_text(host, text);
        return true;
    };
}

// ---- mouse -----------------------------------------------------------------------------------------------------

/// Moves the mouse to a widget. Returns false if the widget is not on the screen.
bool move_to(Host& host, const std::string& widget) {
    const auto place = host.find(widget);
    if (place) {
        sf::Event event{};
        event.type = sf::Event::MouseMoved;
        event.mouseMove = {static_cast<int>(place->x), static_cast<int>(place->y)};
        host.send(event);
    }
    return place.has_value();
}

/// Presses and releases the left button on a widget. Returns false if the widget is not on the screen.
bool click_on(Host& host, const std::string& widget, bool with_control) {
    const auto place = host.find(widget);
    if (!place) {
        return false;
    }
    const Chord held{.control = with_control};
    if (with_control) {
        send_key(host, true, Key::LControl, held);
    }
    for (const auto type : {sf::Event::MouseButtonPressed, sf::Event::MouseButtonReleased}) {
        sf::Event event{};
        event.type = type;
        event.mouseButton = {sf::Mouse::Left, static_cast<int>(place->x), static_cast<int>(place->y)};
        host.send(event);
    }
    if (with_control) {
        send_key(host, false, Key::LControl, {});
    }
    return true;
}

/// Clicks on a widget in two steps: the first moves the mouse there, the second clicks. One frame is drawn between
/// them.
Acts click_acts(const std::string& widget) {
    return {[widget](Host& host) -> core::Result<bool> { return move_to(host, widget); },
            [widget](Host& host) -> core::Result<bool> { return click_on(host, widget, false); }};
}

/// Sets the value of a widget: replaces the text of a field, or opens a drop-down and clicks on the choice with this
/// text.
Acts set_acts(const std::string& widget, const std::string& text) {
    const std::string choice = widget + ": " + text;
    // The click determines whether the widget is a drop-down. It must not be determined later, because a choice may
    // remove the drop-down from the screen.
    const auto is_drop_down = std::make_shared<bool>(false);
    return {[widget](Host& host) -> core::Result<bool> { return move_to(host, widget); },
            [widget, is_drop_down](Host& host) -> core::Result<bool> {
                *is_drop_down = host.choices(widget) != nullptr;
                return click_on(host, widget, !*is_drop_down);
            },
            [choice, is_drop_down](Host& host) -> core::Result<bool> {
                if (*is_drop_down) {
                    return move_to(host, choice);
                }
                press(host, {.key = Key::A, .control = true});
                return true;
            },
            [choice, text, is_drop_down](Host& host) -> core::Result<bool> {
                if (*is_drop_down) {
                    return click_on(host, choice, false);
                }
                send_text(host, text);
                return true;
            },
            [is_drop_down](Host& host) -> core::Result<bool> {
                if (!*is_drop_down) {
                    press(host, {.key = Key::Enter});
                }
                return true;
            }};
}

// ---- conditions ------------------------------------------------------------------------------------------------

const evod::v1::SnapshotFrame* snapshot_of(const Host& host) {
    const ViewedWorld* world = host.world();
    return world != nullptr && world->feed.snapshot() != nullptr ? &world->feed.snapshot()->about : nullptr;
}

constexpr std::pair<std::string_view, evod::v1::RunState> state_names[] = {
    {"waiting", evod::v1::RUN_STATE_WAITING},
    {"running", evod::v1::RUN_STATE_RUNNING},
    {"paused", evod::v1::RUN_STATE_PAUSED},
    {"ended", evod::v1::RUN_STATE_TERMINATED},
};

std::string allowed_states() {
    std::string names;
    for (const auto& [name, state] : state_names) {
        names += (names.empty() ? "" : ", ") + std::string{name};
    }
    return names;
}

struct Condition {
    std::string_view name;
    std::string_view argument; // empty: the condition has no argument
    std::string_view meaning;
    /// Checks an argument. Returns what is allowed if the argument is invalid; otherwise returns an empty text.
    std::string (*fault)(const std::string& word);
    bool (*holds)(const Host& host, const std::string& word);
};

std::string no_fault(const std::string&) {
    return {};
}
std::string number_fault(const std::string& word) {
    return number_in<std::uint64_t>(word) ? "" : "a whole number";
}
std::string state_fault(const std::string& word) {
    const auto* found = std::ranges::find(state_names, word, [](const auto& pair) { return pair.first; });
    return found != std::end(state_names) ? "" : allowed_states();
}

const Condition conditions[] = {
    {"connected", "", "evoview is connected, and the server has answered every request", no_fault,
     [](const Host& host, const std::string&) { return host.world() != nullptr && host.world()->all_answered(); }},
    {"snapshot", "", "a snapshot of the world is shown", no_fault,
     [](const Host& host, const std::string&) { return snapshot_of(host) != nullptr; }},
    {"generation", "N", "this generation or a later one is shown", number_fault,
     [](const Host& host, const std::string& word) {
         return snapshot_of(host) != nullptr && snapshot_of(host)->generation() >= *number_in<std::uint64_t>(word);
     }},
    {"tick", "N", "this tick or a later one is shown", number_fault,
     [](const Host& host, const std::string& word) {
         return snapshot_of(host) != nullptr && snapshot_of(host)->tick() >= *number_in<std::uint64_t>(word);
     }},
    {"state", "STATE", "the world is in this state: waiting, running, paused or ended", state_fault,
     [](const Host& host, const std::string& word) {
         const auto* named = std::ranges::find(state_names, word, [](const auto& pair) { return pair.first; });
         return host.world() != nullptr && host.world()->feed.control().state() == named->second;
     }},
    {"widget", "NAME", "the widget is on the screen", no_fault,
     [](const Host& host, const std::string& word) { return host.find(word).has_value(); }},
    {"gone", "NAME", "the widget is not on the screen", no_fault,
     [](const Host& host, const std::string& word) { return !host.find(word); }},
};

std::string condition_names() {
    std::string names;
    for (const Condition& condition : conditions) {
        names += (names.empty() ? "" : ", ") + std::string{condition.name};
    }
    return names;
}

// ---- verbs -----------------------------------------------------------------------------------------------------

struct ScriptLine {
    std::vector<std::string> words; // the first word is the verb
    double timeout_s;               // time limit for this line and the following ones; a verb may change it
};

/// Returns an error about one word of a line. `number` is the position of the word, from 1.
core::Error word_error(const ScriptLine& line, std::size_t number, const std::string& allowed) {
    return usage("word " + std::to_string(number) + ": got " + in_quotes(line.words[number - 1]) + ", allowed " +
                 allowed);
}

struct Verb {
    std::string_view name;
    std::string_view words; // the arguments of the verb, in capitals
    std::string_view meaning;
    std::size_t words_min, words_max; // number of words after the verb
    core::Result<Acts> (*parse)(ScriptLine& line);
};

const Verb verbs[] = {
    {"key", "NAME",
     "presses a key: A to Z, F1 to F12, Space, Enter, Escape, Tab, …, or a character such as [; also after Ctrl+, "
     "Shift+ or Alt+",
     1, 1,
     [](ScriptLine& line) -> core::Result<Acts> {
         const auto chord = parse_chord(line.words[1]);
         if (!chord) {
             return word_error(line, 2, "a key like A, F4, Space, +, Ctrl+Z");
         }
         return Acts{press_act(*chord)};
     }},
    {"type", "TEXT", "types text into the field that has the keyboard focus", 1, 1,
     [](ScriptLine& line) -> core::Result<Acts> { return Acts{type_act(line.words[1])}; }},
    {"click", "NAME", "clicks on a widget, named by the text on it or beside it", 1, 1,
     [](ScriptLine& line) -> core::Result<Acts> { return click_acts(line.words[1]); }},
    {"set", "NAME TEXT",
     "replaces the value of a field or slider and presses Enter, or chooses an entry of a drop-down", 2, 2,
     [](ScriptLine& line) -> core::Result<Acts> { return set_acts(line.words[1], line.words[2]); }},
    {"wait", "CONDITION", "waits until the condition holds", 1, 2,
     [](ScriptLine& line) -> core::Result<Acts> {
         const auto* condition = std::ranges::find(conditions, line.words[1], &Condition::name);
         if (condition == std::end(conditions)) {
             return word_error(line, 2, condition_names());
         }
         const std::size_t wanted = condition->argument.empty() ? 2 : 3;
         if (line.words.size() < wanted) {
             return usage("word 3 is missing: wait " + line.words[1] + " " + std::string{condition->argument});
         }
         if (line.words.size() > wanted) {
             return word_error(line, wanted + 1, "no more words");
         }
         const std::string word = wanted == 3 ? line.words[2] : "";
         if (const std::string allowed = condition->fault(word); !allowed.empty()) {
             return word_error(line, 3, allowed);
         }
         return Acts{[condition, word](Host& host) -> core::Result<bool> { return condition->holds(host, word); }};
     }},
    {"timeout", "SECONDS", "sets the time limit of each of the following lines; 60 by default", 1, 1,
     [](ScriptLine& line) -> core::Result<Acts> {
         const auto seconds = number_in<double>(line.words[1]);
         if (!seconds || !(*seconds > 0 && *seconds <= timeout_s_max)) {
             return word_error(line, 2, "more than 0, to 86400");
         }
         line.timeout_s = *seconds;
         return Acts{};
     }},
    {"screenshot", "FILE", "saves the window as a PNG file", 1, 1,
     [](ScriptLine& line) -> core::Result<Acts> {
         return Acts{[path = line.words[1]](Host& host) -> core::Result<bool> {
             if (std::string trouble = host.save(path); !trouble.empty()) {
                 return usage(std::move(trouble));
             }
             return true;
         }};
     }},
    {"quit", "", "closes the window", 0, 0,
     [](ScriptLine&) -> core::Result<Acts> {
         return Acts{[](Host& host) -> core::Result<bool> {
             host.close();
             return true;
         }};
     }},
};

std::string verb_names() {
    std::string names;
    for (const Verb& verb : verbs) {
        names += (names.empty() ? "" : ", ") + std::string{verb.name};
    }
    return names;
}

core::Result<Acts> acts_of(ScriptLine& line) {
    const auto* verb = std::ranges::find(verbs, line.words[0], &Verb::name);
    if (verb == std::end(verbs)) {
        return word_error(line, 1, verb_names());
    }
    const std::size_t count = line.words.size() - 1;
    if (count < verb->words_min) {
        return usage("word " + std::to_string(line.words.size() + 1) + " is missing: " + std::string{verb->name} + " " +
                     std::string{verb->words});
    }
    if (count > verb->words_max) {
        return word_error(line, verb->words_max + 2, "no more words (put a word with spaces in quotes)");
    }
    return verb->parse(line);
}

} // namespace

core::Result<Script> Script::parse(std::string_view text) {
    Script script;
    double timeout_s = timeout_s_default;
    unsigned number = 0;
    while (!text.empty()) {
        ++number;
        const std::size_t end = std::min(text.find('\n'), text.size());
        const std::string_view whole = text.substr(0, end);
        text.remove_prefix(std::min(end + 1, text.size()));
        auto words = words_of(whole);
        if (words && words->empty()) {
            continue;
        }
        ScriptLine line{.words = words ? *std::move(words) : std::vector<std::string>{}, .timeout_s = timeout_s};
        auto acts = words ? acts_of(line) : core::Result<Acts>{words.error()};
        if (!acts) {
            return usage(std::to_string(number) + ": " + acts.error().what);
        }
        timeout_s = line.timeout_s;
        for (Act& act : *acts) {
            script.steps_.push_back({.line = number,
                                     .text = std::string{whole},
                                     .drop_down = line.words[0] == "set" ? line.words[1] : "",
                                     .timeout = std::chrono::duration<double>{timeout_s},
                                     .act = std::move(act)});
        }
    }
    return script;
}

core::Result<void> Script::advance(Host& host, Clock::time_point now) {
    if (done()) {
        return {};
    }
    Step& step = steps_.front();
    const auto place = [&] { return std::to_string(step.line) + ": " + step.text + ": "; };
    const auto acted = step.act(host);
    if (!acted) {
        return usage(place() + acted.error().what);
    }
    if (*acted) {
        steps_.pop_front();
        waiting_since_.reset();
        return {};
    }
    if (!waiting_since_) {
        waiting_since_ = now;
    } else if (now - *waiting_since_ > step.timeout) {
        std::string what =
            place() + "not done within " + std::to_string(static_cast<long long>(step.timeout.count())) + " s";
        if (const auto* choices = host.choices(step.drop_down); choices != nullptr && !choices->empty()) {
            what += "; " + in_quotes(step.drop_down) + " offers " + comma_list(*choices);
        }
        return usage(std::move(what));
    }
    return {};
}

std::string Script::reference() {
    std::string text;
    for (const Verb& verb : verbs) {
        text += std::string{verb.name} + (verb.words.empty() ? "" : " ") + std::string{verb.words} + "  " +
                std::string{verb.meaning} + "\n";
    }
    for (const Condition& condition : conditions) {
        text += "wait " + std::string{condition.name} + (condition.argument.empty() ? "" : " ") +
                std::string{condition.argument} + "  " + std::string{condition.meaning} + "\n";
    }
    return text;
}

} // namespace evod::viewer
