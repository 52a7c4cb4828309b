#include "client/viewer/island/island_renderer.h"

#include "tests/unit/codec/px_column.h"

#include <gtest/gtest.h>

namespace evod::viewer {
namespace {

struct IslandRendererTest : testing::Test {
    IslandRendererTest() {
        camera.set_viewport({0, 0, 1024, 1024});
        camera.set_island(1000, 1000); // one pixel per px
        organisms.x = codec::px_column({100, 112, 600});
        organisms.y = codec::px_column({100, 100, 600});
        organisms.width = codec::px_column({10, 10, 20});
    }
    std::optional<std::size_t> at(double x, double y) {
        return organism_at(camera.to_screen({x, y}), {.entities = &organisms}, camera);
    }
    Camera camera;
    codec::Entities organisms;
};

TEST_F(IslandRendererTest, FindsTheOrganismUnderTheMouse) {
    EXPECT_EQ(at(600, 619), 2u);
    EXPECT_EQ(at(300, 300), std::nullopt);
}

TEST_F(IslandRendererTest, OfOverlappingOrganismsTheNearestCentreIsHit) {
    EXPECT_EQ(at(105, 100), 0u);
    EXPECT_EQ(at(107, 100), 1u);
}

TEST_F(IslandRendererTest, ThreePixelsBesideIsAHitAtAnyZoom) {
    EXPECT_EQ(at(600, 622.9), 2u);
    EXPECT_EQ(at(600, 623.1), std::nullopt);
    camera.zoom_at(camera.to_screen({600, 600}), 10);
    EXPECT_EQ(at(600, 620.29), 2u);
    EXPECT_EQ(at(600, 620.31), std::nullopt);
}

TEST_F(IslandRendererTest, ASmallOrganismHasATargetOf24Pixels) {
    organisms.width = codec::px_column({2, 2, 20});
    EXPECT_EQ(at(100, 111.9), 0u);
    EXPECT_EQ(at(100, 112.1), std::nullopt);
    EXPECT_EQ(at(107, 100), 1u) << "of two targets, the nearest edge";
    camera.set_viewport({0, 0, 2048, 2048}, 2); // two pixels per px
    EXPECT_EQ(at(100, 111.9), 0u) << "at scale 2";
    EXPECT_EQ(at(100, 112.1), std::nullopt);
}

TEST_F(IslandRendererTest, APointInsideALargeOrganismHitsIt) {
    organisms.x = codec::px_column({100, 145, 600});
    organisms.width = codec::px_column({40, 2, 20});
    EXPECT_EQ(at(136, 100), 0u) << "9 px beside a small organism, but inside the large one";
    EXPECT_EQ(at(142, 100), 1u);
}

TEST_F(IslandRendererTest, NothingIsFoundUnderTheStripsOfText) {
    camera.set_viewport({0, 40, 1024, 900});
    EXPECT_EQ(organism_at({512, 20}, {.entities = &organisms}, camera), std::nullopt);
}

TEST(Labels, AreDrawnOnlyWhereTheyAreReadable) {
    Camera camera;
    camera.set_viewport({0, 0, 1280, 650});
    camera.set_island(1280, 720);
    EXPECT_TRUE(labels_are_readable(camera, 50, 0.45));
    EXPECT_FALSE(labels_are_readable(camera, 10'000, 0.45));
    EXPECT_FALSE(labels_are_readable(camera, 50, 1.4)) << "the organisms are small";
    camera.set_viewport({0, 0, 1280, 650}, 3);
    EXPECT_FALSE(labels_are_readable(camera, 50, 0.45)) << "the numbers are large";
    camera.set_island(20'000, 20'000);
    EXPECT_FALSE(labels_are_readable(camera, 1, 0.45));
}

TEST(Labels, RoundHealthUpSoThatTheLivingNeverShowZero) {
    EXPECT_EQ(shown_health(0.01f), 1u);
    EXPECT_EQ(shown_health(99), 99u);
    EXPECT_EQ(shown_health(99.5f), 100u);
    EXPECT_EQ(shown_health(0), 0u);
}

} // namespace
} // namespace evod::viewer
