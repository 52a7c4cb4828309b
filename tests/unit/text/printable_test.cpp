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

} // namespace
} // namespace evod::text
