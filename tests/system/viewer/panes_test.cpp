// evoview with more than one thing to be seen: the past of a world, two worlds side by side, all islands of one. What
// is drawn in each place is what the server says.
//
// Runs under Xvfb.
#include "client/viewer/drawing/window_layout.h"
#include "client/viewer/stage/timeline.h"
#include "client/viewer/watch/past.h"
#include "tests/system/viewer/support/expected_picture.h"
#include "tests/system/viewer/support/past_of_world.h"
#include "tests/system/viewer/support/person.h"

#include <gtest/gtest.h>

#include <fstream>

namespace evod::viewer {
namespace {

/// Nobody has touched what is seen in `viewport`.
Camera camera_in(Rectangle viewport, const evod::v1::SnapshotFrame& picture) {
    Camera camera;
    camera.set_viewport(viewport);
    camera.set_island(picture.width_px(), picture.height_px());
    return camera;
}

void expect_shown(const codec::DecodedSnapshot& picture, Rectangle viewport, const sf::Image& image) {
    const ExpectedPicture expected{picture, camera_in(viewport, picture.about)};
    EXPECT_GT(expected.count(palette::organism), 100u);
    const auto mismatch = expected.compare(image);
    EXPECT_EQ(mismatch.count, 0u) << picture.about.world() << " " << mismatch.first;
}

struct PanesTest : testing::Test {
    TemporaryFolder folder;
    RealServer server{{"--seed", "7", "--data", folder.file("data")}};
    std::string path = folder.file("picture.png");

    sf::Image screenshot(const std::string& arguments) {
        const Ran ran = run_evoview("--server " + server.address() + " " + arguments + " --screenshot " + path);
        EXPECT_EQ(ran.status, 0) << ran.output;
        sf::Image image;
        EXPECT_TRUE(image.loadFromFile(path));
        return image;
    }
};

TEST_F(PanesTest, TwoWorldsAreDrawnInTheirHalves) {
    make_world(server, "one", 130, 3);
    make_world(server, "other", 75, 8);
    const sf::Image image = screenshot("--world one --beside other");
    const auto halves = side_by_side({0, 0, 1280, 720}, 2);
    expect_shown(*picture_of(server, "one"), viewport_of(halves[0]), image);
    expect_shown(*picture_of(server, "other"), viewport_of(halves[1]), image);
}

TEST_F(PanesTest, AllIslandsAreDrawnAsTiles) {
    make_world(server, "one", 130, 3, 5);
    sf::Image image = screenshot("--world one --all-islands");
    const auto first = picture_of(server, "one");
    const auto places = in_tiles(viewport_of(1280, 720), 5, first->about.width_px() / first->about.height_px());
    for (std::uint32_t island = 0; island < 5; ++island) {
        const Rectangle place = places[island];
        for (unsigned y = 0; y < 24; ++y) { // the name of the island stands above its wall
            for (unsigned x = 0; x < 80; ++x) {
                image.setPixel(static_cast<unsigned>(place.left) + x, static_cast<unsigned>(place.top) + y,
                               sf::Color{palette::background.red, palette::background.green, palette::background.blue});
            }
        }
        expect_shown(*picture_of(server, "one", island), place, image);
    }
}

TEST_F(PanesTest, APastIsShownAsItWas) {
    make_world(server, "one", 421);
    const auto past = past_picture_of(server, "one", at_generation(2));
    EXPECT_EQ(past->about.tick(), 120u);
    expect_shown(*past, viewport_of(1280, 720), screenshot("--world one --past 2"));
    const Ran ran =
        run_evoview("--server " + server.address() + " --world one --past 99 --screenshot " + folder.file("none.png"));
    EXPECT_EQ(ran.status, 1);
    EXPECT_NE(ran.output.find("99"), std::string::npos) << ran.output;
}

TEST_F(PanesTest, AScriptGoesToAGenerationOfThePast) {
    make_world(server, "one", 421);
    std::ofstream{folder.file("script")} << R"(wait picture
wait widget Present
set generation 2
wait generation 2
key F8
set Generation 1
quit
)";
    const Ran ran =
        run_evoview("--server " + server.address() + " --world one --past 1 --script " + folder.file("script"));
    EXPECT_EQ(ran.status, 0) << ran.output;
}

/// At a window of 800 × 500 with the past of a world.
struct TimelineTest : PanesTest {
    TimelineTest() {
        make_world(server, "one", 421);
        evoview.emplace(EVOVIEW,
                        std::vector<std::string>{"--server", server.address(), "--world", "one", "--size", "800x500"});
        EXPECT_TRUE(person.finds_window());
        EXPECT_TRUE(person.sees(palette::organism));
        person.press(XK_p);
        EXPECT_TRUE(person.sees(palette::past)) << "the mark of the past, and the line";
    }

