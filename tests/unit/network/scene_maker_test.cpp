#include "server/network/scene_maker.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <initializer_list>

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

constexpr std::int32_t away = physics::elsewhere;

constexpr std::int32_t step = physics::units_per_px / 16; // that pictures tell

TEST(SceneMaker, OrganismsComeInOrderOfIdAndTheDeadDoNot) {
    runtime::IslandSnapshot island;
    lay({{7, 70 * step, 71 * step, 7.5F, 77.F},
         {0, away, away, 0, -1},
         {2, 20 * step, 21 * step, 2.5F, 22.F},
         {0, 1 * step, 2 * step, 0.5F, 3.F},
         {9, away, away, 0, -1}},
        island.organisms);
    const wire::Entities organisms = SceneMaker{}.scene_of(island).organisms;
    EXPECT_THAT(organisms.id, ElementsAre(0, 2, 7));
    EXPECT_THAT(organisms.x, ElementsAre(1, 20, 70));
    EXPECT_THAT(organisms.y, ElementsAre(2, 21, 71));
    EXPECT_THAT(organisms.width, ElementsAre(8, 40, 120));
    EXPECT_THAT(organisms.height, ElementsAre(48, 352, 1232));
}

TEST(SceneMaker, ItemsThatAreAwayAreLeftOut) {
    runtime::IslandSnapshot island;
    island.food.all = {{1 * step, 2 * step, 0}, {3, 4, 9}, {5 * step, 6 * step, 0}, {7, 8, 1}};
    island.food.present_count = 2;
    island.poison.all = {{1, 1, 5}};
    const wire::Scene scene = SceneMaker{}.scene_of(island);
    EXPECT_THAT(scene.food.id, ElementsAre(0, 2));
    EXPECT_THAT(scene.food.x, ElementsAre(1, 5));
    EXPECT_THAT(scene.food.y, ElementsAre(2, 6));
    EXPECT_THAT(scene.food.width, IsEmpty());
    EXPECT_THAT(scene.poison.id, IsEmpty());
}

TEST(SceneMaker, NothingIsLeftOfThePictureBefore) {
    runtime::IslandSnapshot island;
    SceneMaker maker;
    lay({{5, 50, 51, 1, 1}, {1, 10, 11, 1, 1}, {3, 30, 31, 1, 1}}, island.organisms);
    island.food.all = {{1, 2, 0}, {3, 4, 0}};
    island.food.present_count = 2;
    EXPECT_THAT(maker.scene_of(island).organisms.id, ElementsAre(1, 3, 5));
    lay({{2, 20 * step, 21 * step, 1, 1}}, island.organisms);
    island.food.present_count = 0;
    island.food.all[0].due_tick = island.food.all[1].due_tick = 4;
    const wire::Scene scene = maker.scene_of(island);
    EXPECT_THAT(scene.organisms.id, ElementsAre(2));
    EXPECT_THAT(scene.organisms.x, ElementsAre(20));
    EXPECT_THAT(scene.food.id, IsEmpty());
    lay({}, island.organisms);
    EXPECT_THAT(maker.scene_of(island).organisms.id, IsEmpty());
}

TEST(SceneMaker, CratesAndObstaclesAreToldApart) {
    runtime::IslandSnapshot island;
    island.boxes = {.x = {1 * step, 2 * step, 3 * step},
                    .y = {4 * step, 5 * step, 6 * step},
                    .half_width_px = {1, 2, 3},
                    .half_height_px = {4, 5, 6}};
    island.crate_count = 2;
    const wire::Scene scene = SceneMaker{}.scene_of(island);
    EXPECT_THAT(scene.crates.x, ElementsAre(1, 2));
    EXPECT_THAT(scene.crates.id, IsEmpty());
    EXPECT_THAT(scene.obstacles.y, ElementsAre(6));
    EXPECT_THAT(scene.obstacles.height, ElementsAre(96));
}

TEST(SceneMaker, PositionsTakeFourBytesWhereTwoCannotCountTheIsland) {
    runtime::IslandSnapshot island;
    island.width_px = 4095.9375;
    EXPECT_EQ(SceneMaker{}.scene_of(island).position_bytes, 2U);
    island.width_px = 286'000;
    lay({{1, 285'999 * physics::units_per_px, 0, 1, 1}}, island.organisms);
    const wire::Scene scene = SceneMaker{}.scene_of(island);
    EXPECT_EQ(scene.position_bytes, 4U);
    EXPECT_THAT(scene.organisms.x, ElementsAre(16 * 285'999));
}

} // namespace
} // namespace evod::network
