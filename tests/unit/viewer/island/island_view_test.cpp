#include "client/viewer/island/island_view.h"

#include <gmock/gmock.h>

namespace evod::viewer {
namespace {

TEST(IslandView, TheClassicSkinAddsNothingByDefault) {
    const ViewOptions classic = default_options({Skin::Classic});
    EXPECT_FALSE(classic.trails || classic.flashes);
    EXPECT_EQ(classic.radii, Which::None);
    EXPECT_EQ(classic.forces, Which::None);
    const ViewOptions vivid = default_options({Skin::Vivid, Background::Light});
    EXPECT_EQ(vivid.look, (Look{Skin::Vivid, Background::Light}));
    EXPECT_EQ(default_options({}), ViewOptions{});
}

TEST(IslandView, CyclesThroughTheColourings) {
    IslandView island_view;
    std::vector<ColourBy> seen;
    for (int i = 0; i < 4; ++i) {
        island_view.next_colouring();
        seen.push_back(island_view.options.colour_by);
    }
    EXPECT_THAT(seen, testing::ElementsAre(ColourBy::Health, ColourBy::Nothing, ColourBy::Health, ColourBy::Nothing))
        << "genes only once they are known";
}

} // namespace
} // namespace evod::viewer
