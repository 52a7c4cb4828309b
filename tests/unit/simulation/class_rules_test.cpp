#include "server/simulation/class_rules.h"

#include <gtest/gtest.h>

#include <limits>

namespace evod::simulation {
namespace {

const ClassRules rules{.frozen = false, .ranges = {{"food_count", 1, 5}, {"mutation_chance", 0.25, 0.5}}};

std::size_t outside(const parameters::ParameterValue& value, const char* name = "mutation_chance") {
    const std::vector<parameters::Assignment> assignments{{name, value}};
    return values_outside(rules, "bio", assignments, "set_parameters.").size();
}

TEST(ClassRules, BothEndsOfARangeBelongToIt) {
    EXPECT_EQ(outside(0.25), 0u);
    EXPECT_EQ(outside(0.5), 0u);
    EXPECT_EQ(outside(0.51), 1u);
    EXPECT_EQ(outside(0.24), 1u);
    EXPECT_EQ(outside(std::numeric_limits<double>::quiet_NaN()), 1u);
    EXPECT_EQ(outside(std::uint32_t{6}, "food_count"), 1u);
    EXPECT_EQ(outside(std::uint32_t{5}, "food_count"), 0u);
}

TEST(ClassRules, OtherParametersAndOtherKindsAreFree) {
    EXPECT_EQ(outside(1e9, "generation_s"), 0u);
    EXPECT_EQ(outside(true, "mutation_chance"), 0u) << "the registry refuses the kind";
    EXPECT_EQ(rules.range_of("generation_s"), nullptr);
    EXPECT_EQ(rules.range_of("food_count")->max, 5);
}

} // namespace
} // namespace evod::simulation
