// Each view option draws exactly what it should, at the right place.
//
// Draws the snapshot of a test server off the screen, under Xvfb.
#include "client/viewer/panes/window_renderer.h"
#include "client/viewer/shell/window.h"
#include "tests/support/waiting.h"
#include "tests/system/viewer/support/expected_frame.h"
#include "tests/system/viewer/support/known_snapshot.h"
#include "tests/system/viewer/support/pixels.h"
#include "tests/system/viewer/support/playing_server.h"

#include <SFML/Window/Context.hpp>
#include <gtest/gtest.h>

#include <cmath>

namespace evod::viewer {
namespace {

constexpr unsigned window_width = 1280, window_height = 720;

struct IslandViewTest : testing::Test {
    IslandViewTest() {
        Options options;
        options.connection.server = core::parse_endpoint(server.address()).value();
        options.world = "default";
        panes.emplace(wanted_of(options));
    }

    sf::Image draw() {
        return renderer.capture(*panes,
                                {.width_pixels = window_width, .height_pixels = window_height, .now = Clock::now()});
    }
    /// Draws until the condition holds, and once more.
    template <class Condition>
    sf::Image draw_when(Condition condition) {
        EXPECT_TRUE(wait_until(condition, [this] {
            panes->update(Clock::now());
            draw();
            take_a_nap();
        }));
        return draw();
    }
    sf::Image draw_with_population() {
        return draw_when([&] { return island_view().population() != nullptr; });
    }
    ViewedWorld& world() { return panes->focused().world; }
    IslandView& island_view() { return panes->focused().island_view; }
    Camera& camera() { return panes->focused().camera(); }

    Colour at(const sf::Image& image, Point world) {
        const Point pixel = camera().to_screen(world);
        return pixel_at(image, static_cast<unsigned>(pixel.x), static_cast<unsigned>(pixel.y));
    }
    /// Expects organisms in these colours; the pixels of the legend are open.
    void expect_colours(const sf::Image& image, const std::vector<Colour>& colours) {
        ExpectedFrame expected{snapshot, camera_of(snapshot.about, window_width, window_height), colours};
        expected.leave_open({0, 480, 260, 240});
        for (const Colour colour : colours) {
            EXPECT_GT(expected.count(colour), 10u);
        }
        const auto mismatch = expected.compare(image);
        EXPECT_EQ(mismatch.count, 0u) << mismatch.first;
    }

