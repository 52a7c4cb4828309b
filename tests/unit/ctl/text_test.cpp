#include "client/ctl/text.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

namespace evod::ctl {
namespace {

using testing::ElementsAre;

const std::vector<std::string> names{"mutation_chance", "mutate_survivors", "selection",
                                     "survivors",       "respawn",          "respawn_s"};

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

TEST(Visible, RemovesControlCharacters) {
    EXPECT_EQ(visible("a\x1b[2Jb\r\a\x7f\tc\nd"), "a?[2Jb????c\nd");
    EXPECT_EQ(visible("\xc2\x9b"
                      "31m \xc2\xa0 \xc3\x9b µ 🦠"),
              "?31m \xc2\xa0 \xc3\x9b µ 🦠");
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

TEST(EditDistance, CountsSingleEdits) {
    EXPECT_EQ(edit_distance("", ""), 0U);
    EXPECT_EQ(edit_distance("", "abc"), 3U);
    EXPECT_EQ(edit_distance("kitten", "sitting"), 3U);
    EXPECT_EQ(edit_distance("selcetion", "selection"), 1U) << "neighbours swapped are one mistake";
}

TEST(Nearest, FindsTheIntendedName) {
    EXPECT_THAT(nearest("mutation_chanse", names), ElementsAre("mutation_chance"));
    EXPECT_THAT(nearest("survivor", names), ElementsAre("survivors", "mutate_survivors"));
    EXPECT_THAT(nearest("respwan", names), ElementsAre("respawn"));
    EXPECT_THAT(nearest("zebra", names), ElementsAre());
    EXPECT_EQ(did_you_mean("zebra", names), "");
    EXPECT_EQ(did_you_mean("survivor", names), "; did you mean survivors or mutate_survivors?");
}

} // namespace
} // namespace evod::ctl
