#include "server/streaming/quantise.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <initializer_list>

namespace evod::streaming {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

struct Organism {
    std::uint32_t id;
    std::int32_t x, y;
    float radius_px, health;
};

constexpr std::int32_t step = physics::units_per_px / 16; // of a snapshot

/// Organisms in this order in memory; `born` ids exist.
runtime::OrganismsSnapshot lying(std::uint32_t born, std::initializer_list<Organism> organisms) {
    runtime::OrganismsSnapshot to;
    to.place_of.assign(born, simulation::Island::no_body);
    for (const Organism& organism : organisms) {
        if (organism.x != physics::void_position) {
            to.place_of[organism.id] = static_cast<std::uint32_t>(to.x.size());
        }
        to.x.push_back(organism.x);
        to.y.push_back(organism.y);
        to.radius_px.push_back(organism.radius_px);
        to.health.push_back(organism.health);
        to.alive_count += organism.x != physics::void_position;
    }
    return to;
}

TEST(Quantise, LivingOrganismsAreSortedById) {
    constexpr std::int32_t away = physics::void_position;
    runtime::IslandSnapshot island;
    island.organisms = lying(11, {{7, 70 * step, 71 * step, 7.5F, 77.F},
                                  {3, away, away, 0, -1},
                                  {2, 20 * step, 21 * step, 2.5F, 22.F},
                                  {0, 1 * step, 2 * step, 0.5F, 3.F},
                                  {9, away, away, 0, -1}});
    const codec::Entities organisms = quantise(island).organisms;
    EXPECT_THAT(organisms.id, ElementsAre(0, 2, 7));
    EXPECT_THAT(organisms.x, ElementsAre(1, 20, 70));
    EXPECT_THAT(organisms.y, ElementsAre(2, 21, 71));
    EXPECT_THAT(organisms.width, ElementsAre(8, 40, 120));
    EXPECT_THAT(organisms.height, ElementsAre(48, 352, 1232));
    island.organisms = lying(11, {});
    EXPECT_THAT(quantise(island).organisms.id, IsEmpty());
}

TEST(Quantise, HeadingsAreKeptOnlyIfWanted) {
    constexpr std::int32_t away = physics::void_position;
    runtime::IslandSnapshot island;
    island.organisms = lying(5, {{4, step, step, 1, 1}, {3, away, away, 0, -1}, {0, step, step, 1, 1}});
    constexpr OptionalColumns with{.headings = true};
    EXPECT_THAT(quantise(island, with).organisms.heading, IsEmpty()) << "of a world without headings";
    island.organisms.heading.assign({1.5707964F, 9.F, -0.1F});
    EXPECT_THAT(quantise(island).organisms.heading, IsEmpty());
    EXPECT_THAT(quantise(island, with).organisms.heading, ElementsAre(252, 64));
}

TEST(Quantise, SpeciesOfTheLivingAreKeptOnlyIfWanted) {
    constexpr std::int32_t away = physics::void_position;
    constexpr OptionalColumns with{.species = true};
    constexpr auto prey = simulation::Species::Prey, predator = simulation::Species::Predator;
    runtime::IslandSnapshot island;
    island.organisms = lying(4, {{3, step, step, 1, 1}, {1, away, away, 0, -1}, {0, step, step, 1, 1}});
    EXPECT_THAT(quantise(island, with).organisms.species, IsEmpty()) << "of a world without predators";
    island.organisms.species = {prey, prey, prey, predator};
    EXPECT_THAT(quantise(island).organisms.species, IsEmpty());
    EXPECT_THAT(quantise(island, with).organisms.species, ElementsAre(0, 1));
}

TEST(Quantise, AbsentItemsAreOmitted) {
    runtime::IslandSnapshot island;
    island.food.all = {{1 * step, 2 * step, 0}, {3, 4, 9}, {5 * step, 6 * step, 0}, {7, 8, 1}};
    island.food.present_count = 2;
    island.poison.all = {{1, 1, 5}};
    const codec::QuantisedSnapshot snapshot = quantise(island);
    EXPECT_THAT(snapshot.food.id, ElementsAre(0, 2));
    EXPECT_THAT(snapshot.food.x, ElementsAre(1, 5));
    EXPECT_THAT(snapshot.food.y, ElementsAre(2, 6));
    EXPECT_THAT(snapshot.food.width, IsEmpty());
    EXPECT_THAT(snapshot.poison.id, IsEmpty());
}

TEST(Quantise, CratesAndObstaclesAreSeparated) {
    runtime::IslandSnapshot island;
    island.boxes = {.x = {1 * step, 2 * step, 3 * step},
                    .y = {4 * step, 5 * step, 6 * step},
                    .half_width_px = {1, 2, 3},
                    .half_height_px = {4, 5, 6}};
    island.crate_count = 2;
    const codec::QuantisedSnapshot snapshot = quantise(island);
    EXPECT_THAT(snapshot.crates.x, ElementsAre(1, 2));
    EXPECT_THAT(snapshot.crates.id, IsEmpty());
    EXPECT_THAT(snapshot.obstacles.y, ElementsAre(6));
    EXPECT_THAT(snapshot.obstacles.height, ElementsAre(96));
}

TEST(Quantise, WideIslandsNeedFourBytePositions) {
    runtime::IslandSnapshot island;
    island.width_px = 4095.9375;
    EXPECT_EQ(quantise(island).position_bytes, 2U);
    island.width_px = 286'000;
    island.organisms = lying(2, {{1, 285'999 * physics::units_per_px, 0, 1, 1}});
    const codec::QuantisedSnapshot snapshot = quantise(island);
    EXPECT_EQ(snapshot.position_bytes, 4U);
    EXPECT_THAT(snapshot.organisms.x, ElementsAre(16 * 285'999));
}

} // namespace
} // namespace evod::streaming
