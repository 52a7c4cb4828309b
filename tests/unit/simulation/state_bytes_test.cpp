#include "server/simulation/state_bytes.h"

#include <gtest/gtest.h>

#include <string>
#include <vector>

namespace evod::simulation {
namespace {

std::string bytes_of(const WorldState& state) {
    std::string bytes;
    write_state(state, [&](std::string_view piece) { bytes += piece; });
    EXPECT_EQ(bytes.size(), bytes_of_state(state));
    return bytes;
}

/// Two islands with everything that a state can contain, at the end of a generation.
WorldState full_state() {
    WorldState state{.moment = {}, .parameters = {}, .islands = {}, .ended = {}};
    state.islands.resize(2);
    IslandState& first = state.islands[0];
    first.life_records = {.lived_ticks = {0, 7},
                          .cause = {CauseOfDeath::Alive, CauseOfDeath::Starved},
                          .food_eaten = {1, 2},
                          .poison_eaten = {3, 4}};
    first.counts = {.food_eaten = 9, .poison_eaten = 8, .starved_count = 1, .poisoned_count = 0, .too_fast_count = 6};
    first.placed = {{.genes = {1, 2, 3, 4, 5, 6}, .tick = 5}};
    first.placed_food = 2;
    first.organisms.resize(2);
    first.organisms[0] = {.x = 1, .y = 2, .velocity_x = 3, .velocity_y = 4, .health = 5};
    first.headings = {0.5F, 0};
    first.crates = {{.x = 6, .y = 7, .velocity_x = -1, .velocity_y = 0}};
    first.food.resize(3);
    first.food[1].x = 77;
    first.poison.resize(1);
    state.islands[1].life_records.begin_generation(1);
    state.ratings = {{{1.5, -2}, {7, 8, 9, 10, 11, 12, 1, 2, 3, 4, 5, 6}}, {}};
    state.ended = {{.generation = 7, .island = 0, .fitness_best = -0.5}, {.generation = 7, .island = 1}};
    state.ended[0].genes[2].mean = 0.25;
    return state;
}

std::vector<IslandShape> shapes_of_full_state() {
    return {{.organisms = 1, .has_bodies = true, .has_headings = true, .crates = 1, .food = 1, .poison = 1},
            {.organisms = 1, .has_bodies = false}};
}

TEST(StateBytes, AreReadAgain) {
    const WorldState state = full_state();
    const std::string bytes = bytes_of(state);
    WorldState again;
    const auto read = read_state(bytes, shapes_of_full_state(), again);
    ASSERT_TRUE(read) << base::to_text(read.error());
    EXPECT_EQ(again.islands, state.islands);
    EXPECT_EQ(again.ratings, state.ratings);
    ASSERT_EQ(again.ended.size(), 2u);
    EXPECT_EQ(again.ended[0].fitness_best, -0.5);
    EXPECT_EQ(again.ended[0].genes[2].mean, 0.25);
    EXPECT_TRUE(check_state_size(bytes.size(), shapes_of_full_state()));
    EXPECT_FALSE(check_state_size(10, shapes_of_full_state()));
    for (std::size_t size = 0; size < bytes.size(); ++size) {
        EXPECT_FALSE(read_state(std::string_view{bytes}.substr(0, size), shapes_of_full_state(), again));
    }
}

TEST(StateBytes, AreThoseOfOldRunFiles) {
    // FNV-1a. Run files contain these bytes: another number means that old checkpoints cannot be read.
    std::uint64_t hash = 0xcbf29ce484222325;
    for (const char byte : bytes_of(full_state())) {
        hash = (hash ^ static_cast<unsigned char>(byte)) * 0x100000001b3;
    }
    EXPECT_EQ(hash, 0x19cdc048f4ff08deU);
}

TEST(StateBytes, RefuseImpossibleFitnessFromClients) {
    const std::vector<IslandShape> shapes(2, {.organisms = 3, .has_bodies = false});
    const auto columns = [](std::uint32_t first, std::uint32_t second, std::size_t fitness_bytes) {
        std::string bytes{static_cast<char>(4)};
        for (const std::uint32_t count : {first, 0u, second, 0u}) { // numbers and repaired genes of each island
            bytes.append(reinterpret_cast<const char*>(&count), sizeof count);
        }
        constexpr std::size_t island_bytes = 40 + 3 * 13; // counts and fates
        return bytes + std::string(fitness_bytes + 2 * island_bytes, '\0');
    };
    WorldState state;
    EXPECT_TRUE(read_state(columns(3, 1, 32), shapes, state));
    EXPECT_FALSE(read_state(columns(3, 1, 24), shapes, state)) << "a number is missing";
    EXPECT_FALSE(read_state(columns(3 * 16 + 1, 0, 392), shapes, state)) << "more numbers than organisms can have";
    EXPECT_FALSE(read_state(std::string_view{columns(3, 1, 32)}.substr(0, 6), shapes, state)) << "cut off";
    EXPECT_FALSE(read_state("\x08", shapes, state)) << "an unknown flag";
}

} // namespace
} // namespace evod::simulation
