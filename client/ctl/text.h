// Text: tables, sparklines and numbers for people to read.
#pragma once

#include "client/core/duration.h"
#include "client/core/exact.h"

#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace evod::ctl {

/// A table of text whose columns are as wide as their cells.
class Table {
  public:
    enum class Align { Left, Right };
    struct Column {
        std::string title;
        Align align = Align::Left;
    };

    explicit Table(std::vector<Column> columns) : columns_{std::move(columns)} {}

    void add(std::vector<std::string> cells); // as many as there are columns
    /// Returns the title and the rows, one line each. Columns are separated by two blanks; no line ends in a blank.
    std::string to_text() const;

  private:
    std::vector<Column> columns_;
    std::vector<std::vector<std::string>> rows_;
};

/// One of eight bars per value, for the newest `width_max` values; empty for no values. If all values are equal, the bars
/// have middle height.
std::string sparkline(std::span<const double> values, std::size_t width_max);

/// Makes text from a server safe for a terminal: control characters except line breaks become '?'.
std::string visible(std::string utf8);

using core::exact;
/// Formats with a fixed number of decimals.
std::string fixed(double value, int decimals);
using core::duration;
/// "12 µs", "3.4 ms", "1.2 s".
std::string short_time(double seconds);
/// "512 B", "1.5 KiB", "12 MiB".
std::string short_bytes(double bytes);
/// Characters (code points), not bytes.
std::size_t width_of(std::string_view utf8);

/// Cuts each line after `width` characters, so that no line wraps on a terminal.
std::string clip_lines(std::string_view utf8, std::size_t width);

/// Returns the beginning of `utf8` that a screen of this width and height shows without scrolling. Lines are cut as above; the
/// last line has no line break, so that the cursor stays behind it.
std::string clip_page(std::string_view utf8, std::size_t width, std::size_t lines);

/// The number of insertions, deletions, replacements and swaps of neighbours that turn `a` into `b`.
std::size_t edit_distance(std::string_view a, std::string_view b);
/// The names that `word` may be a misspelling of, nearest first, at most three.
std::vector<std::string> nearest(std::string_view word, std::span<const std::string> names);
/// "; did you mean A or B?", or nothing.
std::string did_you_mean(std::string_view word, std::span<const std::string> names);

} // namespace evod::ctl