    using Clock = WindowRenderer::Clock;
    const codec::ReceivedSnapshot snapshot = codec::decode_plain(known_snapshot()).value();
    PlayingServer server{known_snapshot()};
    std::optional<Panes> panes; // destroyed before the server, which waits for the disconnection
    sf::Context context{context_settings(), 1, 1};
    WindowRenderer renderer;
};

TEST_F(IslandViewTest, DrawsNothingExtraWithoutOptions) {
    const sf::Image image = draw_when([&] { return world().feed.snapshot() != nullptr; });
    const auto mismatch =
        ExpectedFrame{snapshot, camera_of(snapshot.about, window_width, window_height)}.compare(image);
    EXPECT_EQ(mismatch.count, 0u) << mismatch.first;
}

TEST_F(IslandViewTest, EveryOrganismHasTheColourOfItsHealth) {
    for (const palette::Ramp ramp : palette::ramps) {
        island_view().options.colour_by = ColourBy::Health;
        island_view().options.ramp = ramp;
        const sf::Image image = draw_when([&] { return world().feed.snapshot() != nullptr; });
        std::vector<Colour> colours; // the greatest health is 100, where the ramp ends
        for (const std::uint32_t steps : snapshot.entities->organisms.height) {
            colours.push_back(palette::at(ramp, std::round(codec::px_of(steps) / 100.0 * 255) / 255));
        }
        expect_colours(image, colours);
    }
}

TEST_F(IslandViewTest, EveryOrganismHasTheColourOfItsGene) {
    island_view().options.colour_by = ColourBy::Gene;
    island_view().options.gene = 1;
    const sf::Image image = draw_with_population();
    std::vector<Colour> colours; // the gene is 100 + id, and ids are 0 to 9
    for (const std::uint32_t id : snapshot.entities->organisms.id) {
        colours.push_back(palette::at(palette::Ramp::Viridis, std::round(id / 9.0 * 255) / 255));
    }
    expect_colours(image, colours);
}

TEST_F(IslandViewTest, EveryOrganismHasTheColourOfItsFamily) {
    island_view().options.colour_by = ColourBy::Lineage;
    const sf::Image image = draw_with_population();
    std::vector<Colour> colours; // founders are 0, 1, 2, 0, …: families of four, three and three
    for (const std::uint32_t id : snapshot.entities->organisms.id) {
        colours.push_back(palette::kinds[id % 3]);
    }
    expect_colours(image, colours);
}

TEST_F(IslandViewTest, ForceLinesLeadToTheTargets) {
    const sf::Image before = draw_when([&] { return world().feed.snapshot() != nullptr; });
    EXPECT_EQ(count(before, palette::seeks), 0u);
    island_view().options.forces = true;
    const sf::Image image = draw_with_population();
    EXPECT_GT(count(image, palette::seeks), 100u);
    // Organism 9 at (790, 590) has its target at (9, 18): a line across the island, one pixel wide.
    const auto near_line = [&](double share) {
        unsigned found = 0;
        for (int step = -3; step <= 3; ++step) {
            found += at(image, {790 + (9 - 790) * share, 590 + (18 - 590) * share + step}) !=
                     at(before, {790 + (9 - 790) * share, 590 + (18 - 590) * share + step});
        }
        return found > 0;
    };
    for (const double share : {0.15, 0.3, 0.45, 0.6, 0.75, 0.9}) {
        EXPECT_TRUE(near_line(share)) << share;
    }
}

TEST_F(IslandViewTest, RadiiAreRingsOfTheGenesSize) {
    const sf::Image before = draw_when([&] { return world().feed.snapshot() != nullptr; });
    island_view().options.radii = true;
    const sf::Image image = draw_with_population();
    // Organism 4 at (500, 300.5) perceives food up to 104 px away; nothing else is drawn inside.
    for (const auto& [x, y] : {std::pair{1.0, 0.0}, {0.0, -1.0}, {-0.6, 0.8}}) {
        const auto changed = [&, x = x, y = y](double distance) {
            const Point place{500 + x * distance, 300.5 + y * distance};
            return at(image, place) != at(before, place);
        };
        EXPECT_FALSE(changed(90));
        EXPECT_TRUE(changed(103) || changed(103.5) || changed(104) || changed(104.5)) << x << " " << y;
        EXPECT_FALSE(changed(112));
    }
}

TEST_F(IslandViewTest, DrawsTheMinimapWhenPartIsOutOfSight) {
    draw_when([&] { return world().feed.snapshot() != nullptr; });
    camera().zoom_at(camera().viewport().centre(), 4);
    const MinimapPlace place = minimap_place(camera().viewport(), 800, 600);
    const auto pixel = [&](const sf::Image& image, Point screen) {
        return pixel_at(image, static_cast<unsigned>(screen.x), static_cast<unsigned>(screen.y));
    };
    draw(); // a window of widgets gets its position in the first frame
    const sf::Image image = draw();
    EXPECT_EQ(pixel(image, {place.screen.left + 60, place.screen.top + 10}), palette::strip);
    island_view().options.minimap = false;
    EXPECT_NE(pixel(draw(), {place.screen.left + 60, place.screen.top + 10}), palette::strip);
}

TEST_F(IslandViewTest, AClickSelectsAndHighlightsAnOrganism) {
    draw_when([&] { return world().feed.snapshot() != nullptr; });
    const auto click = [&](Point place) {
        renderer.select(panes->focused(), renderer.organism_drawn_at(panes->focused(), camera().to_screen(place)));
    };
    click({502, 300});
    EXPECT_EQ(world().feed.selected(), 4u);
    EXPECT_GT(count(draw(), palette::selected), 20u);
    click({400, 50});
    EXPECT_EQ(world().feed.selected(), std::nullopt);
}

} // namespace
} // namespace evod::viewer
