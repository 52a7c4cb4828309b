// Each view option draws exactly what it should, at the right place.
//
// Draws the snapshot of a test server off the screen, under Xvfb.
#include "client/viewer/shell/window.h"
#include "client/viewer/view/window_renderer.h"
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
        view.emplace(wanted_of(options), default_options({Skin::Classic}));
    }

    sf::Image draw() {
        return renderer.capture(*view,
                                {.width_pixels = window_width, .height_pixels = window_height, .now = Clock::now()});
    }
    /// Draws until the condition holds, and once more.
    template <class Condition>
    sf::Image draw_when(Condition condition) {
        EXPECT_TRUE(wait_until(condition, [this] {
            view->world.update(Clock::now());
            draw();
            take_a_nap();
        }));
        return draw();
    }
    sf::Image draw_with_population() {
        return draw_when([&] { return view->island_data.population() != nullptr; });
    }
    ViewedWorld& world() { return view->world; }
    IslandView& island_view() { return view->island_view; }
    Camera& camera() { return view->camera(); }

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
    std::optional<WorldView> view; // destroyed before the server, which waits for the disconnection
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
        colours.push_back(palette::at(palette::Ramp::Violet, std::round(id / 9.0 * 255) / 255));
    }
    expect_colours(image, colours);
}

TEST_F(IslandViewTest, ForceLinesLeadToTheTargets) {
    const sf::Image before = draw_when([&] { return world().feed.snapshot() != nullptr; });
    EXPECT_EQ(count(before, palette::seeks), 0u);
    island_view().options.forces = Which::All;
    const sf::Image image = draw_with_population();
    EXPECT_GT(count(image, palette::seeks), 30u);
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
    island_view().options.radii = Which::All;
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
    const sf::Image with = draw();
    island_view().options.minimap = false;
    const sf::Image without = draw();
    unsigned changed = 0;
    for (double y = 0; y < place.screen.height; ++y) {
        for (double x = 0; x < place.screen.width; ++x) {
            const Point point{place.screen.left + x, place.screen.top + y};
            changed += pixel(with, point) != pixel(without, point);
        }
    }
    EXPECT_GT(changed, 500u);
}

TEST_F(IslandViewTest, AClickSelectsAndHighlightsAnOrganism) {
    draw_when([&] { return world().feed.snapshot() != nullptr; });
    const auto click = [&](Point place) {
        renderer.select(*view, renderer.organism_drawn_at(*view, camera().to_screen(place)));
    };
    click({502, 300});
    EXPECT_EQ(world().feed.selected(), 4u);
    EXPECT_GT(count(draw(), palette::selected), 20u);
    click({400, 50});
    EXPECT_EQ(world().feed.selected(), std::nullopt);
}

// ---- the vivid skin --------------------------------------------------------------------------------------------

struct VividTest : IslandViewTest {
    VividTest() { island_view().options = default_options({}); }
    const palette::IslandColours& colours = palette::of({});
    sf::Image draw_snapshot() {
        return draw_when([&] { return world().feed.snapshot() != nullptr; });
    }
    /// The place at a distance from another, in pixels, clockwise from the top in turns.
    Point around(Point world, double pixels, double turns) {
        const double angle = 2 * std::acos(-1) * turns, px = pixels / camera().zoom();
        return {world.x + px * std::sin(angle), world.y - px * std::cos(angle)};
    }
};

TEST_F(VividTest, FoodIsALeafAndPoisonIsAStar) {
    const sf::Image image = draw_snapshot();
    const double radius = snapshot.about.item_radius_px() * camera().zoom();
    const Point food{640, 200}, poison{700, 100};
    EXPECT_NE(at(image, around(food, 1.4 * radius, 0.125)), colours.ground) << "the tip at the upper right";
    EXPECT_EQ(at(image, around(food, 0.6 * radius, 0.375)), colours.food) << "beside the vein";
    EXPECT_EQ(at(image, around(food, 1.4 * radius, 0.375)), colours.ground) << "no tip at the lower right";
    for (const double turns : {0.125, 0.375, 0.625, 0.875}) {
        EXPECT_EQ(at(image, around(poison, 1.2 * radius, turns)), colours.poison) << turns;
        EXPECT_EQ(at(image, around(poison, 1.5 * radius, turns + 0.125)), colours.ground) << turns;
    }
}

TEST_F(VividTest, TheArcShowsTheHealth) {
    const sf::Image image = draw_snapshot();
    const Point organism{300.3, 450}; // number 3: radius 20 px, health 63.2 of 100
    const double ring = 20 * camera().zoom() + 1.1 * styles_of({}).organism.edge_pixels;
    for (const double turns : {0.05, 0.3, 0.55}) {
        EXPECT_EQ(at(image, around(organism, ring, turns)), colours.arc) << turns;
    }
    for (const double turns : {0.7, 0.95}) {
        EXPECT_NE(at(image, around(organism, ring, turns)), colours.arc) << turns;
    }
}

TEST_F(VividTest, GeneColoursAreExactAtTheCentre) {
    island_view().options.colour_by = ColourBy::Gene;
    island_view().options.gene = 1; // 100 + id, and ids are 0 to 9
    const sf::Image image = draw_with_population();
    for (const std::size_t i : {0, 1}) {
        const codec::Entities& all = snapshot.entities->organisms;
        const Colour expected = palette::at(palette::Ramp::Violet, std::round(all.id[i] / 9.0 * 255) / 255);
        const Colour is = at(image, {all.x_px(i), all.y_px(i)});
        EXPECT_NEAR(is.red, expected.red, 2);
        EXPECT_NEAR(is.green, expected.green, 2);
        EXPECT_NEAR(is.blue, expected.blue, 2);
    }
}

TEST_F(VividTest, RadiiAreDrawnOfTheSelectedOrganismOnly) {
    draw_snapshot();
    world().feed.select(4);
    const sf::Image image = draw_with_population();
    const auto ring_at = [&](Point organism, double radius_px) {
        unsigned changed = 0;
        for (double px = radius_px - 2; px <= radius_px + 2; px += 0.5) {
            changed += at(image, {organism.x - px, organism.y}) != colours.ground;
        }
        return changed > 0;
    };
    EXPECT_TRUE(ring_at({500, 300.5}, 104));
    EXPECT_FALSE(ring_at({300.3, 450}, 103)) << "of organism 3";
}

TEST_F(VividTest, TheSidebarShowsTheMarksOfTheSkin) {
    const auto sidebar_has = [&](Colour colour) {
        const sf::Image image = renderer.capture(
            *view,
            {.width_pixels = window_width, .height_pixels = window_height, .now = Clock::now(), .interactive = true});
        unsigned found = 0;
        for (unsigned y = 0; y < 200; ++y) {
            for (unsigned x = window_width - 390; x < window_width; ++x) {
                found += pixel_at(image, x, y) == colour;
            }
        }
        return found > 10;
    };
    draw_snapshot();
    sidebar_has(colours.food); // widgets get their places in the first frame
    for (const Look look : {Look{}, Look{Skin::Vivid, Background::Light}, Look{Skin::Classic}}) {
        island_view().options = default_options(look);
        const palette::IslandColours& of = palette::of(look);
        for (const Colour colour : {of.ground, of.food, of.poison, of.arc}) {
            EXPECT_TRUE(sidebar_has(colour));
        }
    }
}

} // namespace
} // namespace evod::viewer
