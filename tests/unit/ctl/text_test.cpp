#include "client/ctl/text.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

namespace evod::ctl {
namespace {

TEST(Sparkline, GoesFromTheLowestToTheHighestBar) {
    EXPECT_EQ(sparkline(std::vector<double>{0, 1, 2, 3, 4, 5, 6, 7}, 10), "▁▂▃▄▅▆▇█");
    EXPECT_EQ(sparkline(std::vector<double>{-5, 5}, 10), "▁█");
}

TEST(Sparkline, KeepsTheNewest) {
    EXPECT_EQ(sparkline(std::vector<double>{100, 0, 1}, 2), "▁█");
}

TEST(Sparkline, HandlesNoValuesAndEqualValues) {
    EXPECT_EQ(sparkline({}, 10), "");
    EXPECT_EQ(sparkline(std::vector<double>{3, 3}, 10), "▅▅");
    EXPECT_EQ(sparkline(std::vector<double>{3}, 0), "");
}

TEST(Bar, FillsItsShareInEighths) {
    EXPECT_EQ(bar(0, 3), "   ");
    EXPECT_EQ(bar(0.5, 3), "█▌ ");
    EXPECT_EQ(bar(1.0 / 24, 3), "▏  ");
    EXPECT_EQ(bar(7, 3), "███");
}

TEST(SpeedText, IsAFractionBelowRealTime) {
    EXPECT_EQ(speed_text(1), "1×");
    EXPECT_EQ(speed_text(2.5), "2.5×");
    EXPECT_EQ(speed_text(0.125), "1/8×");
    EXPECT_EQ(speed_text(0.3), "0.3×");
}

TEST(Visible, RemovesControlCharacters) {
    EXPECT_EQ(visible("a\x1b[2Jb\r\a\x7f\tc\nd"), "a?[2Jb????c\nd");
    EXPECT_EQ(visible("\xc2\x9b"
                      "31m \xc2\xa0 \xc3\x9b µ 🦠"),
              "?31m \xc2\xa0 \xc3\x9b µ 🦠");
    EXPECT_EQ(visible("a\xe2\x80\xaf\xe2\x80\xae z"), "a\xe2\x80\xaf? z") << "U+202E reverses the text after it";
    EXPECT_EQ(visible("\xc2"), "\xc2");
}

TEST(Table, AlignsByCharactersNotBytes) {
    Table table{{{"NAME"}, {"VALUE", Table::Align::Right}, {"UNIT"}}};
    table.add({"x", "1.5", "kg px/s²"});
    table.add({"größe", "10", ""});
    EXPECT_EQ(table.to_text(), "NAME   VALUE  UNIT\n"
                               "x        1.5  kg px/s²\n"
                               "größe     10\n");
}

TEST(ShortTime, HasTwoOrThreeDigits) {
    EXPECT_EQ(short_time(0), "0.0 µs");
    EXPECT_EQ(short_time(2.34e-6), "2.3 µs");
    EXPECT_EQ(short_time(999.4e-6), "999 µs");
    EXPECT_EQ(short_time(999.6e-6), "1.0 ms");
    EXPECT_EQ(short_time(0.0123), "12 ms");
    EXPECT_EQ(short_time(0.9996), "1.0 s");
    EXPECT_EQ(short_time(75), "75 s");
}

TEST(ShortBytes, HasTwoToFourDigits) {
    EXPECT_EQ(short_bytes(0), "0 B");
    EXPECT_EQ(short_bytes(1023), "1023 B");
    EXPECT_EQ(short_bytes(1024), "1.0 KiB");
    EXPECT_EQ(short_bytes(20'000), "20 KiB");
    EXPECT_EQ(short_bytes(1.5 * 1024 * 1024), "1.5 MiB");
    EXPECT_EQ(short_bytes(3e12), "2.7 TiB");
}

TEST(ClipLines, CutsEachLineAtACharacter) {
    EXPECT_EQ(clip_lines("größe\nab\n\n12345", 3), "grö\nab\n\n123");
    EXPECT_EQ(clip_lines("ab\n", 0), "\n");
}

TEST(ClipPage, LeavesTheCursorOnTheScreen) {
    EXPECT_EQ(clip_page("one\ntwo\nthree\n", 3, 4), "one\ntwo\nthr\n") << "the cursor stands on the fourth line";
    EXPECT_EQ(clip_page("one\ntwo\nthree\n", 80, 3), "one\ntwo\nthree");
    EXPECT_EQ(clip_page("one\ntwo\nthree\n", 2, 2), "on\ntw");
    EXPECT_EQ(clip_page("one\ntwo\nthree", 80, 1), "one");
    EXPECT_EQ(clip_page("one\n", 80, 0), "one") << "a screen has a line";
    EXPECT_EQ(clip_page("one", 80, 5), "one");
    EXPECT_EQ(clip_page("", 80, 5), "");
}

TEST(Colors, HaveNoWidthAndAreNotCut) {
    EXPECT_EQ(in_color("dead", Color::Red), "dead") << "not in use yet";
    EXPECT_EQ(visible("\x1b[31mdead"), "?[31mdead");
    use_colors(true);
    const std::string dead = in_color("dead", Color::Red);
    EXPECT_EQ(dead, "\x1b[31mdead\x1b[0m");
    EXPECT_EQ(in_color("", Color::Red), "");
    EXPECT_EQ(width_of(dead), 4U);
    EXPECT_EQ(clip_lines(dead, 2), "\x1b[31mde\x1b[0m");
    EXPECT_EQ(visible(dead + "\x1b[2J"), dead + "?[2J") << "only colours are kept";
    use_colors(false);
}

} // namespace
} // namespace evod::ctl
