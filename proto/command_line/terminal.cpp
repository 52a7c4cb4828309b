#include "proto/command_line/terminal.h"

#include <unistd.h>

#include <algorithm>
#include <cstdlib>
#include <iostream>

namespace evod::command_line {

bool may_color(int descriptor) {
    const char* const no_color = std::getenv("NO_COLOR");
    return (no_color == nullptr || *no_color == '\0') && ::isatty(descriptor) == 1;
}

std::string colored(std::string_view text, Color color) {
    const char* const begin = color == Color::Red ? "\033[31m" : color == Color::Green ? "\033[32m" : "\033[33m";
    return begin + std::string{text} + "\033[0m";
}

void print_error(std::string_view program, std::string_view text) {
    const std::string name = std::string{program} + ":";
    const std::string prefix = may_color(STDERR_FILENO) ? colored(name, Color::Red) : name;
    for (std::size_t begin = 0; begin <= text.size();) {
        const std::size_t end = std::min(text.find('\n', begin), text.size());
        const std::string_view line = text.substr(begin, end - begin);
        // One call, so that lines of several processes do not mix.
        std::cerr << (line.starts_with(' ') ? "" : prefix + " ") + std::string{line} + '\n';
        begin = end + 1;
    }
}

} // namespace evod::command_line
