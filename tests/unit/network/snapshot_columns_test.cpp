#include "server/network/snapshot_columns.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <span>
#include <vector>

namespace evod::network {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

struct Organism {
    std::uint32_t id;
    std::int32_t x, y;
    float radius_px, health;
};

void lay(std::initializer_list<Organism> organisms, runtime::OrganismsSnapshot& to) {
    to = {};
    for (const Organism& organism : organisms) {
        to.id.push_back(organism.id);
        to.x.push_back(organism.x);
        to.y.push_back(organism.y);
        to.radius_px.push_back(organism.radius_px);
        to.health.push_back(organism.health);
        to.alive_count += organism.x != physics::elsewhere;
    }
}

template <class T>
std::vector<T> listed(std::span<const T> column) {
    return {column.begin(), column.end()};
}

constexpr std::int32_t away = physics::elsewhere;

TEST(SnapshotColumns, OrganismsComeInOrderOfIdAndTheDeadDoNot) {
    runtime::IslandSnapshot island;
    lay({{7, 70, 71, 7.5F, 77.F},
         {0, away, away, 0, -1},
         {2, 20, 21, 2.5F, 22.F},
         {0, 1, 2, 0.5F, 3.F},
         {9, away, away, 0, -1}},
        island.organisms);
    SnapshotColumns columns;
    const wire::OrganismColumns organisms = columns.of(island).organisms;
    EXPECT_THAT(listed(organisms.id), ElementsAre(0, 2, 7));
    EXPECT_THAT(listed(organisms.x), ElementsAre(1, 20, 70));
    EXPECT_THAT(listed(organisms.y), ElementsAre(2, 21, 71));
    EXPECT_THAT(listed(organisms.radius_px), ElementsAre(0.5F, 2.5F, 7.5F));
    EXPECT_THAT(listed(organisms.health), ElementsAre(3.F, 22.F, 77.F));
}

TEST(SnapshotColumns, ItemsThatAreAwayAreLeftOut) {
    runtime::IslandSnapshot island;
    island.food.all = {{1, 2, 0}, {3, 4, 9}, {5, 6, 0}, {7, 8, 1}};
    island.food.present_count = 2;
    island.poison.all = {{1, 1, 5}};
    SnapshotColumns columns;
    const wire::IslandColumns told = columns.of(island);
    EXPECT_THAT(listed(told.food.id), ElementsAre(0, 2));
    EXPECT_THAT(listed(told.food.x), ElementsAre(1, 5));
    EXPECT_THAT(listed(told.food.y), ElementsAre(2, 6));
    EXPECT_THAT(listed(told.poison.id), IsEmpty());
}

TEST(SnapshotColumns, NothingIsLeftOfThePictureBefore) {
    runtime::IslandSnapshot island;
    SnapshotColumns columns;
    lay({{5, 50, 51, 1, 1}, {1, 10, 11, 1, 1}, {3, 30, 31, 1, 1}}, island.organisms);
    island.food.all = {{1, 2, 0}, {3, 4, 0}};
    island.food.present_count = 2;
    EXPECT_THAT(listed(columns.of(island).organisms.id), ElementsAre(1, 3, 5));
    lay({{2, 20, 21, 1, 1}}, island.organisms);
    island.food.present_count = 0;
    island.food.all[0].due_tick = island.food.all[1].due_tick = 4;
    const wire::IslandColumns told = columns.of(island);
    EXPECT_THAT(listed(told.organisms.id), ElementsAre(2));
    EXPECT_THAT(listed(told.organisms.x), ElementsAre(20));
    EXPECT_THAT(listed(told.food.id), IsEmpty());
    lay({}, island.organisms);
    EXPECT_THAT(listed(columns.of(island).organisms.id), IsEmpty());
}

TEST(SnapshotColumns, CratesAndObstaclesAreToldApart) {
    runtime::IslandSnapshot island;
    island.width_px = 300;
    island.height_px = 200;
    island.boxes = {.x = {1, 2, 3}, .y = {4, 5, 6}, .half_width_px = {1, 2, 3}, .half_height_px = {4, 5, 6}};
    island.crate_count = 2;
    SnapshotColumns columns;
    const wire::IslandColumns told = columns.of(island);
    EXPECT_EQ(told.width_px, 300);
    EXPECT_EQ(told.height_px, 200);
    EXPECT_EQ(1 << told.position_fraction_bits, physics::units_per_px);
    EXPECT_THAT(listed(told.crates.x), ElementsAre(1, 2));
    EXPECT_THAT(listed(told.obstacles.half_height_px), ElementsAre(6.F));
}

} // namespace
} // namespace evod::network
