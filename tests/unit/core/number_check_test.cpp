#include "client/core/number_check.h"

#include "evod/v1/session.pb.h"

#include <gtest/gtest.h>

#include <limits>

namespace evod::core {
namespace {

constexpr double nan = std::numeric_limits<double>::quiet_NaN(), infinite = std::numeric_limits<double>::infinity();

TEST(NumberCheck, FindsNanAtAnyDepth) {
    v1::ServerMessage message;
    EXPECT_EQ(field_without_number(message), "");
    auto& statistics = *message.mutable_response()->mutable_statistics();
    statistics.add_last()->set_fitness_best(1);
    EXPECT_EQ(field_without_number(message), "");
    statistics.add_last()->add_genes()->set_mean(nan);
    EXPECT_EQ(field_without_number(message), "evod.v1.GeneStatistics.mean");
    v1::ServerMessage floats;
    floats.mutable_response()->mutable_organism()->mutable_brain()->add_inputs(std::numeric_limits<float>::quiet_NaN());
    EXPECT_EQ(field_without_number(floats), "evod.v1.Brain.inputs");
}

TEST(NumberCheck, LimitsOfParametersAreFinite) {
    for (const double limit : {nan, infinite, -infinite, std::numeric_limits<double>::max()}) {
        v1::ParameterDescription parameter;
        parameter.set_min(0);
        EXPECT_EQ(field_without_number(parameter), "");
        parameter.set_max(limit);
        EXPECT_EQ(field_without_number(parameter), "evod.v1.ParameterDescription.max");
    }
}

TEST(NumberCheck, CountsHaveALimit) {
    v1::ServerMessage message;
    auto& breeding = *message.mutable_response()->mutable_breeding();
    breeding.set_pick_count(1U << 28);
    EXPECT_EQ(field_without_number(message), "");
    breeding.set_pick_count(1'500'000'000);
    EXPECT_EQ(field_without_number(message), "evod.v1.Breeding.pick_count");
    v1::WorldInfo world;
    world.set_island_count(std::numeric_limits<std::uint32_t>::max());
    EXPECT_EQ(field_without_number(world), "evod.v1.WorldInfo.island_count");
}

TEST(NumberCheck, InfinityIsANumberElsewhere) {
    v1::LiveStatistics statistics;
    statistics.set_health_mean(infinite);
    EXPECT_EQ(field_without_number(statistics), "");
}

} // namespace
} // namespace evod::core
