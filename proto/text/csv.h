// CSV: tables as text, by RFC 4180. The only reader and the only writer of cells in C++.
//
// A cell may stand in quotation marks; two of them inside are one. Lines may end with LF or CRLF. A byte order mark at
// the beginning, which spreadsheet programs write, is skipped.
//
// Threads      none.
#pragma once

#include <cstddef>
#include <cstdint>
#include <istream>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace evod::text {

/// Returns the text as a cell: in quotation marks if it contains one, a comma, CR or LF.
inline std::string csv_cell(std::string_view text) {
    if (text.find_first_of("\",\r\n") == std::string_view::npos) {
        return std::string{text};
    }
    std::string quoted = "\"";
    for (const char c : text) {
        quoted.append(c == '"' ? 2 : 1, c);
    }
    return quoted + '"';
}

/// What separates the cells of a row.
enum class Separator {
    Comma,
    FromHeading, // semicolon or tab if the first row contains one and no comma; else comma
};

/// Reads a table row by row.
class CsvReader {
  public:
    /// in  must outlive the reader.
    explicit CsvReader(std::istream& in, Separator separator = Separator::Comma) : in_{in}, wanted_{separator} {}

    /// Reads the next row. Returns false at the end of the table, and if the last cell has no closing quotation mark.
    bool next() {
        cells_.clear();
        line_ += lines_in_row_;
        lines_in_row_ = 0;
        row_.clear();
        if (!append_line()) {
            return false;
        }
        if (line_ == 1 && row_.starts_with("\xef\xbb\xbf")) {
            row_.erase(0, 3);
        }
        if (line_ == 1 && wanted_ == Separator::FromHeading) {
            const auto contains = [&](char c) { return row_.find(c) != std::string::npos; };
            separator_ = contains(',') ? ',' : contains(';') ? ';' : contains('\t') ? '\t' : ',';
        }
        return row_.find('"') == std::string::npos ? split_plain() : split_quoted();
    }

    /// The cells of the row, valid until the next call of next(). An empty line is one empty cell.
    std::span<const std::string_view> cells() const { return cells_; }
    /// The character that separates cells.
    char separator() const { return separator_; }
    /// The number of the row's first line, from 1.
    std::uint64_t line() const { return line_; }
    /// Whether next() returned false because a quotation mark is not closed.
    bool has_open_quote() const { return has_open_quote_; }

  private:
    bool append_line() {
        std::string line;
        if (!std::getline(in_, line)) {
            return false;
        }
        ++lines_in_row_;
        if (line.ends_with('\r')) {
            line.pop_back();
        }
        row_ += line;
        return true;
    }

    bool split_plain() {
        for (std::size_t begin = 0, end = 0; end != std::string::npos; begin = end + 1) {
            end = row_.find(separator_, begin);
            cells_.push_back(std::string_view{row_}.substr(begin, end == std::string::npos ? end : end - begin));
        }
        return true;
    }

    /// Removes the quotation marks in place: what is kept is never longer than what was read.
    bool split_quoted() {
        std::vector<std::pair<std::size_t, std::size_t>> places; // begin, size
        std::size_t kept = 0, begin = 0;
        bool quoted = false;
        for (std::size_t i = 0;; ++i) {
            if (i == row_.size() && quoted) {
                row_ += '\n';
                if (!append_line()) {
                    has_open_quote_ = true;
                    return false;
                }
            }
            if (i == row_.size() || (row_[i] == separator_ && !quoted)) {
                places.emplace_back(begin, kept - begin);
                begin = kept;
                if (i == row_.size()) {
                    break;
                }
            } else if (row_[i] == '"' && quoted && i + 1 < row_.size() && row_[i + 1] == '"') {
                row_[kept++] = row_[i++];
            } else if (row_[i] == '"' && (quoted || kept == begin)) {
                quoted = !quoted;
            } else {
                row_[kept++] = row_[i];
            }
        }
        for (const auto& [at, size] : places) {
            cells_.push_back(std::string_view{row_}.substr(at, size));
        }
        return true;
    }

    std::istream& in_;
    Separator wanted_;
    char separator_ = ',';
    std::string row_;
    std::vector<std::string_view> cells_;
    std::uint64_t line_ = 1, lines_in_row_ = 0;
    bool has_open_quote_ = false;
};

} // namespace evod::text
