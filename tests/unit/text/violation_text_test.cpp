#include "proto/text/violation_text.h"

#include <gtest/gtest.h>

namespace evod::text {
namespace {

TEST(ViolationText, SuggestsNamesForAnUnknownOne) {
    EXPECT_EQ(violation_text("2", "0 to 1"), "got 2, allowed 0 to 1");
    EXPECT_EQ(violation_text(unknown_name, "grid, list"), "unknown name, allowed grid, list");
    EXPECT_EQ(violation_text(unknown_name, "grid, list; did you mean grid"), "unknown name; did you mean grid?");
}

} // namespace
} // namespace evod::text
