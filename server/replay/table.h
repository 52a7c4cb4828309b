// Table: writes rows for other programs, either as CSV with a heading or as JSON Lines with one object per row. The CSV
// follows RFC 4180, but its lines end with "\n".
#pragma once

#include <charconv>
#include <cmath>
#include <ostream>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

namespace evod::replay {

class Table {
  public:
    enum class Format { Csv, JsonLines };

    /// Writes the heading of a CSV table.
    Table(std::ostream& out, Format format, std::vector<std::string> columns);

    // To write a row, call one of these functions for each column, in order, then end_row().

    /// Writes the shortest text that reads back as the same number.
    template <class T>
    requires std::is_arithmetic_v<T> Table& number(T value) {
        if constexpr (std::is_floating_point_v<T>) {
            if (format_ == Format::JsonLines && !std::isfinite(value)) {
                return nothing(); // JSON has no text for this number
            }
        }
        char digits[32];
        begin_field();
        line_.append(digits, std::to_chars(digits, digits + sizeof digits, value).ptr);
        return *this;
    }
    Table& text(std::string_view value);
    /// value  JSON text on one line.
    Table& json(std::string_view value);
    /// Writes an unknown value: an empty field in CSV, null in JSON.
    Table& nothing();
    void end_row();
    /// Whether further rows can be written.
    bool can_write() const { return out_.good(); }

  private:
    void begin_field();

    std::ostream& out_;
    const Format format_;
    std::vector<std::string> columns_; // in JSON format, each name is quoted and followed by a colon
    std::string line_;
    std::size_t column_ = 0;
};

} // namespace evod::replay
