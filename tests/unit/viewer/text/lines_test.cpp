#include "client/viewer/text/lines.h"

#include <gtest/gtest.h>

namespace evod::viewer {
namespace {

/// Lines of characters of equal width.
std::string lines_of(std::string_view text, float signs_max) {
    return in_lines(text, signs_max, [](std::string_view line) {
        float signs = 0;
        for (const char byte : line) {
            signs += (static_cast<unsigned char>(byte) & 0xc0) != 0x80 ? 1.f : 0.f;
        }
        return signs;
    });
}

TEST(Lines, BreakAtSpacesAndNotInsideNumbers) {
    EXPECT_EQ(lines_of("tick 598,961 of 1,000,000.5", 12), "tick 598,961\nof\n1,000,000.5");
    EXPECT_EQ(lines_of("tick 598,961", 11), "tick\n598,961");
    EXPECT_EQ(lines_of("as it is", 8), "as it is");
    EXPECT_EQ(lines_of("", 8), "");
}

TEST(Lines, KeepTheBreaksOfTheText) {
    EXPECT_EQ(lines_of("one\ntwo three", 7), "one\ntwo\nthree");
    EXPECT_EQ(lines_of("one\n\ntwo\n", 7), "one\n\ntwo\n");
}

TEST(Lines, BreakATooWideWordBetweenCharacters) {
    EXPECT_EQ(lines_of("in /home/someone1/far", 6), "in\n/home/\nsomeon\ne1/far");
    EXPECT_EQ(lines_of("ωωω", 2), "ωω\nω");
    EXPECT_EQ(lines_of("abc", 0), "a\nb\nc") << "at least one character per line";
}

} // namespace
} // namespace evod::viewer