    /// Where the island is seen above the time line.
    static Rectangle viewport() {
        const Rectangle below = below_panel_strip(800, 500);
        return viewport_of({below.left, below.top, below.width, below.height - Timeline::height_pixels});
    }

    bool shows(const codec::DecodedSnapshot& picture, Rectangle place) {
        const ExpectedPicture expected{picture, camera_in(place, picture.about)};
        return Person::looks_until([&] {
            const sf::Image seen = person.looks();
            return seen.getSize() == sf::Vector2u{800, 500} && expected.compare(seen).count == 0;
        });
    }

    bool shows_now(Colour colour) {
        const sf::Image seen = person.looks();
        return seen.getSize().x == 0 || count(seen, colour) > 0; // or else nobody knows
    }

    std::optional<Process> evoview;
    Person person;
};

TEST_F(TimelineTest, KeysGoFromGenerationToGenerationAndBackToThePresent) {
    EXPECT_TRUE(shows(*past_picture_of(server, "one", at_tick(421)), viewport())) << "begins with what was shown";
    person.press(XK_bracketleft);
    person.press(XK_bracketleft);
    EXPECT_TRUE(shows(*past_picture_of(server, "one", at_generation(2)), viewport()));
    person.press(XK_bracketright);
    EXPECT_TRUE(shows(*past_picture_of(server, "one", at_generation(3)), viewport()));
    person.press(XK_period);
    EXPECT_TRUE(shows(*past_picture_of(server, "one", at_tick(241)), viewport()));
    person.press(XK_p);
    EXPECT_TRUE(shows(*picture_of(server, "one"), viewport_of(below_panel_strip(800, 500))))
        << "the present, without a time line";
    person.press(XK_q);
    EXPECT_EQ(evoview->wait(), 0);
}

TEST_F(TimelineTest, TheLineIsDraggedToAnyTick) {
    EXPECT_TRUE(shows(*past_picture_of(server, "one", at_tick(421)), viewport()));
    const TimeScale line{.first_tick = 0, .last_tick = 421, .left = 18, .width = 764};
    const int y = 500 - static_cast<int>(Timeline::height_pixels) + 18;
    const int from = 700, to = 300;
    ASSERT_TRUE(Person::looks_until([&] {
        person.move_mouse(from, y);
        return shows_now(palette::focus);
    })) << "it is under the mouse";
    person.press_mouse(from, y);
    EXPECT_TRUE(shows(*past_picture_of(server, "one", at_tick(line.tick_at(from))), viewport()));
    for (int x = from; x >= to; x -= 10) {
        person.move_mouse(x, y);
    }
    EXPECT_TRUE(shows(*past_picture_of(server, "one", at_tick(line.tick_at(to))), viewport()));
    person.release_mouse(to, y);
    person.move_mouse(400, 5); // keys are for the line as long as it is held
    EXPECT_TRUE(Person::looks_until([&] { return !shows_now(palette::focus); }));
    person.press(XK_q);
    EXPECT_EQ(evoview->wait(), 0);
}

} // namespace
} // namespace evod::viewer
