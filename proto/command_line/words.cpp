#include "proto/command_line/words.h"

#include <algorithm>

namespace evod::command_line {

std::string wrapped(const std::string& text, std::size_t width) {
    std::string result;
    std::size_t column = 0;
    for (std::size_t begin = 0; begin < text.size();) {
        const std::size_t end = std::min(text.find_first_of(" \n", begin), text.size());
        if (begin == end && end < text.size() && text[end] == ' ') {
            ++begin; // a second blank
            continue;
        }
        if (column > 0 && column + 1 + (end - begin) > width) {
            result += '\n';
            column = 0;
        }
        result += (column > 0 ? " " : "") + text.substr(begin, end - begin);
        column += (column > 0 ? 1 : 0) + (end - begin);
        if (end < text.size() && text[end] == '\n') {
            result += '\n';
            column = 0;
        }
        begin = end + 1;
    }
    return result;
}

} // namespace evod::command_line
