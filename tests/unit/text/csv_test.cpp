#include "proto/text/csv.h"

#include <gtest/gtest.h>

#include <sstream>

namespace evod::text {
namespace {

using Rows = std::vector<std::vector<std::string>>;

/// The rows of a table, and the numbers of their lines.
std::pair<Rows, std::vector<std::uint64_t>> read(const std::string& text, bool has_open_quote = false) {
    std::istringstream in{text};
    CsvReader reader{in};
    Rows rows;
    std::vector<std::uint64_t> lines;
    while (reader.next()) {
        rows.emplace_back(reader.cells().begin(), reader.cells().end());
        lines.push_back(reader.line());
    }
    EXPECT_EQ(reader.has_open_quote(), has_open_quote) << text;
    return {rows, lines};
}

TEST(Csv, CellsAreQuotedOnlyIfTheyMustBe) {
    EXPECT_EQ(csv_cell("plain text"), "plain text");
    EXPECT_EQ(csv_cell(""), "");
    EXPECT_EQ(csv_cell("a,b"), "\"a,b\"");
    EXPECT_EQ(csv_cell("say \"hi\""), "\"say \"\"hi\"\"\"");
    EXPECT_EQ(csv_cell("two\nlines"), "\"two\nlines\"");
}

TEST(Csv, RowsAndLinesAreCounted) {
    EXPECT_EQ(read("").first, Rows{});
    EXPECT_EQ(read("a,b\n1,2\n").first, (Rows{{"a", "b"}, {"1", "2"}}));
    EXPECT_EQ(read("\xef\xbb\xbf"
                   "a,\r\n\r\n,b")
                  .first,
              (Rows{{"a", ""}, {""}, {"", "b"}}));
    EXPECT_EQ(read("a\n\"b\nc\",d\ne\n").second, (std::vector<std::uint64_t>{1, 2, 4}));
}

TEST(Csv, QuotationMarksAreRemoved) {
    EXPECT_EQ(read("\"a\",\"b,c\",\"\"\"d\"\"\",\"\"\n").first, (Rows{{"a", "b,c", "\"d\"", ""}}));
    EXPECT_EQ(read("\"a\nb\"\"\r\nc\",d\n").first, (Rows{{"a\nb\"\nc", "d"}}));
    EXPECT_EQ(read("a\"b,c\n").first, (Rows{{"a\"b", "c"}})); // only a mark at the beginning quotes
}

TEST(Csv, AnOpenQuoteEndsTheTable) {
    EXPECT_EQ(read("a\n\"b,c\nd\n", true).first, (Rows{{"a"}}));
}

TEST(Csv, WrittenCellsAreReadBack) {
    const std::vector<std::string> cells{"", "a", "\"", "\"\"", ",", "\n", "a\"b,c\nd", " x "};
    std::string line;
    for (const std::string& cell : cells) {
        line += (line.empty() ? "x," : ",") + csv_cell(cell);
    }
    const Rows rows = read(line + "\n").first;
    ASSERT_EQ(rows.size(), 1u);
    EXPECT_EQ((std::vector<std::string>{rows[0].begin() + 1, rows[0].end()}), cells);
}

} // namespace
} // namespace evod::text
