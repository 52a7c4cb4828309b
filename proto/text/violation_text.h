// The text about a wrong field of a request, as the server and evoctl print it. Standard library only, because every
// folder may include this one.
//
// Threads      any; no state.
#pragma once

#include <string>
#include <string_view>

namespace evod::text {

/// What a violation contains as its value if the field itself does not exist.
inline constexpr const char* unknown_name = "an unknown name";

/// Returns "got 2, allowed 0 to 1". For an unknown name, returns the suggestion at the end of `allowed`, if there is
/// one: "unknown name; did you mean selection?".
inline std::string violation_text(std::string_view got, std::string_view allowed) {
    if (got != unknown_name) {
        return "got " + std::string{got} + ", allowed " + std::string{allowed};
    }
    const std::size_t suggestion = allowed.find("; did you mean");
    return "unknown name" + (suggestion == std::string_view::npos ? ", allowed " + std::string{allowed}
                                                                  : std::string{allowed.substr(suggestion)} + "?");
}

} // namespace evod::text
