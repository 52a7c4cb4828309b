// Ranges: requests for narrower ranges, and worlds that do not keep to them.
#include "server/classes/ranges.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace evod::classes {
namespace {

v1::QuotaRanges request(const std::vector<Range>& ranges) {
    return to_proto(ranges);
}

const Range* of(const std::vector<Range>& ranges, const std::string& parameter) {
    for (const Range& range : ranges) {
        if (range.parameter == parameter) {
            return &range;
        }
    }
    return nullptr;
}

TEST(Ranges, TheDefaultWorldIsWithinTheDefaults) {
    std::vector<base::Violation> violations;
    check_ranges(default_ranges(), {}, {}, "bio2", "create_class.template", violations);
    EXPECT_TRUE(violations.empty());
    EXPECT_EQ(of(default_ranges(), "population_size")->max, 500);
    EXPECT_EQ(of(default_ranges(), "population_size")->min, 1);
    EXPECT_EQ(of(default_ranges(), "island_width_px")->max, 4000);
}

TEST(Ranges, OthersStayAsTheDefaults) {
    std::vector<base::Violation> violations;
    const auto ranges =
        ranges_of(request({{"mutation_chance", 0.1, 0.2}, {"population_size", 10, 1000}}), "r", violations);
    EXPECT_TRUE(violations.empty());
    EXPECT_EQ(ranges.size(), default_ranges().size() + 1);
    EXPECT_EQ(of(ranges, "population_size")->max, 1000);
    EXPECT_EQ(of(ranges, "food_count")->max, 2000);
    EXPECT_EQ(of(ranges, "mutation_chance")->min, 0.1);
    EXPECT_EQ(ranges_of(to_proto(ranges), "r", violations), ranges);
}

TEST(Ranges, EveryWrongFieldIsNamed) {
    std::vector<base::Violation> violations;
    const double nan = std::numeric_limits<double>::quiet_NaN();
    ranges_of(request({{"mutation_chanc", 0, 1},
                       {"selection", 0, 1},
                       {"food_count", 0.5, 3},
                       {"poison_count", 0, 1e12},
                       {"tick_s", nan, 1},
                       {"damping", 0.9, 0.5},
                       {"restitution", 0, 1},
                       {"restitution", 0, 1}}),
              "create_class.ranges", violations);
    ASSERT_EQ(violations.size(), 7u);
    EXPECT_EQ(violations[0].field, "create_class.ranges.mutation_chanc");
    EXPECT_NE(violations[0].allowed.find("did you mean mutation_chance"), std::string::npos);
    EXPECT_EQ(violations[1].field, "create_class.ranges.selection");
    EXPECT_EQ(violations[2].got, "0.5 to 3");
    EXPECT_EQ(violations[3].allowed, "a whole number, 0 to 20000000");
    EXPECT_EQ(violations[4].got, "nan to 1");
    EXPECT_EQ(violations[5].field, "create_class.ranges.damping.max");
    EXPECT_EQ(violations[6].got, "given twice");
}

TEST(Ranges, TooManyAreRefusedAtOnce) {
    std::vector<base::Violation> violations;
    ranges_of(request(std::vector<Range>(100'000, {"food_count", 0, 1})), "r", violations);
    EXPECT_EQ(violations.size(), 1u);
}

TEST(Ranges, AWorldOutsideIsRefused) {
    parameters::Parameters parameters;
    parameters.population_size = 100'000;
    parameters::Schedule schedule;
    schedule.add(7, {"food_count", std::uint32_t{2001}});
    schedule.begin_with(parameters);
    std::vector<base::Violation> violations;
    check_ranges(default_ranges(), parameters, schedule, "bio2", "create_class.template", violations);
    ASSERT_EQ(violations.size(), 2u);
    EXPECT_EQ(to_text(violations[0]),
              "create_class.template.population_size: got 100000, allowed 1 to 500 (class bio2)");
    EXPECT_EQ(violations[1].field, "create_class.template.schedule.generation 7.food_count");
}

} // namespace
} // namespace evod::classes
