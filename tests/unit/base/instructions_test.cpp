// The processor's vector instructions: which there are, and the choice among them.
#include "server/base/instructions.h"

#include <gtest/gtest.h>

namespace evod::base {
namespace {

TEST(Instructions, OfEveryProcessorContainTheBaseline) {
    EXPECT_EQ(available_instructions().front(), "baseline");
    EXPECT_EQ(available_instructions().back(), name_of(widest_instructions()));
}

TEST(Instructions, AreTheDefaultUnlessOthersAreSelected) {
    EXPECT_EQ(instructions(), default_instructions());
    EXPECT_LE(default_instructions(), widest_instructions());
}

TEST(Instructions, AreSelectedByName) {
    const int copies[] = {0, 1, 2};
    for (const std::string_view name : available_instructions()) {
        EXPECT_TRUE(use_instructions(name));
        EXPECT_EQ(name_of(instructions()), name);
        EXPECT_EQ(chosen(copies[0], copies[1], copies[2]), static_cast<int>(instructions()));
    }
    use_instructions(default_instructions());
}

TEST(Instructions, StayThoseInUseIfANameIsUnknown) {
    for (const std::string_view name : {"", "AVX2", "avx1024"}) {
        EXPECT_FALSE(use_instructions(name)) << name;
        EXPECT_EQ(instructions(), default_instructions());
    }
}

} // namespace
} // namespace evod::base
