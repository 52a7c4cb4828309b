// QR codes: their shape. tests/system/class_test.py reads them with another program.
#include "server/classes/qr_code.h"

#include <gtest/gtest.h>

namespace evod::classes {
namespace {

TEST(QrCodes, HaveThreeFinderPatterns) {
    const auto code = qr_code_of("http://lab:7745/#join=KTRMXB");
    ASSERT_TRUE(code);
    ASSERT_EQ(code->size, 29u);
    ASSERT_EQ(code->modules.size(), 29u * 29u);
    const auto is_dark = [&](std::size_t row, std::size_t column) { return code->modules[row * 29 + column] == 1; };
    for (const auto& [top, left] : {std::pair{0, 0}, {0, 22}, {22, 0}}) {
        for (int i = 0; i < 7; ++i) {
            EXPECT_TRUE(is_dark(top, left + i));
            EXPECT_TRUE(is_dark(top + i, left));
            EXPECT_TRUE(is_dark(top + 6, left + i));
        }
        EXPECT_TRUE(is_dark(top + 3, left + 3));
        EXPECT_FALSE(is_dark(top + 1, left + 1));
    }
}

TEST(QrCodes, TheLongestTextFits) {
    const auto code = qr_code_of(std::string(qr_text_bytes_max, '\xff'));
    ASSERT_TRUE(code);
    for (const char module : code->modules) {
        EXPECT_TRUE(module == 0 || module == 1);
    }
}

} // namespace
} // namespace evod::classes
