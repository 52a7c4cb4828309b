#include "client/viewer/island/flashes.h"

#include "tests/unit/codec/px_column.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace evod::viewer {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

/// An island with organisms 1 and 2, food 5 and 6, and poison 5.
struct FlashesTest : testing::Test {
    FlashesTest() {
        entities.organisms = {{1, 2},
                              codec::px_column({100, 200}),
                              codec::px_column({10, 20}),
                              codec::px_column({8, 9}),
                              codec::px_column({50, 60})};
        entities.food = {{5, 6}, codec::px_column({300, 400}), codec::px_column({30, 40}), {}, {}};
        entities.poison = {{5}, codec::px_column({500}), codec::px_column({50}), {}, {}};
        about.set_width_px(1'000);
        about.set_height_px(1'000);
        about.set_item_radius_px(4);
        about.set_generation(1);
    }
    void show(double s) {
        auto snapshot = std::make_shared<codec::ReceivedSnapshot>();
        about.set_simulated_s(s);
        about.set_tick(static_cast<std::uint64_t>(s * 60));
        snapshot->about = about;
        snapshot->entities = std::make_shared<const codec::QuantisedSnapshot>(entities);
        snapshot->tiles = tiles;
        flashes.add(snapshot);
    }
    std::vector<Flash::Kind> kinds() const {
        std::vector<Flash::Kind> kinds;
        for (const Flash& flash : flashes.all()) {
            kinds.push_back(flash.kind);
        }
        return kinds;
    }
    static void remove(codec::Entities& all, std::size_t i) {
        for (codec::Column* column : {&all.id, &all.x, &all.y, &all.width, &all.height}) {
            if (!column->empty()) {
                column->erase(column->begin() + static_cast<std::ptrdiff_t>(i));
            }
        }
    }

    codec::QuantisedSnapshot entities;
    evod::v1::SnapshotFrame about;
    std::vector<codec::DecodedTile> tiles;
    Flashes flashes;
};

TEST_F(FlashesTest, AreMealsAndDeaths) {
    show(1);
    EXPECT_THAT(kinds(), IsEmpty());
    remove(entities.organisms, 1);
    remove(entities.food, 0);
    remove(entities.poison, 0);
    show(1.1);
    EXPECT_THAT(kinds(), ElementsAre(Flash::Kind::Death, Flash::Kind::Food, Flash::Kind::Poison));
    const Flash& death = flashes.all()[0];
    EXPECT_EQ(death.x_px, 200);
    EXPECT_EQ(death.y_px, 20);
    EXPECT_EQ(death.radius_px, 9);
    EXPECT_EQ(death.began_s, 1.1);
    EXPECT_EQ(flashes.all()[1].x_px, 300);
    EXPECT_EQ(flashes.all()[1].radius_px, 4);
}

TEST_F(FlashesTest, MovedOrganismsAndNewItemsAreNone) {
    show(1);
    entities.organisms.x = codec::px_column({110, 210});
    entities.food.id.push_back(7);
    entities.food.x.push_back(codec::steps_of(600));
    entities.food.y.push_back(codec::steps_of(60));
    show(1.1);
    EXPECT_THAT(kinds(), IsEmpty());
}

TEST_F(FlashesTest, AnItemAtAnotherPlaceWasEaten) {
    show(1);
    entities.food.x[1] = codec::steps_of(700);
    show(1.1);
    EXPECT_THAT(kinds(), ElementsAre(Flash::Kind::Food));
    EXPECT_EQ(flashes.all()[0].x_px, 400) << "where it was";
}

TEST_F(FlashesTest, EndAfterAShortSimulatedTime) {
    show(1);
    remove(entities.food, 0);
    show(1.25);
    show(1.25 + Flashes::shown_s);
    EXPECT_THAT(kinds(), ElementsAre(Flash::Kind::Food));
    show(1.25 + Flashes::shown_s + 0.1);
    EXPECT_THAT(kinds(), IsEmpty());
}

TEST_F(FlashesTest, SnapshotsFarApartAreNotCompared) {
    show(1);
    remove(entities.food, 0);
    show(1 + 2 * Flashes::compared_s_max);
    EXPECT_THAT(kinds(), IsEmpty());
}

TEST_F(FlashesTest, AnotherGenerationRunOrEarlierTickClears) {
    const auto flash_once = [&] {
        show(1);
        entities.food.x[0] += 160;
        show(1.1);
        EXPECT_THAT(kinds(), ElementsAre(Flash::Kind::Food));
    };
    flash_once();
    about.set_generation(2);
    remove(entities.organisms, 0);
    show(1.2);
    EXPECT_THAT(kinds(), IsEmpty()) << "the organisms of the generation before did not die";
    flash_once();
    about.set_run_id("other");
    show(1.2);
    EXPECT_THAT(kinds(), IsEmpty());
    flash_once();
    show(0.5);
    EXPECT_THAT(kinds(), IsEmpty());
}

TEST_F(FlashesTest, NothingFlashesAtTheBorderOfAStreamedRegion) {
    about.set_tile_px(512);
    tiles.resize(1);
    tiles[0].detail = evod::v1::DETAIL_FULL; // the left upper quarter
    entities.food.x = codec::px_column({300, 450});
    show(1);
    remove(entities.food, 0);
    remove(entities.food, 0);
    show(1.1);
    ASSERT_THAT(kinds(), ElementsAre(Flash::Kind::Food));
    EXPECT_EQ(flashes.all()[0].x_px, 300) << "the other item may have left the region";
}

} // namespace
} // namespace evod::viewer
