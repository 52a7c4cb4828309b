#include "client/viewer/shell/script.h"

#include "client/viewer/panels/page_panels.h"
#include "client/viewer/shell/script_acts.h"
#include "client/viewer/world/viewed_world.h"

#include <algorithm>
#include <cctype>
#include <iterator>
#include <utility>

namespace evod::viewer {

namespace {

using acts::Acts, acts::in_quotes, acts::number_in, acts::usage, acts::Waits;
using Host = Script::Host;
using Run = Script::Run;

constexpr double timeout_s_default = 60, timeout_s_max = 86'400;

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

bool is_visible(const Host& host, const std::string& widget) {
    return std::ranges::any_of(host.find(widget), &MarkedWidget::visible);
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
     [](const Host& host, const std::string& word) { return is_visible(host, word); }},
    {"gone", "NAME", "the widget is not on the screen", no_fault,
     [](const Host& host, const std::string& word) { return !is_visible(host, word); }},
    {"disabled", "NAME", "the widget is on the screen and disabled", no_fault,
     [](const Host& host, const std::string& word) {
         return std::ranges::any_of(host.find(word), [](const MarkedWidget* widget) { return !widget->enabled; });
     }},
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

core::Result<Acts> parse_click(ScriptLine& line) {
    if (line.words.size() == 2) {
        return acts::click(line.words[1]);
    }
    if (line.words[1].starts_with("left/") || line.words[1].starts_with("right/")) {
        return usage("word 2: two worlds side by side are in the browser page: " + way_to_page(""));
    }
    const auto place = acts::island_place(line.words[1], line.words[2]);
    if (!place) {
        return word_error(line, 3, "no more words (put a word with spaces in quotes)");
    }
    if (!*place) {
        return word_error(line, 3, place->error().what);
    }
    return acts::click(**place);
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
         if (auto acts = acts::press(line.words[1])) {
             return *std::move(acts);
         }
         return word_error(line, 2, "a key like A, F4, Space, +, Ctrl+Z");
     }},
    {"type", "TEXT", "types text into the field that has the keyboard focus", 1, 1,
     [](ScriptLine& line) -> core::Result<Acts> { return acts::type(line.words[1]); }},
    {"click", "NAME",
     "clicks on a widget, named by the text on it or next to it; or on the island: organism NUMBER, or at X,Y with "
     "fractions of its width and height",
     1, 2, parse_click},
    {"menu", "NAME", "clicks on a widget with the right button, which opens its menu", 1, 1,
     [](ScriptLine& line) -> core::Result<Acts> { return acts::click(line.words[1], sf::Mouse::Right); }},
    {"set", "NAME TEXT",
     "replaces the value of a field or slider and presses Enter, chooses an entry of a drop-down, or switches a check "
     "box on or off",
     2, 2, [](ScriptLine& line) -> core::Result<Acts> { return acts::set(line.words[1], line.words[2]); }},
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
         return Acts{[condition, word](Run& run) -> Waits {
             if (condition->fault == no_fault && !word.empty() && run.host.find(word).empty()) {
                 if (std::string absence = run.host.absence(word); !absence.empty()) {
                     return usage(std::move(absence));
                 }
             }
             return condition->holds(run.host, word) ? "" : "the condition does not hold";
         }};
     }},
    {"actions", "N",
     "fails if more than N clicks, keys, typed texts and turns of the wheel were needed since the last line of this "
     "kind",
     1, 1,
     [](ScriptLine& line) -> core::Result<Acts> {
         const auto most = number_in<unsigned>(line.words[1]);
         if (!most) {
             return word_error(line, 2, "a whole number");
         }
         return Acts{[most = *most](Run& run) -> Waits {
             const unsigned needed = std::exchange(run.actions, 0);
             if (needed > most) {
                 return usage(std::to_string(needed) + " actions were needed");
             }
             return "";
         }};
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
         return Acts{[path = line.words[1]](Run& run) -> Waits {
             if (std::string trouble = run.host.save(path); !trouble.empty()) {
                 return usage(std::move(trouble));
             }
             return "";
         }};
     }},
    {"quit", "", "closes the window", 0, 0,
     [](ScriptLine&) -> core::Result<Acts> {
         return Acts{[](Run& run) -> Waits {
             run.host.close();
             return "";
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
    if (line.words[0] == "drag") {
        return usage("drag places organisms, which the browser page does: " + where_in_page("Freezer", ""));
    }
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
    Run run{host, actions_, scrolled_};
    const auto waits = step.act(run);
    if (!waits) {
        return usage(place() + waits.error().what);
    }
    if (waits->empty()) {
        steps_.pop_front();
        waiting_since_.reset();
        scrolled_ = false;
        return {};
    }
    if (!waiting_since_) {
        waiting_since_ = now;
    } else if (now - *waiting_since_ > step.timeout) {
        return usage(place() + "not done within " + std::to_string(static_cast<long long>(step.timeout.count())) +
                     " s: " + *waits);
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
