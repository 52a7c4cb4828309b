#include "client/ctl/text.h"

#include "proto/text/printable.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <utility>

namespace evod::ctl {

void Table::add(std::vector<std::string> cells) {
    cells.resize(columns_.size());
    rows_.push_back(std::move(cells));
}

std::string Table::to_text() const {
    std::vector<std::size_t> widths;
    for (std::size_t c = 0; c < columns_.size(); ++c) {
        std::size_t width = width_of(columns_[c].title);
        for (const auto& row : rows_) {
            width = std::max(width, width_of(row[c]));
        }
        widths.push_back(width);
    }
    std::string text;
    const auto add_line = [&](const auto& cell) {
        std::string line;
        for (std::size_t c = 0; c < columns_.size(); ++c) {
            const std::string& content = cell(c);
            const std::string blanks(widths[c] - width_of(content), ' ');
            line += (c == 0 ? "" : "  ");
            line += columns_[c].align == Align::Right ? blanks + content : content + blanks;
        }
        line.erase(line.find_last_not_of(' ') + 1);
        text += line + '\n';
    };
    add_line([&](std::size_t c) -> const std::string& { return columns_[c].title; });
    for (const auto& row : rows_) {
        add_line([&](std::size_t c) -> const std::string& { return row[c]; });
    }
    return text;
}

std::string sparkline(std::span<const double> values, std::size_t width_max) {
    static constexpr std::array bars{"▁", "▂", "▃", "▄", "▅", "▆", "▇", "█"};
    if (values.size() > width_max) {
        values = values.last(width_max);
    }
    std::string line;
    if (values.empty()) {
        return line;
    }
    const auto [least, most] = std::ranges::minmax_element(values);
    const double range = *most - *least;
    for (const double value : values) {
        const double height = range > 0 && std::isfinite(range) ? (value - *least) / range : 0.5;
        line += bars[static_cast<std::size_t>(std::clamp(height * 8, 0.0, 7.0))];
    }
    return line;
}

std::string bar(double share, std::size_t width) {
    static constexpr std::array parts{"", "▏", "▎", "▍", "▌", "▋", "▊", "▉"}; // eighths of a character
    const auto eighths =
        static_cast<std::size_t>(std::lround(std::clamp(share, 0.0, 1.0) * 8 * static_cast<double>(width)));
    std::string text;
    for (std::size_t i = 0; i < eighths / 8; ++i) {
        text += "█";
    }
    text += parts[eighths % 8];
    return text + std::string(width - width_of(text), ' ');
}

namespace {

bool colors_used = false;

/// Returns the length of an escape sequence that in_color() adds at the start of `text`; 0 if there is none.
std::size_t color_bytes(std::string_view text) {
    if (!colors_used || !text.starts_with("\033[")) {
        return 0;
    }
    const std::size_t end = text.find_first_not_of("0123456789", 2);
    return end != std::string_view::npos && text[end] == 'm' ? end + 1 : 0;
}

} // namespace

std::string in_color(const std::string& text, Color color) {
    return colors_used && !text.empty() ? command_line::colored(text, color) : text;
}

void use_colors(bool used) {
    colors_used = used;
}

std::string short_time(double seconds) {
    const auto with_unit = [](double value, const char* unit) { return fixed(value, value < 9.95 ? 1 : 0) + unit; };
    return seconds < 0.9995e-3 ? with_unit(seconds * 1e6, " µs")
           : seconds < 0.9995  ? with_unit(seconds * 1e3, " ms")
                               : with_unit(seconds, " s");
}

std::string short_bytes(double bytes) {
    if (bytes < 1023.5) {
        return fixed(bytes, 0) + " B";
    }
    for (const char* unit : {" KiB", " MiB", " GiB"}) {
        bytes /= 1024;
        if (bytes < 1023.5) {
            return fixed(bytes, bytes < 9.95 ? 1 : 0) + unit;
        }
    }
    return fixed(bytes / 1024, 1) + " TiB";
}

std::size_t width_of(std::string_view utf8) {
    std::size_t width = 0;
    for (std::size_t i = 0; i < utf8.size(); ++i) {
        if (const std::size_t color = color_bytes(utf8.substr(i)); color > 0) {
            i += color - 1;
        } else {
            width += (static_cast<unsigned char>(utf8[i]) & 0xc0) != 0x80 ? 1 : 0;
        }
    }
    return width;
}

std::string visible(std::string utf8) {
    for (std::size_t i = 0; i < utf8.size(); ++i) {
        if (const std::size_t color = color_bytes(std::string_view{utf8}.substr(i)); color > 0) {
            i += color - 1;
            continue;
        }
        const std::size_t bytes = text::unsafe_character_bytes(std::string_view{utf8}.substr(i));
        if (bytes > 0 && utf8[i] != '\n') {
            utf8.replace(i, bytes, "?");
        }
    }
    return utf8;
}

std::string clip_lines(std::string_view utf8, std::size_t width) {
    std::string text;
    std::size_t column = 0;
    for (std::size_t i = 0; i < utf8.size(); ++i) {
        if (const std::size_t color = color_bytes(utf8.substr(i)); color > 0) {
            text += utf8.substr(i, color); // a colour that begins before the edge may end after it
            i += color - 1;
            continue;
        }
        const bool begins = (static_cast<unsigned char>(utf8[i]) & 0xc0) != 0x80;
        column = utf8[i] == '\n' ? 0 : column + (begins ? 1 : 0);
        if (column <= width) {
            text += utf8[i];
        }
    }
    return text;
}

std::string clip_page(std::string_view utf8, std::size_t width, std::size_t lines) {
    std::size_t end = 0; // end of the text that fits, without its last line break
    for (std::size_t line = 0; line < std::max<std::size_t>(lines, 1); ++line) {
        const std::size_t line_end = utf8.find('\n', line == 0 ? 0 : end + 1);
        if (line_end == std::string_view::npos) {
            return clip_lines(utf8, width); // the whole text fits, with one line left for the cursor
        }
        end = line_end;
    }
    return clip_lines(utf8.substr(0, end), width);
}

std::string speed_text(double factor) {
    const double inverse = factor > 0 ? 1 / factor : 0;
    const bool is_fraction = factor < 1 && inverse > 0 && inverse == std::floor(inverse);
    return (is_fraction ? "1/" + fixed(inverse, 0) : number_text(factor, text::Exponent::IfLong)) + "×";
}

} // namespace evod::ctl
