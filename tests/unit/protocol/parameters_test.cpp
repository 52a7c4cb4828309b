#include "server/protocol/parameters.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <tuple>
#include <vector>

namespace evod::protocol {
namespace {

TEST(ParameterMessage, EveryParameterSurvivesARoundTrip) {
    for (const auto& description : parameters::parameter_registry()) {
        v1::SetParameters message;
        auto& assignment = *message.add_parameters();
        assignment.set_name(std::string{description.name});
        *assignment.mutable_value() = to_proto(description.default_value());
        std::vector<base::Violation> violations;
        const auto made = to_assignments(message.parameters(), "", violations);
        ASSERT_TRUE(violations.empty()) << description.name;
        ASSERT_EQ(made.size(), 1);
        EXPECT_EQ(made[0].name, description.name);
        EXPECT_EQ(made[0].value, description.default_value()) << description.name;
        EXPECT_FALSE(parameters::fault_of(made[0])) << description.name;

        const auto converted = to_proto(description);
        EXPECT_NE(converted.kind(), v1::PARAMETER_KIND_UNSPECIFIED);
        EXPECT_NE(converted.effect(), v1::PARAMETER_EFFECT_UNSPECIFIED);
        EXPECT_TRUE(converted.has_default_value());
    }
}

TEST(ParameterMessage, ASetHasCurrentAndPendingValues) {
    parameters::ParameterSet set;
    set.requested.values.population_size = 60;
    set.revision = 9;
    const auto message = to_proto(set, nullptr);
    EXPECT_EQ(message.revision(), 9);
    EXPECT_EQ(static_cast<std::size_t>(message.parameters_size()), parameters::parameter_registry().size());
    for (const auto& state : message.parameters()) {
        EXPECT_EQ(state.has_pending(), state.name() == "population_size") << state.name();
    }
}

TEST(ParameterMessage, AStateHasAnEffectThatIsNotTheUsual) {
    parameters::ParameterSet set;
    for (const bool has_births : {false, true}) {
        set.active.reproduction = has_births ? parameters::Reproduction::Births : parameters::Reproduction::Generations;
        const auto message = to_proto(set, nullptr);
        for (const auto& state : message.parameters()) {
            const auto kept = parameters::kept_with_births();
            const bool is_kept = std::ranges::find(kept, state.name()) != kept.end();
            EXPECT_EQ(state.has_effect(), has_births && is_kept) << state.name();
            EXPECT_TRUE(!state.has_effect() || state.effect() == v1::PARAMETER_EFFECT_RESET) << state.name();
        }
    }
}

TEST(ParameterMessage, AScheduleSurvivesARoundTrip) {
    parameters::Schedule schedule;
    schedule.add(3, {"mutation_chance", 0.05});
    schedule.add(3, {"population_size", 70u});
    schedule.add(9, {"selection", std::string{"tournament"}});
    schedule.begin_with({});
    std::vector<base::Violation> violations;
    EXPECT_EQ(to_schedule(to_proto(schedule, 1), {}, "", violations), schedule);
    EXPECT_THAT(violations, testing::IsEmpty());
    const auto later = to_proto(schedule, 3);
    ASSERT_EQ(later.size(), 1);
    EXPECT_EQ(later[0].generation(), 9);
    EXPECT_EQ(later[0].name(), "selection");
    EXPECT_EQ(later[0].value().choice(), "tournament");
    EXPECT_EQ(to_proto(schedule, 9).size(), 0);
}

TEST(ParameterMessage, EveryFaultOfAScheduleIsNamed) {
    const auto fields = [](std::vector<std::tuple<std::string, std::uint64_t, double>> values) {
        google::protobuf::RepeatedPtrField<v1::ScheduledValue> message;
        for (const auto& [name, generation, value] : values) {
            auto& to = *message.Add();
            to.set_name(name);
            to.set_generation(generation);
            if (value >= 0) {
                to.mutable_value()->set_real(value);
            }
        }
        std::vector<base::Violation> violations;
        (void)to_schedule(message, {}, "create_world.", violations);
        std::vector<std::string> named;
        for (const auto& violation : violations) {
            named.push_back(violation.field + ": got " + violation.got);
        }
        return named;
    };
    using testing::ElementsAre;
    using testing::HasSubstr;
    EXPECT_THAT(fields({{"mutation_chance", 2, 1.5}}),
                ElementsAre("create_world.mutation_chance at generation 2: got 1.5"));
    EXPECT_THAT(fields({{"mutation_chance", 2, -1}}), ElementsAre(HasSubstr("generation 2: got no value")));
    EXPECT_THAT(fields({{"mutation_chance", 0, 0.1}, {"mutation_step", 1, 3}}),
                ElementsAre(HasSubstr("generation 0: got 0"), HasSubstr("generation 1: got 1")));
    EXPECT_THAT(fields({{"mutation_chance", 2, 0.1}, {"mutation_chance", 2, 0.1}}),
                ElementsAre(HasSubstr("given twice")));
    EXPECT_THAT(fields({{"initial_gene_min", 2, 90}}), ElementsAre(HasSubstr("create_world.initial_gene_min at")));
    EXPECT_THAT(fields({{"no_such", 2, 1}}), ElementsAre(HasSubstr("create_world.no_such at")));
    EXPECT_THAT(fields({{"impulse_min", 5, 300}}), ElementsAre("create_world.impulse_max at generation 5: got 250"));
    std::vector<std::tuple<std::string, std::uint64_t, double>> many;
    for (std::uint64_t i = 0; i < 4097; ++i) {
        many.emplace_back("mutation_chance", i + 2, 0.5);
    }
    EXPECT_THAT(fields(many), ElementsAre("create_world.schedule: got 4097"));
    many.pop_back();
    EXPECT_THAT(fields(many), testing::IsEmpty());
}

} // namespace
} // namespace evod::protocol
