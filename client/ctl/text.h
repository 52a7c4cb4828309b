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

/// Rows of cells in columns as wide as they need to be.
class Table {
  public:
    enum class Align { Left, Right };
    struct Column {
        std::string title;
        Align align = Align::Left;
    };

    explicit Table(std::vector<Column> columns) : columns_{std::move(columns)} {}

    void add(std::vector<std::string> cells); // as many as there are columns
    /// Title and rows, a line each; columns are two blanks apart and no line ends in a blank.
    std::string to_text() const;

  private:
    std::vector<Column> columns_;
    std::vector<std::vector<std::string>> rows_;
};

/// One of eight bars per value, lowest to highest; the newest `width_max` values. Empty for none. Values that are all
/// equal are bars of middle height.
std::string sparkline(std::span<const double> values, std::size_t width_max);

/// What a server says, for a terminal: control characters but the end of a line become '?'.
std::string visible(std::string utf8);

using core::exact;
/// With so many decimals.
std::string fixed(double value, int decimals);
using core::duration;
/// "12 µs", "3.4 ms", "1.2 s".
std::string short_time(double seconds);
/// "512 B", "1.5 KiB", "12 MiB".
std::string short_bytes(double bytes);
/// Characters (code points), not bytes.
std::size_t width_of(std::string_view utf8);

/// Each line cut after `width` characters, so that none takes two lines of a terminal.
std::string clip_lines(std::string_view utf8, std::size_t width);

/// As much of the beginning of `utf8` as a screen of so many characters and lines holds without rolling: its lines cut
/// as above, and the last that fits without its end, behind which the cursor stays.
std::string clip_page(std::string_view utf8, std::size_t width, std::size_t lines);

/// How many insertions, deletions, replacements and swaps of neighbours turn one into the other.
std::size_t edit_distance(std::string_view a, std::string_view b);
/// Those of `names` that someone may have meant by `word`, likeliest first, at most three.
std::vector<std::string> nearest(std::string_view word, std::span<const std::string> names);
/// "; did you mean A or B?", or nothing.
std::string did_you_mean(std::string_view word, std::span<const std::string> names);

} // namespace evod::ctl
