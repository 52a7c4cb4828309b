#include "client/ctl/text.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <numeric>
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
    return static_cast<std::size_t>(
        std::ranges::count_if(utf8, [](char c) { return (static_cast<unsigned char>(c) & 0xc0) != 0x80; }));
}

std::string visible(std::string utf8) {
    for (std::size_t i = 0; i < utf8.size(); ++i) {
        const auto byte = static_cast<unsigned char>(utf8[i]);
        const bool second_of_control = // second byte of a control character from U+0080 to U+009F
            i > 0 && static_cast<unsigned char>(utf8[i - 1]) == 0xc2 && byte >= 0x80 && byte < 0xa0;
        if ((byte < 0x20 && byte != '\n') || byte == 0x7f) {
            utf8[i] = '?';
        } else if (second_of_control) {
            utf8.replace(i - 1, 2, "?");
            --i;
        }
    }
    return utf8;
}

std::string clip_lines(std::string_view utf8, std::size_t width) {
    std::string text;
    std::size_t column = 0;
    for (const char c : utf8) {
        const bool begins = (static_cast<unsigned char>(c) & 0xc0) != 0x80;
        column = c == '\n' ? 0 : column + (begins ? 1 : 0);
        if (column <= width) {
            text += c;
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

std::size_t edit_distance(std::string_view a, std::string_view b) {
    // Optimal string alignment distance: Damerau's distance, with the restriction that each substring is edited at most
    // once. Stores only three rows of the table.
    std::vector<std::size_t> before(b.size() + 1), above(b.size() + 1), row(b.size() + 1);
    std::iota(above.begin(), above.end(), std::size_t{0});
    for (std::size_t i = 1; i <= a.size(); ++i) {
        row[0] = i;
        for (std::size_t j = 1; j <= b.size(); ++j) {
            const std::size_t replaced = above[j - 1] + (a[i - 1] == b[j - 1] ? 0 : 1);
            row[j] = std::min({above[j] + 1, row[j - 1] + 1, replaced});
            if (i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1]) {
                row[j] = std::min(row[j], before[j - 2] + 1);
            }
        }
        std::swap(before, above);
        std::swap(above, row);
    }
    return above[b.size()];
}

std::vector<std::string> nearest(std::string_view word, std::span<const std::string> names) {
    std::vector<std::pair<std::size_t, std::string>> ranked;
    for (const std::string& name : names) {
        const std::size_t distance = edit_distance(word, name);
        // A word that is part of a name counts as similar: "mutation" to "mutation_chance".
        const bool part = word.size() >= 3 && name.find(word) != std::string::npos;
        if (distance <= std::max<std::size_t>(2, word.size() / 3) || part) {
            ranked.emplace_back(distance, name);
        }
    }
    std::ranges::sort(ranked);
    std::vector<std::string> result;
    for (std::size_t i = 0; i < std::min<std::size_t>(3, ranked.size()); ++i) {
        result.push_back(std::move(ranked[i].second));
    }
    return result;
}

std::string did_you_mean(std::string_view word, std::span<const std::string> names) {
    const auto candidates = nearest(word, names);
    std::string text;
    for (std::size_t i = 0; i < candidates.size(); ++i) {
        text += (i == 0 ? "; did you mean " : i + 1 == candidates.size() ? " or " : ", ") + candidates[i];
    }
    return text.empty() ? text : text + "?";
}

} // namespace evod::ctl
