// Script acts: the keys, clicks and texts that the lines of a script send to the window, and the checks that they had
// an effect.
//
// A line is divided into acts. At least one frame is drawn after each act, so that the next act sees its effect.
//
// Owner        Script.
// Threads      none.
#pragma once

#include "client/viewer/shell/script.h"

#include <charconv>
#include <optional>
#include <string>
#include <string_view>
#include <system_error>
#include <vector>

namespace evod::viewer::acts {

using Acts = std::vector<Script::Act>;
using Waits = core::Result<std::string>; // what an act waits for; empty: the act is done

inline core::Error usage(std::string what) {
    return {.kind = core::Error::Kind::Usage, .what = std::move(what)};
}

inline std::string in_quotes(std::string_view text) {
    return "\"" + std::string{text} + "\"";
}

template <class Number>
std::optional<Number> number_in(const std::string& word) {
    Number number{};
    const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), number);
    return error == std::errc{} && end == word.data() + word.size() ? std::optional{number} : std::nullopt;
}

/// Presses a key such as "F4", "Ctrl+A" or "+". Returns nullopt if there is no such key.
std::optional<Acts> press(std::string_view key);

/// Types text into the field that has the keyboard focus.
Acts type(const std::string& text);

/// Clicks on a widget as soon as it is visible and enabled.
Acts click(const std::string& widget, sf::Mouse::Button button = sf::Mouse::Left);

/// Clicks on a place of an island. If the place is an organism, the click must select it.
Acts click(const Script::IslandPlace& place);

/// Parses a place such as "organism 12" or "at 0.4,0.6". Returns nullopt if `kind` does not begin a place; returns
/// an error with what is allowed if `word` is wrong.
std::optional<core::Result<Script::IslandPlace>> island_place(std::string_view kind, const std::string& word);

/// Replaces the text of a field, chooses an entry of a drop-down, or switches a check box on or off. The widget must
/// then have this value.
Acts set(const std::string& widget, const std::string& text);

} // namespace evod::viewer::acts
