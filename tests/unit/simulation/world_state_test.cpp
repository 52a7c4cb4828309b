// A state restored at the beginning of its generation continues like the original world.
#include "server/simulation/world_state.h"

#include "server/base/inline_executor.h"
#include "server/jobs/thread_pool.h"
#include "server/simulation/world.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>
#include <random>
#include <string>
#include <vector>

namespace evod::simulation {
namespace {

using testing::HasSubstr;

parameters::Parameters with(std::vector<parameters::Assignment> assignments) {
    parameters::Parameters parameters;
    parameters.population_size = 60;
    parameters.generation_s = 8;
    parameters.food_count = 60;
    parameters.poison_count = 60;
    return parameters::assign(parameters, assignments).value();
}

/// Worlds that differ in the parts of their state.
std::vector<parameters::Parameters> varied_worlds() {
    return {
        with({}),
        with({{"crate_count", 12u}, {"obstacle_count", 8u}, {"integrator", std::string{"explicit_euler"}}}),
        with({{"respawn_s", 1.5}, {"crate_count", 5u}, {"max_speed_px_s", 60.0}}),
        with({{"respawn", false}, {"integrator", std::string{"backward_euler"}}}),
        with({{"island_count", 5u},
              {"population_size", 9u},
              {"poison_count", 400u}, // some islands die out and wait
              {"respawn_s", 3.0},
              {"migration", std::string{"ring"}},
              {"migration_epoch", 1u}}),
        with({{"population_size", 1500u}, // sorted in memory as they move
              {"island_width_px", 8000.0},
              {"food_count", 900u},
              {"generation_s", 3.0}}),
        with({{"fitness_per_second", 0.0},
              {"fitness_per_food", 10.0},
              {"fitness_per_poison", -5.0},
              {"respawn_s", 1.0}}),
        with({{"fitness", std::string{"rastrigin"}}, {"island_count", 2u}}),
        with({{"controller", std::string{"network"}}, {"sense_wall", true}, {"crate_count", 5u}}),
        with({{"controller", std::string{"network"}},
              {"locomotion", std::string{"kinematic"}},
              {"population_size", 1500u},
              {"island_width_px", 8000.0},
              {"generation_s", 3.0}}),
        with({{"reproduction", std::string{"births"}}, // sexual
              {"birth_health", 100.0},
              {"birth_cost", 5.0},
              {"lifespan_s", 30.0},
              {"food_count", 200u},
              {"respawn_s", 1.5},
              {"crate_count", 5u},
              {"obstacle_count", 5u},
              {"generation_s", 3.0},
              {"island_count", 3u},
              {"migration", std::string{"ring"}},
              {"migration_epoch", 1u}}),
        with({{"reproduction", std::string{"births"}}, // two species
              {"births", std::string{"asexual"}},
              {"predator_births", std::string{"asexual"}},
              {"birth_health", 110.0},
              {"birth_cost", 5.0},
              {"shuffle_births", true},
              {"food_count", 300u},
              {"predator_count", 5u},
              {"predator_from", 2u},
              {"handling_s", 3.0},
              {"generation_s", 2.0}}),
        with({{"predator_count", 12u}, {"handling_s", 2.0}, {"generation_s", 4.0}}),
        with({{"controller", std::string{"network"}},
              {"reproduction", std::string{"births"}},
              {"birth_health", 100.0},
              {"food_count", 300u},
              {"predator_count", 3u},
              {"generation_s", 3.0}}),
    };
}

class WorldStateTest : public testing::Test {
  protected:
    /// A copy of the world at the beginning of its generation, brought to the state.
    base::Result<World> again(const World& world, const WorldState& state, base::Executor& with) {
        History history = world.history();
        if (world.generation_over()) {
            history.pop_back();
        }
        World restored{world.seed(), world.opening(), world.bred(), std::move(history), with};
        if (auto done = restored.restore(state, with); !done) {
            return done.error();
        }
        return restored;
    }
    static void change_something(World& world, std::uint32_t choice) {
        const std::vector<parameters::Assignment> changes[] = {
            {{"food_health", 5.0 + choice % 30}},
            {{"force_per_unit", 0.5 + choice % 3}},
            {{"population_size", 8 + choice % 9}, {"food_radius_min", 21.0}}, // for the next generation, and bounds
            {{"flee_rule", std::string{"always"}}}};
        world.request_parameters(parameters::assign(world.parameters().requested, changes[choice / 64 % 4]).value());
    }

