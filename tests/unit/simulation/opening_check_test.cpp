#include "server/simulation/opening_check.h"

#include <gtest/gtest.h>

#include <functional>
#include <limits>

namespace evod::simulation {
namespace {

parameters::Parameters with_births() {
    parameters::Parameters parameters;
    parameters.reproduction = parameters::Reproduction::Births;
    parameters.predator_count = 1;
    parameters.crate_count = 1;
    parameters.food_count = 2;
    parameters.poison_count = 0;
    return parameters;
}

evolution::NextGeneration three_organisms() {
    evolution::NextGeneration bred;
    bred.genes.setConstant(evolution::body_gene_count, 3, 100);
    bred.predator_count = 1;
    return bred;
}

IslandOpening possible() {
    IslandOpening opening{
        .predator_count = 1, .next_number = 12, .numbers = {3, 9, 4}, .age_ticks = {60, 0, 7}, .state = {}};
    opening.state.life_records.begin_generation(3);
    opening.state.life_records.children = {2, 0, 1};
    opening.state.organisms.resize(3);
    for (IslandState::Organism& organism : opening.state.organisms) {
        organism = {.x = 4096 * 50, .y = 4096 * 60, .velocity_x = 1, .velocity_y = 2, .health = 90};
    }
    opening.state.crates = {{.x = 4096 * 90, .y = 4096 * 90}};
    opening.state.food.resize(2);
    opening.state.food[0] = {4096, 4096, 0};
    opening.state.food[1] = {4096, 4096, 12};
    opening.state.hunts_from = {0, 0, 5};
    return opening;
}

TEST(OpeningCheck, FindsWhatNoIslandHasWritten) {
    EXPECT_EQ(fault_of(possible(), three_organisms(), with_births()), nullptr);
    const std::vector<std::function<void(IslandOpening&)>> changes{
        [](auto& opening) { opening.predator_count = 2; },
        [](auto& opening) { opening.next_number = 9; },
        [](auto& opening) { opening.numbers[1] = 3; },
        [](auto& opening) { opening.numbers[2] = 3; },
        [](auto& opening) { opening.age_ticks.pop_back(); },
        [](auto& opening) { opening.state.life_records.cause[0] = CauseOfDeath::Eaten; },
        [](auto& opening) { opening.state.life_records.food_eaten[0] = 1; },
        [](auto& opening) { opening.state.life_records.children.clear(); },
        [](auto& opening) { opening.state.counts.food_eaten = 1; },
        [](auto& opening) { opening.state.colony[0].born = 1; },
        [](auto& opening) { opening.state.organisms[0].x = -1; },
        [](auto& opening) { opening.state.organisms[0].health = 0; },
        [](auto& opening) { opening.state.organisms[0].health = std::numeric_limits<float>::quiet_NaN(); },
        [](auto& opening) { opening.state.organisms[0].velocity_x = 1e9F; },
        [](auto& opening) {
            opening.state.headings = {1, 2, 3};
        },
        [](auto& opening) { opening.state.hunts_from[0] = 1; },
        [](auto& opening) { opening.state.crates.clear(); },
        [](auto& opening) { opening.state.food[0].x = 0; },
        [](auto& opening) {
            opening.state.latest_born[0] = {1, 2};
        },
        [](auto& opening) { opening.state.latest_born[1] = {60, 60, 60, 60, 60, -1}; },
    };
    for (std::size_t i = 0; i < changes.size(); ++i) {
        IslandOpening opening = possible();
        changes[i](opening);
        EXPECT_NE(fault_of(opening, three_organisms(), with_births()), nullptr) << "change " << i;
    }
}

} // namespace
} // namespace evod::simulation
