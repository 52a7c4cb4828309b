#include "server/experiments/sweep_dimension.h"

#include <gmock/gmock.h>

namespace evod::experiments {
namespace {

using parameters::ParameterValue;
using testing::HasSubstr;

TEST(Range, StepsIncludeBothEnds) {
    const Range linear{.from = 1, .to = 3};
    EXPECT_EQ(linear.step(0, 5), ParameterValue{1.0});
    EXPECT_EQ(linear.step(1, 5), ParameterValue{1.5});
    EXPECT_EQ(linear.step(4, 5), ParameterValue{3.0});
    const Range whole{.from = 1, .to = 100, .log = true, .whole = true};
    EXPECT_EQ(whole.step(1, 3), ParameterValue{10u});
}

TEST(Range, QuantilesOfWholeNumbersHaveEqualShares) {
    const Range whole{.from = 1, .to = 4, .whole = true};
    EXPECT_EQ(whole.quantile(0), ParameterValue{1u});
    EXPECT_EQ(whole.quantile(0.2499), ParameterValue{1u});
    EXPECT_EQ(whole.quantile(0.25), ParameterValue{2u});
    EXPECT_EQ(whole.quantile(0.9999), ParameterValue{4u});
}

TEST(Dimension, IsAListOrARange) {
    const auto read = [](const std::string& text, Steps steps, SweepErrors& errors) {
        const auto document = parameters::parse_json(text);
        return read_dimension(document->members[0], "grid." + document->members[0].name, steps, errors);
    };
    SweepErrors errors;
    const auto list = read(R"({"food_count": [3, 5]})", Steps::Needed, errors);
    ASSERT_TRUE(list);
    EXPECT_EQ(list->values, (std::vector<ParameterValue>{3u, 5u}));
    const auto range = read(R"({"mutation_step": {"from": 1, "to": 9, "steps": 3}})", Steps::Needed, errors);
    ASSERT_TRUE(range);
    EXPECT_EQ(range->steps, 3u);
    EXPECT_TRUE(errors.violations.empty());
    EXPECT_FALSE(read(R"({"mutation_step": {"from": 1, "to": 9, "steps": 3}})", Steps::None, errors));
    ASSERT_EQ(errors.violations.size(), 1u);
    EXPECT_THAT(errors.violations[0].field, HasSubstr("grid.mutation_step.steps (line 1)"));
}

TEST(SweptValue, HasTheTypeOfItsParameter) {
    const std::string text = "5";
    const auto node = parameters::parse_json(text);
    SweepErrors errors;
    const auto& real = *parameters::find_parameter("mutation_step");
    const auto& count = *parameters::find_parameter("food_count");
    EXPECT_EQ(read_swept_value(real, "a", *node, errors), ParameterValue{5.0});
    EXPECT_EQ(read_swept_value(count, "a", *node, errors), ParameterValue{5u});
    EXPECT_FALSE(read_swept_value(*parameters::find_parameter("respawn"), "a", *node, errors));
    EXPECT_EQ(errors.violations.size(), 1u);
}

} // namespace
} // namespace evod::experiments
