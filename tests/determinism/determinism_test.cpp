// Equal (parameters, seed, commands) give equal bits after every tick, on any number of threads and with any observers.

#include "server/base/inline_executor.h"
#include "server/jobs/thread_pool.h"
#include "tests/determinism/scenarios.h"

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
    jobs::ThreadPool many{thread_count};
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

/// Places items and organisms on one island and removes others.
void change_entities(simulation::Laboratory& laboratory, std::uint64_t tick) {
    const auto name = laboratory.entries().front()->name;
    simulation::PlaceEntities place{.world = name, .island = static_cast<std::uint32_t>(tick % 2)};
    simulation::RemoveEntities remove{.world = name, .island = place.island};
    const auto px = [](std::uint64_t number) { return 60 + static_cast<double>(number % 3800); };
    for (std::uint32_t i = 0; i < 20; ++i) {
        const double x = px(tick * 131 + i * 397), y = px(tick * 71 + i * 577);
        place.items.push_back({i % 3 == 0 ? simulation::ItemKind::Poison : simulation::ItemKind::Food, x, y});
    }
    const simulation::Island& island = laboratory.entries().front()->world.islands()[place.island];
    for (std::uint32_t i = 0; i < 5; ++i) {
        simulation::PlaceEntities organism{.world = name, .island = place.island};
        organism.organisms.push_back({px(tick * 37 + i * 1013), px(tick * 91 + i * 211),
                                      std::vector<float>(evolution::body_gene_count, 90.0f + static_cast<float>(i))});
        (void)laboratory.apply(organism); // refused if there is no room
        const auto id = static_cast<std::uint32_t>((tick * 29 + i * 7) % island.life_records().cause.size());
        if (island.body_of(id)) {
            remove.organisms.push_back(id);
        }
    }
    EXPECT_TRUE(laboratory.apply(place));
    EXPECT_TRUE(remove.organisms.empty() || laboratory.apply(remove));
}

class SameStateWithPlacedEntities : public testing::TestWithParam<std::size_t> {};
INSTANTIATE_TEST_SUITE_P(Threads, SameStateWithPlacedEntities, testing::Values(1, 2, 4, 16));

TEST_P(SameStateWithPlacedEntities, TickByTick) {
    const auto parameters = parameters_of(
        R"({"population_size": 4500, "island_count": 2, "island_width_px": 4000, "island_height_px": 4000,
            "food_count": 2000, "poison_count": 900, "respawn_s": 0.4, "generation_s": 1.5})");
    simulation::Laboratory reference, subject;
    for (simulation::Laboratory* laboratory : {&reference, &subject}) {
        ASSERT_TRUE(laboratory->apply(simulation::CreateWorld{"w", parameters, base::Seed{5}, {}}));
        ASSERT_TRUE(laboratory->apply(simulation::Run{"w", {}}));
    }
    base::InlineExecutor one;
    jobs::ThreadPool many{GetParam()};
    for (std::uint64_t tick = 0; tick < 130; ++tick) {
        if (tick % 7 == 0 && !reference.entries().front()->world.generation_over()) {
            change_entities(reference, tick);
            change_entities(subject, tick);
        }
        reference.advance(*reference.entries().front(), one);
        subject.advance(*subject.entries().front(), many);
        ASSERT_EQ(subject.entries().front()->world.hash(), reference.entries().front()->world.hash())
            << "states part at tick " << tick;
    }
    EXPECT_GT(reference.entries().front()->world.islands()[0].counts().food_eaten, 0u);
    EXPECT_EQ(reference.entries().front()->world.moment().generation, 2u);
}

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
    jobs::ThreadPool other_executor{3};
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
