// Equal (parameters, seed, commands) give equal bits after every tick, on any number of threads and with any observers.

#include "server/base/inline_executor.h"
#include "tests/determinism/scenarios.h"
#include "tests/support/thread_executor.h"

#include <gtest/gtest.h>

#include <string>
#include <tuple>
#include <vector>

namespace evod::scenarios {
namespace {

class SameStateOnAnyThreadCount : public testing::TestWithParam<std::tuple<Scenario, std::size_t>> {};

TEST_P(SameStateOnAnyThreadCount, TickByTick) {
    const auto& [scenario, thread_count] = GetParam();
    Play reference{scenario}, subject{scenario};
    base::InlineExecutor one;
    support::ThreadExecutor many{thread_count};
    ASSERT_EQ(subject.world().hash(), reference.world().hash()) << "states differ from the start";
    for (std::uint64_t tick = 1; tick <= scenario.ticks; ++tick) {
        reference.advance(one);
        subject.advance(many);
        ASSERT_EQ(subject.world().hash(), reference.world().hash()) << "states part at tick " << tick;
    }
}

INSTANTIATE_TEST_SUITE_P(Threads, SameStateOnAnyThreadCount,
                         testing::Combine(testing::ValuesIn(all()), testing::Values(1, 2, 3, 8, 13)),
                         [](const auto& test) {
                             return std::string{std::get<0>(test.param).name} + "_on_" +
                                    std::to_string(std::get<1>(test.param));
                         });

class AnyScenario : public testing::TestWithParam<Scenario> {};
INSTANTIATE_TEST_SUITE_P(All, AnyScenario, testing::ValuesIn(all()), testing::PrintToStringParamName());

TEST_P(AnyScenario, HasTheSameHashesOnlyWithTheSameSeed) {
    const Scenario& scenario = GetParam();
    Play first{scenario}, again{scenario}, other{scenario, base::Seed{scenario.seed.value + (1ull << 32)}};
    base::InlineExecutor executor;
    for (std::uint64_t tick = 1; tick <= scenario.ticks; ++tick) {
        first.advance(executor);
        again.advance(executor);
        other.advance(executor);
        ASSERT_EQ(again.world().hash(), first.world().hash()) << "states part at tick " << tick;
        ASSERT_NE(other.world().hash(), first.world().hash()) << "at tick " << tick;
    }
}

TEST_P(AnyScenario, ChangesItsHashWithEveryTick) {
    Play run{GetParam()};
    base::InlineExecutor executor;
    base::StateHash before = run.world().hash();
    for (std::uint64_t tick = 1; tick <= GetParam().ticks; ++tick) {
        run.advance(executor);
        ASSERT_NE(run.world().hash(), before) << "at tick " << tick;
        before = run.world().hash();
    }
}

TEST_P(AnyScenario, DoesNotDependOnObservers) {
    const Scenario& scenario = GetParam();
    Play alone{scenario}, watched{scenario};
    base::InlineExecutor executor;
    support::ThreadExecutor other_executor{3};
    std::uint64_t seen = 0;
    for (std::uint64_t tick = 1; tick <= scenario.ticks; ++tick) {
        alone.advance(executor);
        watched.advance(executor);
        const simulation::World& world = watched.world();
        seen += world.alive_count() + world.history().size() + world.parameters().revision;
        if (tick % 10 == 0) { // costly
            for (const simulation::Island& island : world.islands()) {
                const auto now = static_cast<std::uint32_t>(world.moment().generation_tick);
                seen += island.live_statistics().alive_count;
                seen += island.fitness(world.parameters().active, now, other_executor).size();
                seen += island.body_of(3).value_or(0);
                if (world.has_bodies()) {
                    seen += island.food().two_nearest(99, 99, 200).place;
                }
            }
        }
        ASSERT_EQ(watched.world().hash(), alone.world().hash()) << "states part at tick " << tick;
    }
    EXPECT_GT(seen, 0u);
}

TEST(AWorld, DoesNotDependOnTheOthersOfItsLaboratory) {
    const Scenario &mine = all()[4], &others = all()[6];
    Play alone{mine}, crowded{mine};
    const auto create = [&](const char* name, std::uint64_t seed) {
        ASSERT_TRUE(crowded.laboratory()
                        .apply(simulation::CreateWorld{.name = name,
                                                       .parameters = parameters_of(others.experiment),
                                                       .seed = base::Seed{seed},
                                                       .run_id = {}})
                        .has_value());
    };
    create("a", mine.seed.value);
    create("b", 5);
    base::InlineExecutor executor;
    for (std::uint64_t tick = 1; tick <= 300; ++tick) {
        alone.advance(executor);
        crowded.advance(executor);
        for (std::size_t i = 1; i < crowded.laboratory().entries().size(); ++i) {
            crowded.laboratory().advance(*crowded.laboratory().entries()[i], executor);
        }
        if (tick == 150) {
            ASSERT_TRUE(crowded.laboratory().apply(simulation::DeleteWorld{.world = "a"}).has_value());
        }
        ASSERT_EQ(crowded.world().hash(), alone.world().hash()) << "states part at tick " << tick;
    }
}

TEST_P(AnyScenario, ResetGivesTheFirstRunsHashesAgain) {
    const Scenario& scenario = GetParam();
    if (!scenario.changes.empty()) {
        return; // a reset keeps the requested parameters
    }
    Play fresh{scenario}, used{scenario};
    base::InlineExecutor executor;
    for (int tick = 0; tick < 50; ++tick) {
        used.advance(executor);
    }
    ASSERT_TRUE(used.laboratory().apply(simulation::ResetWorld{.world = "w", .seed = {}, .run_id = {}}).has_value());
    ASSERT_TRUE(used.laboratory().apply(simulation::Run{.world = "w", .generations = {}}).has_value());
    ASSERT_EQ(used.world().hash(), fresh.world().hash());
    for (std::uint64_t tick = 1; tick <= scenario.ticks; ++tick) {
        used.advance(executor);
        fresh.advance(executor);
        ASSERT_EQ(used.world().hash(), fresh.world().hash()) << "states part at tick " << tick;
    }
}

} // namespace
} // namespace evod::scenarios
