#include "client/viewer/text/lines.h"

#include <algorithm>
#include <cstddef>

namespace evod::viewer {

namespace {

/// Returns the offset after the UTF-8 character that begins at `at`.
std::size_t end_of_character(std::string_view text, std::size_t at) {
    for (++at; at < text.size() && (static_cast<unsigned char>(text[at]) & 0xc0) == 0x80; ++at) {
    }
    return at;
}

} // namespace

std::string in_lines(std::string_view text, float width_max, const std::function<float(std::string_view)>& width_of) {
    std::string lines;
    std::size_t line_begin = 0; // offset in `lines`
    const auto begin_line = [&] {
        lines += '\n';
        line_begin = lines.size();
    };
    const auto fits = [&](std::string_view more) {
        return width_of(lines.substr(line_begin).append(more)) <= width_max;
    };
    for (std::size_t at = 0; at < text.size();) {
        const std::size_t end = std::min(text.find_first_of(" \n", at), text.size());
        std::string_view word = text.substr(at, end - at);
        const bool first = line_begin == lines.size();
        if (!first && fits(std::string{" "}.append(word))) {
            lines.append(" ").append(word);
        } else {
            if (!first) {
                begin_line();
            }
            while (!word.empty() && !fits(word)) {
                std::size_t part = end_of_character(word, 0);
                while (part < word.size() && fits(word.substr(0, end_of_character(word, part)))) {
                    part = end_of_character(word, part);
                }
                lines.append(word.substr(0, part));
                word.remove_prefix(part);
                if (!word.empty()) {
                    begin_line();
                }
            }
            lines.append(word);
        }
        if (end < text.size() && text[end] == '\n') {
            begin_line();
        }
        at = end + 1;
    }
    return lines;
}

} // namespace evod::viewer
