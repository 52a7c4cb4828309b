#include "proto/text/printable.h"

#include <gtest/gtest.h>

namespace evod::text {
namespace {

TEST(Printable, UnsafeCharactersAreMeasured) {
    EXPECT_EQ(unsafe_character_bytes("\x1b[31m"), 1u);
    EXPECT_EQ(unsafe_character_bytes("\n"), 1u);
    EXPECT_EQ(unsafe_character_bytes("\x7f"), 1u);
    EXPECT_EQ(unsafe_character_bytes("\xc2\x9b"), 2u) << "U+009B starts an escape sequence, too";
    EXPECT_EQ(unsafe_character_bytes("\xd8\x9c"), 2u);
    EXPECT_EQ(unsafe_character_bytes("\xe2\x80\xae"), 3u);
    EXPECT_EQ(unsafe_character_bytes("\xe2\x81\xa9x"), 3u);
    for (const char* const safe : {"", "a", "é", "…", "–", "\xc2\xa0", "\xe2\x80"}) {
        EXPECT_EQ(unsafe_character_bytes(safe), 0u) << safe;
    }
}

TEST(Printable, CharactersOfUtf8AreMeasured) {
    EXPECT_EQ(character_bytes("a"), 1u);
    EXPECT_EQ(character_bytes("é"), 2u);
    EXPECT_EQ(character_bytes("…"), 3u);
    EXPECT_EQ(character_bytes("\xf0\x9f\x90\x81"), 4u);
    for (const char* const invalid : {"", "\xff", "\x80", "\xc0\xaf", "\xe2\x80", "\xed\xa0\x80", "\xf4\x90\x80\x80"}) {
        EXPECT_EQ(character_bytes(invalid), 0u) << invalid;
    }
}

} // namespace
} // namespace evod::text
