// Text: formats tables, sparklines and numbers for the user.
#pragma once

#include "client/core/duration.h"
#include "proto/command_line/terminal.h"
#include "proto/text/number_text.h"

#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace evod::ctl {

/// A table of text. Each column is as wide as its widest cell.
class Table {
  public:
    enum class Align { Left, Right };
    struct Column {
        std::string title;
        Align align = Align::Left;
    };

    explicit Table(std::vector<Column> columns) : columns_{std::move(columns)} {}

    void add(std::vector<std::string> cells); // adds a row; one cell for each column
    /// Returns the title and the rows, one line each. Columns are separated by two blanks; no line ends in a blank.
    std::string to_text() const;

  private:
    std::vector<Column> columns_;
    std::vector<std::vector<std::string>> rows_;
};

/// Draws the last `width_max` values as a row of bars with eight heights. Empty if there are no values. If all values
/// are equal, the bars have middle height.
std::string sparkline(std::span<const double> values, std::size_t width_max);

/// Draws a bar that fills `share`, 0 to 1, of `width` characters; the rest is blank.
std::string bar(double share, std::size_t width);

using command_line::Color;
/// Colours a text for standard output. Without use_colors(), returns the text as it is.
std::string in_color(const std::string& text, Color color);
/// Whether in_color() adds escape sequences from now on. It does not at first.
void use_colors(bool used);

/// Makes text from a server safe to print on a terminal: replaces characters that control it or change the direction of
/// text by '?', except line breaks. Keeps the sequences of in_color().
std::string visible(std::string utf8);

using core::duration;
using text::fitness_text;
using text::fixed;
using text::number_text;
/// Formats a short duration: "12 µs", "3.4 ms", "1.2 s".
std::string short_time(double seconds);
/// Formats a number of bytes: "512 B", "1.5 KiB", "12 MiB".
std::string short_bytes(double bytes);
/// Returns the number of characters (code points) in a text, without those that in_color() adds.
std::size_t width_of(std::string_view utf8);

/// Cuts each line after `width` characters, so that no line wraps on a terminal of this width.
std::string clip_lines(std::string_view utf8, std::size_t width);

/// Returns the beginning of `utf8`, as much as a terminal of this width and height shows without scrolling. Cuts lines
/// as clip_lines() does. The last line has no line break, so that the cursor stays at its end.
std::string clip_page(std::string_view utf8, std::size_t width, std::size_t lines);

/// Returns a factor of real time as the page and evoview show it: "2×", "1/8×".
std::string speed_text(double factor);

} // namespace evod::ctl
