// Words: joins names, and breaks lines.
#pragma once

#include <cstddef>
#include <string>

namespace evod::command_line {

/// Joins names: "bash, zsh, fish".
std::string joined(const auto& names, const char* separator = ", ") {
    std::string text;
    for (const auto& name : names) {
        text += text.empty() ? "" : separator;
        text += name;
    }
    return text;
}

/// Replaces blanks by line breaks so that lines have at most `width` bytes, unless a word is longer.
std::string wrapped(const std::string& text, std::size_t width);

} // namespace evod::command_line
