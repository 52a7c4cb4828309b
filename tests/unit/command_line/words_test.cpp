#include "proto/command_line/words.h"

#include <gtest/gtest.h>

#include <vector>

namespace evod::command_line {
namespace {

TEST(Joined, PutsTheSeparatorBetweenNames) {
    EXPECT_EQ(joined(std::vector<std::string>{"bash", "zsh"}), "bash, zsh");
    EXPECT_EQ(joined(std::vector<std::string>{"bash", "zsh"}, "|"), "bash|zsh");
    EXPECT_EQ(joined(std::vector<std::string>{}), "");
}

TEST(Wrapped, BreaksLinesAtBlanks) {
    EXPECT_EQ(wrapped("one two three", 7), "one two\nthree");
    EXPECT_EQ(wrapped("one\ntwo", 20), "one\ntwo") << "a line break stays";
    EXPECT_EQ(wrapped("extraordinary word", 5), "extraordinary\nword") << "a word is not cut";
    EXPECT_EQ(wrapped("one  two", 20), "one two");
    EXPECT_EQ(wrapped("", 20), "");
}

} // namespace
} // namespace evod::command_line
