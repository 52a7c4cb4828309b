#include "proto/command_line/number.h"

#include <gtest/gtest.h>

namespace evod::command_line {
namespace {

TEST(WholeNumber, AcceptsNumbersInRange) {
    for (const char* word : {"0", "7", "18446744073709551615"}) {
        EXPECT_EQ(WholeNumber{}(word), "") << word;
    }
    EXPECT_EQ((WholeNumber{1, 10}("1")), "");
    EXPECT_EQ((WholeNumber{1, 10}("10")), "");
}

TEST(WholeNumber, ReportsTheRangeAndTheWord) {
    for (const std::string word :
         {"0", "11", "-1", "1e99", "abc", "", "1.5", "010", "0x3", "+2", " 3", "99999999999999999999"}) {
        EXPECT_EQ((WholeNumber{1, 10}(word)), "got " + word + ", allowed a whole number, 1 to 10");
    }
}

TEST(RealNumber, AcceptsOnlyNumbersInRange) {
    for (const char* word : {"0.1", "3600", "1e3", "2.5"}) {
        EXPECT_EQ((RealNumber{0.1, 3600}(word)), "") << word;
    }
    for (const std::string word : {"0", "-1", "1e99", "abc", "", "nan", "inf", "1,5"}) {
        EXPECT_EQ((RealNumber{0.1, 3600}(word)), "got " + word + ", allowed 0.1 to 3600");
    }
}

} // namespace
} // namespace evod::command_line
