#include "proto/command_line/terminal.h"

#include <gtest/gtest.h>

namespace evod::command_line {
namespace {

TEST(PrintError, BeginsEveryLineWithTheProgram) {
    testing::internal::CaptureStderr();
    print_error("lab", "mine.json: invalid experiment\n  seed: got 1.5\n--port: got x");
    EXPECT_EQ(testing::internal::GetCapturedStderr(),
              "lab: mine.json: invalid experiment\n  seed: got 1.5\nlab: --port: got x\n");
}

TEST(Colors, AreOnlyForTerminals) {
    testing::internal::CaptureStdout();
    EXPECT_FALSE(may_color(1)) << "standard output is a file";
    testing::internal::GetCapturedStdout();
    EXPECT_EQ(colored("dead", Color::Red), "\033[31mdead\033[0m");
}

} // namespace
} // namespace evod::command_line
