// What the View panel switches on is in the picture, where it belongs, and nothing else is.
//
// Draws off the screen, under Xvfb, what a server of the test's own shows.
#include "client/viewer/shell/window.h"
#include "client/viewer/stage/stage.h"
#include "tests/support/waiting.h"
#include "tests/system/viewer/support/expected_picture.h"
#include "tests/system/viewer/support/known_picture.h"
#include "tests/system/viewer/support/pixels.h"
#include "tests/system/viewer/support/playing_server.h"

#include <SFML/Window/Context.hpp>
#include <gtest/gtest.h>

#include <cmath>

namespace evod::viewer {
namespace {

constexpr unsigned window_width = 1280, window_height = 720;

struct SightTest : testing::Test {
    SightTest() {
        Options options;
        options.connection.server = core::parse_endpoint(server.address()).value();
        options.world = "default";
        panes.emplace(wanted_of(options));
    }

    sf::Image draw() {
        return stage.capture(*panes,
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
        return draw_when([&] { return sight().population() != nullptr; });
    }
    Watch& watch() { return panes->focused().watch; }
    Sight& sight() { return panes->focused().sight; }
    Camera& camera() { return panes->focused().camera(); }

    Colour at(const sf::Image& image, Point world) {
        const Point pixel = camera().to_screen(world);
        return pixel_at(image, static_cast<unsigned>(pixel.x), static_cast<unsigned>(pixel.y));
    }
    /// The picture with organisms in these colours, and room for a legend.
    void expect_colours(const sf::Image& image, const std::vector<Colour>& colours) {
        ExpectedPicture expected{picture, camera_of(picture.about, window_width, window_height), colours};
        expected.leave_open({0, 480, 260, 240});
        for (const Colour colour : colours) {
            EXPECT_GT(expected.count(colour), 10u);
        }
        const auto mismatch = expected.compare(image);
        EXPECT_EQ(mismatch.count, 0u) << mismatch.first;
    }

    using Clock = Stage::Clock;
    const codec::DecodedSnapshot picture = codec::decode(known_picture()).value();
    PlayingServer server{known_picture()};
    std::optional<Panes> panes; // gone before the server, which waits for that
    sf::Context context{context_settings(), 1, 1};
    Stage stage;
};

TEST_F(SightTest, WithoutAnySwitchNothingIsAdded) {
    const sf::Image image = draw_when([&] { return watch().picture() != nullptr; });
    const auto mismatch =
        ExpectedPicture{picture, camera_of(picture.about, window_width, window_height)}.compare(image);
    EXPECT_EQ(mismatch.count, 0u) << mismatch.first;
}

TEST_F(SightTest, EveryOrganismHasTheColourOfItsHealth) {
    for (const palette::Ramp ramp : palette::ramps) {
        sight().shown.colour_by = ColourBy::Health;
        sight().shown.ramp = ramp;
        const sf::Image image = draw_when([&] { return watch().picture() != nullptr; });
        std::vector<Colour> colours; // the healthiest has 100, at which the ramp ends
        for (const float health : picture.organisms.health) {
            colours.push_back(palette::at(ramp, std::round(health / 100.0 * 255) / 255));
        }
        expect_colours(image, colours);
    }
}

TEST_F(SightTest, EveryOrganismHasTheColourOfItsGene) {
    sight().shown.colour_by = ColourBy::Gene;
    sight().shown.gene = 1;
    const sf::Image image = draw_with_population();
    std::vector<Colour> colours; // the gene is 100 more than the id, and ids go from 0 to 9
    for (const std::uint32_t id : picture.organisms.id) {
        colours.push_back(palette::at(palette::Ramp::Viridis, std::round(id / 9.0 * 255) / 255));
    }
    expect_colours(image, colours);
}

TEST_F(SightTest, EveryOrganismHasTheColourOfItsFamily) {
    sight().shown.colour_by = ColourBy::Lineage;
    const sf::Image image = draw_with_population();
    std::vector<Colour> colours; // founders are 0, 1, 2, 0, …: four, three, three of ten
    for (const std::uint32_t id : picture.organisms.id) {
        colours.push_back(palette::kinds[id % 3]);
    }
    expect_colours(image, colours);
}

TEST_F(SightTest, ForcesLeadToWhatIsActedOn) {
    const sf::Image before = draw_when([&] { return watch().picture() != nullptr; });
    EXPECT_EQ(count(before, palette::seeks), 0u);
    sight().shown.forces = true;
    const sf::Image image = draw_with_population();
    EXPECT_GT(count(image, palette::seeks), 100u);
    // Organism 9 at (790, 590) acts on (9, 18): a line across the island, a pixel wide.
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

TEST_F(SightTest, RadiiAreRingsAsLargeAsTheGene) {
    const sf::Image before = draw_when([&] { return watch().picture() != nullptr; });
    sight().shown.radii = true;
    const sf::Image image = draw_with_population();
    // Organism 4 at (500, 300.5) sees food 104 px away; on the way there is nothing.
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

TEST_F(SightTest, TheMinimapIsThereWhereNotAllIsSeen) {
    draw_when([&] { return watch().picture() != nullptr; });
    camera().zoom_at(camera().viewport().centre(), 4);
    const MinimapPlace place = minimap_place(camera().viewport(), 800, 600);
    const auto pixel = [&](const sf::Image& image, Point screen) {
        return pixel_at(image, static_cast<unsigned>(screen.x), static_cast<unsigned>(screen.y));
    };
    draw(); // a window of widgets takes its place in the first picture
    const sf::Image image = draw();
    EXPECT_EQ(pixel(image, {place.screen.left + 60, place.screen.top + 10}), palette::strip);
    sight().shown.minimap = false;
    EXPECT_NE(pixel(draw(), {place.screen.left + 60, place.screen.top + 10}), palette::strip);
}

TEST_F(SightTest, AClickSelectsAndTheSelectedOneStandsOut) {
    draw_when([&] { return watch().picture() != nullptr; });
    stage.select_at(panes->focused(), camera().to_screen({502, 300}));
    EXPECT_EQ(watch().selected(), 4u);
    EXPECT_GT(count(draw(), palette::selected), 20u);
    stage.select_at(panes->focused(), camera().to_screen({400, 50}));
    EXPECT_EQ(watch().selected(), std::nullopt);
}

} // namespace
} // namespace evod::viewer
