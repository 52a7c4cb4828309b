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
                          .poison_eaten = {3, 4},
                          .children = {}};
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

/// Two islands of a colony with births, at the end of an interval. All organisms of the second one have died before.
WorldState colony_state() {
    WorldState state{.moment = {}, .parameters = {}, .islands = {}, .ended = {}};
    state.parameters.active.reproduction = parameters::Reproduction::Births;
    state.islands.resize(2);
    IslandState& first = state.islands[0];
    first.life_records = {.lived_ticks = {0, 7, 0},
                          .cause = {CauseOfDeath::Alive, CauseOfDeath::Eaten, CauseOfDeath::Alive},
                          .food_eaten = {1, 2, 3},
                          .poison_eaten = {3, 4, 5},
                          .children = {1, 0, 0}};
    first.placed = {{.genes = {1, 2, 3, 4, 5, 6}, .tick = 5, .parents = {0, 1}}};
    first.organisms.resize(3);
    first.organisms[2] = {.x = 1, .y = 2, .velocity_x = 3, .velocity_y = 4, .health = 5};
    first.food.resize(1);
    first.colony[1] = {.living_sum = 1ULL << 40, .first = 3, .born = 1, .eaten = 4, .old = 2};
    first.hunts_from = {0, 0, 9};
    first.latest_born[0] = {1, 2, 3, 4, 5, 6};
    state.islands[1].poison.resize(2);
    state.ended = {{.generation = 7, .island = 0, .colony = ColonyStatistics{.born_count = 3}},
                   {.generation = 7, .island = 1, .colony = ColonyStatistics{}}};
    state.ended[0].predators = {{.generation = 7, .colony = ColonyStatistics{.age_mean_s = 2.5}}};
    state.ended[0].predators[0].genes[3].max = 12;
    return state;
}

std::vector<IslandShape> shapes_of_colony_state() {
    return {{.organisms = 2, .is_colony = true, .food = 1}, {.organisms = 0, .is_colony = true, .poison = 2}};
}

TEST(StateBytes, ContainColonies) {
    const WorldState state = colony_state();
    const std::string bytes = bytes_of(state);
    WorldState again;
    const auto read = read_state(bytes, shapes_of_colony_state(), again);
    ASSERT_TRUE(read) << base::to_text(read.error());
    EXPECT_EQ(again.islands, state.islands);
    ASSERT_EQ(again.ended.size(), 2u);
    EXPECT_EQ(again.ended[0].colony, state.ended[0].colony);
    ASSERT_EQ(again.ended[0].predators.size(), 1u);
    EXPECT_EQ(again.ended[0].predators[0].colony, state.ended[0].predators[0].colony);
    EXPECT_EQ(again.ended[0].predators[0].genes[3].max, 12);
    EXPECT_TRUE(again.ended[1].predators.empty());
    EXPECT_TRUE(check_state_size(bytes.size(), shapes_of_colony_state()));
    for (std::size_t size = 0; size < bytes.size(); ++size) {
        EXPECT_FALSE(read_state(std::string_view{bytes}.substr(0, size), shapes_of_colony_state(), again));
    }
}

TEST(StateBytes, SurviveAnyChangeOfOneByte) {
    const std::string bytes = bytes_of(colony_state());
    for (std::size_t place = 0; place < bytes.size(); ++place) {
        std::string damaged = bytes;
        damaged[place] = static_cast<char>(damaged[place] ^ 0x55);
        WorldState again;
        (void)read_state(damaged, shapes_of_colony_state(), again);
    }
}

IslandOpening opening() {
    IslandOpening opening{
        .predator_count = 1, .next_number = 12, .numbers = {3, 9, 4}, .age_ticks = {60, 0, 7}, .state = {}};
    IslandState& state = opening.state;
    state.life_records.begin_generation(3);
    state.life_records.children = {2, 0, 1};
    state.organisms.resize(3);
    state.organisms[1].health = 77;
    state.headings = {1, 2, 3};
    state.crates.resize(1);
    state.food.resize(2);
    state.food[1].due_tick = 8;
    state.hunts_from = {0, 0, 5};
    state.latest_born[1] = {6, 5, 4, 3, 2, 1};
    return opening;
}

TEST(OpeningBytes, AreReadAgain) {
    const std::string bytes = bytes_of_opening(opening());
    const auto again = read_opening(bytes);
    ASSERT_TRUE(again) << base::to_text(again.error());
    EXPECT_EQ(*again, opening());
    for (std::size_t size = 0; size < bytes.size(); ++size) {
        EXPECT_FALSE(read_opening(std::string_view{bytes}.substr(0, size)));
    }
    EXPECT_FALSE(read_opening(bytes + '\0'));
    for (std::size_t place = 0; place < bytes.size(); ++place) {
        std::string damaged = bytes;
        damaged[place] = static_cast<char>(damaged[place] ^ 0xff);
        (void)read_opening(damaged);
    }
}

TEST(OpeningBytes, MayBeThoseOfAnEmptyIsland) {
    IslandOpening empty;
    empty.next_number = 7;
    empty.state.food.resize(3);
    const auto again = read_opening(bytes_of_opening(empty));
    ASSERT_TRUE(again) << base::to_text(again.error());
    EXPECT_EQ(*again, empty);
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
