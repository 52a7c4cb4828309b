#include "client/viewer/island/marks.h"

#include "tests/unit/codec/px_column.h"
#include "tests/unit/viewer/world/population_pages.h"

#include <gmock/gmock.h>

#include <algorithm>
#include <numeric>
#include <utility>

namespace evod::viewer {

bool operator==(const Shape& a, const Shape& b) {
    return a.x == b.x && a.y == b.y && a.half_width == b.half_width && a.half_height == b.half_height;
}
bool operator==(const Line& a, const Line& b) {
    return a.x == b.x && a.y == b.y && a.end_x == b.end_x && a.end_y == b.end_y;
}

namespace {

using testing::ElementsAre;
using testing::IsEmpty;

constexpr palette::Ramp ramp = palette::Ramp::Viridis;

struct MarksTest : testing::Test {
    MarksTest() {
        organisms.id = {0, 2, 9}; // 9 is not in the population
        organisms.x = codec::px_column({100, 200, 300});
        organisms.y = codec::px_column({10, 20, 30});
        organisms.width = codec::px_column({10, 11, 12});
        organisms.height = codec::px_column({0, 50, 200});
        add_discs({.entities = &organisms}, discs);
        EXPECT_EQ(population.add(page_of(0, 3, 3)), std::nullopt);
    }
    codec::Entities organisms;
    std::vector<Shape> discs;
    Population population{2};
    const Rectangle everything{0, 0, 1000, 1000};
};

TEST_F(MarksTest, HeadingsCrossTheEdgesOfVisibleOrganisms) {
    organisms.heading = {0, 64, 128};
    std::vector<Line> lines;
    add_headings({.entities = &organisms}, discs, {0, 0, 1000, 25}, 5.5f, lines);
    ASSERT_EQ(lines.size(), 3u) << "the third one reaches into the visible part";
    const Shape& first = discs[0];
    EXPECT_FLOAT_EQ(lines[0].x, first.x + 3.5f);
    EXPECT_FLOAT_EQ(lines[0].end_x, first.x + 15.5f);
    EXPECT_FLOAT_EQ(lines[0].end_y, first.y);
    EXPECT_NEAR(lines[1].end_x, discs[1].x, 1e-4);
    EXPECT_FLOAT_EQ(lines[1].end_y, discs[1].y + 16.5f) << "y grows downward";
    EXPECT_FLOAT_EQ(lines[2].end_x, discs[2].x - 17.5f);
    lines.clear();
    add_headings({.entities = &organisms}, discs, {500, 500, 10, 10}, 5.5f, lines);
    EXPECT_TRUE(lines.empty());
}

TEST_F(MarksTest, HealthScalesFromZeroToTheRoundedMaximum) {
    const ColourScale scale = health_scale(organisms, ramp);
    EXPECT_EQ(scale.low, 0);
    EXPECT_EQ(scale.high, 200);
    std::vector<Colour> colours;
    add_health_colours(organisms, scale, colours);
    ASSERT_EQ(colours.size(), 3u);
    EXPECT_EQ(colours[0], palette::at(ramp, 0));
    EXPECT_EQ(colours[1], palette::at(ramp, 64.0 / 255)); // a quarter, to 1/255
    EXPECT_EQ(colours[2], palette::at(ramp, 1));
    organisms.height = codec::px_column({1, 2, 3});
    EXPECT_EQ(health_scale(organisms, ramp).high, 100) << "low health is not shown as high";
}

TEST_F(MarksTest, AGeneScalesFromItsMinimumToItsMaximum) {
    std::vector<Colour> colours;
    const ColourScale scale = gene_scale(population, 1, ramp);
    EXPECT_EQ(scale.low, 100);
    EXPECT_EQ(scale.high, 102);
    add_gene_colours(organisms, population, 1, scale, colours);
    EXPECT_THAT(colours, ElementsAre(palette::at(ramp, 0), palette::at(ramp, 1), palette::unknown));
    const ColourScale all_equal{ramp, 5, 5};
    EXPECT_EQ(all_equal(5), palette::at(ramp, 0.5));
}

TEST_F(MarksTest, DiscsHaveTheRadiiOfTheOrganisms) {
    EXPECT_THAT(discs, ElementsAre(Shape{100, 10, 10, 10}, Shape{200, 20, 11, 11}, Shape{300, 30, 12, 12}));
}

TEST_F(MarksTest, BodiesHaveTheirShareOfTheGreatestHealth) {
    set_health(organisms, 200, discs);
    EXPECT_EQ(discs[0].half_width, 10);
    EXPECT_FLOAT_EQ(discs[0].half_height, organisms.health(0) / 200);
    set_health(organisms, 1, discs);
    EXPECT_EQ(discs[2].half_height, 1) << "at most the whole arc";
}

TEST_F(MarksTest, RadiiAreDrawnOfVisibleOrganismsOnly) {
    std::vector<Shape> shapes;
    add_radii(organisms, discs, population, 1, everything, {}, shapes);
    EXPECT_THAT(shapes, ElementsAre(Shape{100, 10, 100, 100}, Shape{200, 20, 102, 102}));
    shapes.clear();
    add_radii(organisms, discs, population, 1, {301, 0, 100, 100}, {}, shapes);
    EXPECT_THAT(shapes, ElementsAre(Shape{200, 20, 102, 102}));
    shapes.clear();
    add_radii(organisms, discs, population, 1, everything, std::vector<std::size_t>{0}, shapes);
    EXPECT_THAT(shapes, ElementsAre(Shape{100, 10, 100, 100})) << "of the chosen organism";
}

TEST_F(MarksTest, ArrowsShowForcesAndLinesShowTargets) {
    ColouredLines arrows, targets;
    add_forces(organisms, discs, population, everything, {}, palette::of({}), arrows, targets);
    EXPECT_THAT(arrows.lines, ElementsAre(Line{100, 10, 100 + arrow_px_per_force, 10},
                                          Line{200, 20, 200 + arrow_px_per_force, 20 + 2 * arrow_px_per_force}));
    EXPECT_THAT(targets.lines, ElementsAre(Line{100, 10, 0, 0}, Line{200, 20, 2, 4}));
    EXPECT_THAT(targets.colours, ElementsAre(palette::of({}).seeks, palette::of({}).seeks));

    auto page = page_of(0, 3, 3);
    *page.mutable_choices() = {evod::v1::CHOICE_WANDER, evod::v1::CHOICE_SEEK, evod::v1::CHOICE_FLEE};
    Population others{2};
    ASSERT_EQ(others.add(page), std::nullopt);
    arrows.clear();
    targets.clear();
    add_forces(organisms, discs, others, everything, {}, palette::of({}), arrows, targets);
    EXPECT_THAT(arrows.colours, ElementsAre(palette::of({}).wanders, palette::of({}).flees));
    EXPECT_THAT(targets.colours, ElementsAre(palette::of({}).flees)) << "a wandering organism has no target";
    arrows.clear();
    targets.clear();
    add_forces(organisms, discs, others, {5'000, 5'000, 10, 10}, {}, palette::of({}), arrows, targets);
    EXPECT_THAT(arrows.lines, IsEmpty());
    add_forces(organisms, discs, population, everything, std::vector<std::size_t>{1}, palette::of({}), arrows, targets);
    EXPECT_THAT(targets.lines, ElementsAre(Line{200, 20, 2, 4})) << "of the chosen organism";
}

// ---- trails ----------------------------------------------------------------------------------------------------

std::shared_ptr<codec::ReceivedSnapshot> snapshot(double s, std::uint64_t generation = 1) {
    auto made = std::make_shared<codec::ReceivedSnapshot>();
    made->about.set_simulated_s(s);
    made->about.set_tick(static_cast<std::uint64_t>(s * 60));
    made->about.set_generation(generation);
    return made;
}

TEST(Items, AShareOfThemIsSpreadOverTheIsland) {
    std::vector<Shape> all;
    for (int i = 0; i < 20'000; ++i) {
        all.push_back({static_cast<float>(i % 200) * 10.25f, static_cast<float>(i / 200) * 10.25f, 4, 4});
    }
    std::vector<Shape> kept = all;
    keep_share(1, kept);
    EXPECT_EQ(kept.size(), all.size());
    keep_share(0.25, kept);
    const auto in_part = [&](float left, float top) {
        return std::ranges::count_if(kept, [&](const Shape& item) {
            return item.x >= left && item.x < left + 512.5f && item.y >= top && item.y < top + 512.5f;
        });
    };
    for (const float left : {0.f, 512.5f, 1025.f, 1537.5f}) { // 2,500 items each; 5 standard deviations are 108
        for (const float top : {0.f, 512.5f}) {
            EXPECT_NEAR(static_cast<double>(in_part(left, top)), 625, 108) << left << " " << top;
        }
    }
    std::vector<Shape> fewer(all.begin() + 5'000, all.end()); // others have been eaten
    keep_share(0.25, fewer);
    EXPECT_TRUE(std::ranges::includes(
        kept, fewer, {},
        [](const Shape& item) {
            return std::pair{item.y, item.x};
        },
        [](const Shape& item) {
            return std::pair{item.y, item.x};
        }));
    keep_share(0, kept);
    EXPECT_TRUE(kept.empty());
}

TEST(Trails, KeepAFewSnapshotsOfTheLastSeconds) {
    Trails trails;
    for (int tick = 0; tick <= 600; ++tick) {
        trails.add(snapshot(tick / 60.0));
    }
    const auto& kept = trails.snapshots();
    EXPECT_EQ(kept.size(), 13u); // from 7 s to 10 s
    EXPECT_NEAR(kept.front()->about.simulated_s(), 7, 1e-9);
    EXPECT_NEAR(kept.back()->about.simulated_s(), 10, 1e-9);
}

TEST(Trails, RestartWithEachGeneration) {
    Trails trails;
    trails.add(snapshot(1));
    trails.add(snapshot(2));
    trails.add(snapshot(2.5, 2));
    EXPECT_EQ(trails.snapshots().size(), 1u);
    trails.add(snapshot(3, 2));
    trails.add(snapshot(1, 2)); // a replay
    EXPECT_EQ(trails.snapshots().size(), 1u);
    auto elsewhere = snapshot(1.5, 2);
    elsewhere->about.set_island(1);
    trails.add(elsewhere);
    EXPECT_EQ(trails.snapshots().size(), 1u);
}

TEST(Trails, ConnectEachOrganismWithItself) {
    codec::Entities from, to;
    from.id = {1, 2, 5, 6};
    from.x = codec::px_column({10, 20, 50, 60});
    from.y = codec::px_column({1, 2, 5, 6});
    to.id = {2, 3, 6};
    const std::vector<Shape> discs{{21, 3, 1, 1}, {31, 4, 1, 1}, {61, 7, 1, 1}};
    std::vector<Line> lines;
    add_paths(from, to, discs, lines);
    EXPECT_THAT(lines, ElementsAre(Line{20, 2, 21, 3}, Line{60, 6, 61, 7}));
}

// ---- density ---------------------------------------------------------------------------------------------------

TEST(Density, DotsAreUsedUntilTheyAreTooMany) {
    evod::v1::SnapshotFrame island;
    island.set_width_px(40'000);
    island.set_height_px(20'000);
    Camera camera;
    camera.set_viewport({0, 0, 880, 650});
    camera.set_island(40'000, 20'000);
    EXPECT_TRUE(too_small_to_see(camera));
    EXPECT_FALSE(too_many_for_dots(camera, island, 20'000));
    EXPECT_TRUE(too_many_for_dots(camera, island, 2 * dots_max)) << "for the stream";
    camera.zoom_at(camera.viewport().centre(), 4);
    EXPECT_FALSE(too_many_for_dots(camera, island, 2 * dots_max)) << "most are out of sight";
    camera.set_viewport({0, 0, 160, 100});
    camera.fit();
    EXPECT_TRUE(too_many_for_dots(camera, island, 20'000)) << "for a small tile: more than one per pixel";
}

TEST(Density, CellsAreAlignedToTheIsland) {
    codec::Entities organisms;
    organisms.x = codec::px_column({4, 12, 13, 76, 400});
    organisms.y = codec::px_column({4, 4, 5, 76, 4});
    const Positions places{.entities = &organisms};
    const DensityGrid grid = density_of(places, {0, 0, 80, 80}, 8);
    EXPECT_EQ(grid.columns, 10u);
    EXPECT_EQ(grid.rows, 10u);
    EXPECT_EQ(grid.counts[0], 1u);
    EXPECT_EQ(grid.counts[1], 2u);
    EXPECT_EQ(grid.counts[99], 1u);
    EXPECT_EQ(std::accumulate(grid.counts.begin(), grid.counts.end(), 0u), 4u) << "400 is outside";
    const DensityGrid moved = density_of(places, {11, 3, 40, 40}, 8);
    EXPECT_EQ(moved.left_px, 8);
    EXPECT_EQ(moved.top_px, 0);
    EXPECT_EQ(moved.counts[0], 2u);
}

TEST(Density, CellsAreAFewPixelsWideAtAnyZoom) {
    Camera camera;
    camera.set_viewport({0, 0, 1000, 1000});
    camera.set_island(100'000, 100'000);
    for (int i = 0; i < 40; ++i) {
        const double pixels = density_cell_px(camera, 5) * camera.zoom();
        EXPECT_GE(pixels, 5 * (1 - 1e-9));
        EXPECT_LT(pixels, 10);
        camera.zoom_at({500, 500}, 1.2);
    }
}

TEST(Density, SquaresAreColouredByTheirCounts) {
    const DensityGrid grid{.left_px = 100, .top_px = 0, .cell_px = 10, .columns = 2, .rows = 2, .counts = {0, 7, 3, 0}};
    const ColourScale scale = density_scale(std::span{&grid, 1}, ramp);
    EXPECT_EQ(scale.high, 10);
    std::vector<Shape> shapes;
    std::vector<Colour> colours;
    add_density(grid, {1'000, 14}, scale, shapes, colours); // the lower wall is at 14
    EXPECT_THAT(shapes, ElementsAre(Shape{115, 5, 5, 5}, Shape{105, 12, 5, 2}));
    EXPECT_THAT(colours, ElementsAre(palette::at(ramp, 0.7), palette::at(ramp, 0.3)));
}

TEST(Density, AnOverviewCountsEveryDetail) {
    codec::ReceivedSnapshot snapshot;
    snapshot.about.set_width_px(1024);
    snapshot.about.set_height_px(512);
    snapshot.about.set_tile_px(512);
    snapshot.entities = codec::snapshot_with({{0}, codec::px_column({10}), codec::px_column({20}), {}, {}});
    codec::DecodedTile dots, density;
    dots.detail = evod::v1::DETAIL_DOTS;
    dots.dots.organisms = {{300, 310}, {20, 20}};
    density.tile = 1;
    density.detail = evod::v1::DETAIL_DENSITY;
    density.left_px = 512;
    density.density.cells_per_side = 2;
    density.density.organisms = {1, 2, 3, 4};
    snapshot.tiles = {dots, density};
    const DensityGrid grid = overview_of(snapshot, 4);
    EXPECT_EQ(grid.columns, 4u);
    EXPECT_EQ(grid.rows, 2u);
    EXPECT_THAT(grid.counts, ElementsAre(1, 2, 1, 2, 0, 0, 3, 4));
}

} // namespace
} // namespace evod::viewer
