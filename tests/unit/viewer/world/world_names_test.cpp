#include "client/viewer/world/world_names.h"

#include <gtest/gtest.h>

#include <vector>

namespace evod::viewer {
namespace {

TEST(WorldNames, SuggestsANameThatNoWorldHas) {
    const std::vector<std::string> used{"default", "default-2", "default-3", "w9"};
    EXPECT_EQ(unused_name("islands", used), "islands");
    EXPECT_EQ(unused_name("default", used), "default-4");
    EXPECT_EQ(unused_name("default-2", used), "default-4");
    EXPECT_EQ(unused_name("w9", used), "w9-2") << "the number is part of the name";
    const std::string longest(64, 'x');
    EXPECT_EQ(unused_name(longest, std::vector{longest}), std::string(62, 'x') + "-2");
}

} // namespace
} // namespace evod::viewer
