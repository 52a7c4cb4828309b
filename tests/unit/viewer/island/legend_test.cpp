#include "client/viewer/island/legend.h"

#include "tests/unit/codec/px_column.h"

#include <gtest/gtest.h>

namespace evod::viewer {
namespace {

codec::ReceivedSnapshot snapshot_with_health(float health) {
    codec::ReceivedSnapshot snapshot;
    const codec::Column one = codec::px_column({1});
    snapshot.entities = codec::snapshot_with({{0}, one, one, one, codec::px_column({health})});
    return snapshot;
}

TEST(Legend, IsEmptyWithoutAColouring) {
    EXPECT_TRUE(legend_of(IslandView{}, snapshot_with_health(80), std::nullopt, 1).empty());
}

TEST(Legend, ShowsTheScaleOfHealth) {
    IslandView view;
    view.options.colour_by = ColourBy::Health;
    const Legend legend = legend_of(view, snapshot_with_health(180), std::nullopt, 1);
    ASSERT_TRUE(legend.ramp);
    EXPECT_EQ(legend.ramp->title, "health, points");
    EXPECT_EQ(legend.ramp->scale.high, 200);
}

TEST(Legend, ShowsTheScaleOfDrawnDensities) {
    IslandView view;
    view.options.colour_by = ColourBy::Health;
    const ColourScale density{palette::Ramp::Viridis, 0, 50};
    const Legend legend = legend_of(view, snapshot_with_health(80), density, 64);
    ASSERT_TRUE(legend.ramp);
    EXPECT_EQ(legend.ramp->title, "organisms in 64 × 64 px");
    EXPECT_EQ(legend.ramp->scale.high, 50);
}

TEST(Legend, ExplainsNothingThatNeedsAMissingPopulation) {
    IslandView view;
    view.options.colour_by = ColourBy::Gene;
    view.options.radii = view.options.forces = Which::All;
    EXPECT_TRUE(legend_of(view, snapshot_with_health(80), std::nullopt, 1).empty());
}

TEST(Legend, ExplainsRadiiOnlyIfTheyAreShownOfAll) {
    IslandView view;
    EXPECT_EQ(view.options.radii, Which::Pointed);
    EXPECT_TRUE(legend_of(view, snapshot_with_health(80), std::nullopt, 1).empty());
}

TEST(Legend, NamesGenesWithTheirUnits) {
    EXPECT_EQ(gene_title("food_radius"), "food_radius, px");
    EXPECT_EQ(gene_title("impulse"), "impulse, gene units");
    EXPECT_EQ(gene_title("hidden3<food_bearing"), "hidden3<food_bearing") << "weights have no unit";
}

TEST(Legend, ExplainsPredatorsWhereThereAreAny) {
    codec::ReceivedSnapshot snapshot = snapshot_with_health(80);
    codec::QuantisedSnapshot entities = *snapshot.entities;
    entities.organisms.species = {1};
    snapshot.entities = std::make_shared<codec::QuantisedSnapshot>(entities);
    const Legend legend = legend_of(IslandView{}, snapshot, std::nullopt, 1);
    ASSERT_EQ(legend.entries.size(), 1u);
    EXPECT_EQ(legend.entries[0].text, "predator");
}

} // namespace
} // namespace evod::viewer