    static std::vector<double> numbers(const std::vector<GenerationStatistics>& islands) {
        std::vector<double> found;
        for (const GenerationStatistics& island : islands) {
            for_each_number(island,
                            [&](const std::string&, auto value) { found.push_back(static_cast<double>(value)); });
        }
        return found;
    }

    base::InlineExecutor executor;
    jobs::ThreadPool three_threads{3};
};

TEST_F(WorldStateTest, ARestoredWorldContinuesLikeTheOriginal) {
    std::mt19937 random{3};
    int over = 0, moments = 0;
    for (const parameters::Parameters& parameters : varied_worlds()) {
        const bool large = parameters.population_size > 1000;
        const std::uint32_t ticks_max = large ? 150 : 700;
        for (int round = 0; round < (large ? 10 : 32); ++round) {
            World world{parameters, base::Seed{static_cast<std::uint64_t>(round)}};
            for (auto ticks = random() % ticks_max; ticks > 0; --ticks) {
                world.advance_tick(executor);
                if (random() % 200 == 0) {
                    change_something(world, static_cast<std::uint32_t>(random()));
                }
            }
            const WorldState state =
                world.state(round % 2 == 0 ? static_cast<base::Executor&>(executor) : three_threads);
            auto restored = again(world, state, three_threads);
            ASSERT_TRUE(restored) << to_text(restored.error());
            ASSERT_EQ(restored->hash(), world.hash()) << world.moment().generation_tick;
            EXPECT_EQ(restored->moment(), world.moment());
            EXPECT_EQ(restored->generation_over(), world.generation_over());
            EXPECT_EQ(restored->state(executor).islands, state.islands);
            over += world.generation_over();
            ++moments;
            const std::uint32_t ticks_after = large ? 100 : 1000;
            for (std::uint32_t tick = 0; tick < ticks_after; ++tick) {
                world.advance_tick(executor);
                restored->advance_tick(three_threads);
                ASSERT_EQ(restored->hash(), world.hash()) << "after " << tick + 1 << " ticks";
                if (random() % 300 == 0) {
                    const auto choice = static_cast<std::uint32_t>(random());
                    change_something(world, choice);
                    change_something(*restored, choice);
                }
            }
            ASSERT_EQ(restored->history().size(), world.history().size());
            for (std::size_t i = 0; i < world.history().size(); ++i) {
                EXPECT_EQ(numbers(restored->history()[i]), numbers(world.history()[i]));
            }
        }
    }
    EXPECT_GE(moments, 200);
    EXPECT_GE(over, 5);
}

TEST_F(WorldStateTest, IsRestoredAtTheEndOfAGeneration) {
    parameters::Parameters parameters = with({{"generation_s", 1.0}, {"island_count", 2u}});
    World world{parameters, base::Seed{2}};
    for (int tick = 0; tick < 120; ++tick) {
        world.advance_tick(executor);
    }
    ASSERT_TRUE(world.generation_over());
    // The parameters that the generation's statistics used differ from those in effect now.
    world.request_parameters(
        parameters::assign(world.parameters().requested,
                           std::vector<parameters::Assignment>{{"base_health_min", 90.0}, {"base_health_max", 95.0}})
            .value());
    auto restored = again(world, world.state(executor), three_threads);
    ASSERT_TRUE(restored) << to_text(restored.error());
    EXPECT_TRUE(restored->generation_over());
    EXPECT_EQ(restored->history().back()[1].diversity, world.history().back()[1].diversity);
    for (int tick = 0; tick < 200; ++tick) {
        world.advance_tick(executor);
        restored->advance_tick(three_threads);
        ASSERT_EQ(restored->hash(), world.hash());
    }
}

TEST_F(WorldStateTest, ImpossibleStatesAreRefused) {
    const parameters::Parameters parameters = with({{"crate_count", 3u}, {"respawn_s", 2.0}, {"poison_count", 200u}});
    World world{parameters, base::Seed{9}};
    for (int tick = 0; tick < 200; ++tick) {
        world.advance_tick(executor);
    }
    ASSERT_LT(world.alive_count(), 60u);
    ASSERT_GT(world.alive_count(), 2u);
    const WorldState sound = world.state(executor);
    const auto of = [&](CauseOfDeath cause) {
        return static_cast<std::size_t>(std::ranges::find(sound.islands[0].life_records.cause, cause) -
                                        sound.islands[0].life_records.cause.begin());
    };
    const std::size_t living = of(CauseOfDeath::Alive), gone = of(CauseOfDeath::Poisoned);
    const float nan = std::numeric_limits<float>::quiet_NaN();
    const std::vector<std::pair<const char*, std::function<void(WorldState&)>>> wrongs = {
        {"moment", [](WorldState& s) { ++s.moment.tick; }},
        {"moment", [](WorldState& s) { ++s.moment.generation; }},
        {"moment", [](WorldState& s) { s.moment.simulated_s = std::nan(""); }},
        {"moment", [](WorldState& s) { s.moment.tick = s.moment.generation_tick = 100'000; }},
        {"parameters", [](WorldState& s) { s.parameters.active.damping = 0.5; }},
        {"parameters", [](WorldState& s) { s.parameters.requested.values.body_size_min = 300; }},
        {"islands", [](WorldState& s) { s.islands.clear(); }},
        {"end of the generation", [](WorldState& s) { s.ended.resize(1); }},
        {"number of organisms", [](WorldState& s) { s.islands[0].life_records.lived_ticks.pop_back(); }},
        {"number of organisms", [](WorldState& s) { s.islands[0].organisms.pop_back(); }},
        {"crates", [](WorldState& s) { s.islands[0].crates.pop_back(); }},
        {"of a crate", [](WorldState& s) { s.islands[0].crates[1].x = -1; }},
        {"of a crate", [](WorldState& s) { s.islands[0].crates[1].velocity_x = 1e30f; }},
        {"position or speed", [&](WorldState& s) { s.islands[0].organisms[living].velocity_y = nan; }},
        {"position or speed", [&](WorldState& s) { s.islands[0].organisms[living].x = physics::void_position; }},
        {"health", [&](WorldState& s) { s.islands[0].organisms[living].health = nan; }},
        {"health", [&](WorldState& s) { s.islands[0].organisms[living].health = 0; }},
        {"health", [&](WorldState& s) { s.islands[0].organisms[living].health = 1e12f; }},
        {"lived_ticks", [&](WorldState& s) { s.islands[0].life_records.lived_ticks[living] = 3; }},
        {"death", [&](WorldState& s) { s.islands[0].life_records.lived_ticks[gone] = 201; }},
        {"death", [&](WorldState& s) { s.islands[0].life_records.cause[gone] = static_cast<CauseOfDeath>(4); }},
        {"death", [&](WorldState& s) { s.islands[0].organisms[gone].health = 1; }},
        {"dead", [&](WorldState& s) { s.islands[0].life_records.cause[gone] = CauseOfDeath::Starved; }},
        {"food", [](WorldState& s) { s.islands[0].food.pop_back(); }},
        {"food", [](WorldState& s) { s.islands[0].food[3].y = 1 << 30; }},
        {"food", [](WorldState& s) { s.islands[0].food[3].x = s.islands[0].food[3].y = 0; }},
        {"poison", [](WorldState& s) { s.islands[0].poison[3].due_tick = 200; }},
        {"poison", [](WorldState& s) { s.islands[0].poison[3].due_tick = 321; }},
        {"poison", [](WorldState& s) { s.islands[0].poison[3].due_tick = Items::none - 1; }},
        {"food", [](WorldState& s) { s.islands[0].placed_food = 1; }},
        {"number of organisms", [](WorldState& s) { s.islands[0].placed.resize(1); }},
    };
    for (const auto& [what, spoil] : wrongs) {
        WorldState state = sound;
        spoil(state);
        const auto refused = again(world, state, executor);
        ASSERT_FALSE(refused) << what;
        EXPECT_THAT(refused.error().message, HasSubstr(what));
    }
    EXPECT_TRUE(again(world, sound, executor));
}

TEST_F(WorldStateTest, TheGreatestReachableHealthIsSummed) {
    const float most = 0x1p38f;
    ASSERT_EQ(most + 10'000, most);
    World world{with({{"population_size", 1000u}, {"island_width_px", 9000.0}}), base::Seed{9}};
    world.advance_tick(executor);
    ASSERT_EQ(world.alive_count(), 1000u);
    WorldState state = world.state(executor);
    for (auto& organism : state.islands[0].organisms) {
        organism.health = most;
    }
    const auto restored = again(world, state, executor);
    ASSERT_TRUE(restored) << to_text(restored.error());
    EXPECT_EQ(restored->islands()[0].live_statistics().health_mean, most);
}

} // namespace
} // namespace evod::simulation
