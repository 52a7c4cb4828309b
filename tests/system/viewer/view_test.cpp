// evoview with replays and all islands of a world: each part of the frame matches the
// server's snapshot.
//
// Runs under Xvfb.
#include "client/viewer/drawing/window_layout.h"
#include "client/viewer/view/timeline.h"
#include "client/viewer/view/timeline_layout.h"
#include "tests/system/viewer/support/expected_frame.h"
#include "tests/system/viewer/support/person.h"
#include "tests/system/viewer/support/replay_of_world.h"

#include <gtest/gtest.h>

#include <fstream>

namespace evod::viewer {
namespace {

/// The camera of a new view.
Camera camera_in(Rectangle viewport, const evod::v1::SnapshotFrame& snapshot) {
    Camera camera;
    camera.set_viewport(viewport);
    camera.set_island(snapshot.width_px(), snapshot.height_px());
    return camera;
}

void expect_shown(const codec::ReceivedSnapshot& snapshot, Rectangle viewport, const sf::Image& image) {
    const ExpectedFrame expected{snapshot, camera_in(viewport, snapshot.about)};
    EXPECT_GT(expected.count(palette::organism), 100u);
    const auto mismatch = expected.compare(image);
    EXPECT_EQ(mismatch.count, 0u) << snapshot.about.world() << " " << mismatch.first;
}

struct ViewTest : testing::Test {
    TemporaryFolder folder;
    RealServer server{{"--seed", "7", "--data", folder.file("data")}};
    std::string path = folder.file("frame.png");

    sf::Image screenshot(const std::string& arguments) {
        const Ran ran = run_evoview("--server " + server.address() + " --size 1680x720 --skin classic " + arguments +
                                    " --screenshot " + path);
        EXPECT_EQ(ran.status, 0) << ran.output;
        sf::Image image;
        EXPECT_TRUE(image.loadFromFile(path));
        return image;
    }
};

TEST_F(ViewTest, DrawsAllIslandsAsTiles) {
    make_world(server, "one", 130, 3, 5);
    sf::Image image = screenshot("--world one --all-islands");
    const auto first = snapshot_of(server, "one");
    const Colour outside = palette::of({Skin::Classic}).outside;
    const auto places = in_tiles(viewport_of(1280, 720), 5, first->about.width_px() / first->about.height_px());
    for (std::uint32_t island = 0; island < 5; ++island) {
        const Rectangle place = places[island];
        for (unsigned y = 0; y < 24; ++y) { // the label of the island is above its wall
            for (unsigned x = 0; x < 80; ++x) {
                image.setPixel(static_cast<unsigned>(place.left) + x, static_cast<unsigned>(place.top) + y,
                               sf::Color{outside.red, outside.green, outside.blue});
            }
        }
        expect_shown(*snapshot_of(server, "one", island), place, image);
    }
}

TEST_F(ViewTest, AReplayShowsTheWorldAsItWas) {
    make_world(server, "one", 421);
    const auto past = replay_snapshot_of(server, "one", at_generation(2));
    EXPECT_EQ(past->about.tick(), 120u);
    const auto height = 720 - static_cast<unsigned>(Timeline::height_pixels);
    expect_shown(*past, viewport_of(1280, height), screenshot("--world one --past 2"));
    const Ran ran =
        run_evoview("--server " + server.address() + " --world one --past 99 --screenshot " + folder.file("none.png"));
    EXPECT_EQ(ran.status, 1);
    EXPECT_NE(ran.output.find("99"), std::string::npos) << ran.output;
}

TEST_F(ViewTest, AScriptSeeksAGenerationOfAReplay) {
    make_world(server, "one", 421);
    std::ofstream{folder.file("script")} << R"(wait snapshot
wait widget "Time line/Live"
set generation 2
wait generation 2
quit
)";
    const Ran ran =
        run_evoview("--server " + server.address() + " --world one --past 1 --script " + folder.file("script"));
    EXPECT_EQ(ran.status, 0) << ran.output;
}

/// A window of 800 × 500 that shows a replay of a world.
struct TimelineTest : ViewTest {
    TimelineTest() {
        make_world(server, "one", 421);
        evoview.emplace(EVOVIEW, std::vector<std::string>{"--server", server.address(), "--world", "one", "--size",
                                                          "800x500", "--skin", "classic"});
        EXPECT_TRUE(person.finds_window());
        EXPECT_TRUE(person.sees(palette::organism));
        person.press(XK_F12); // collapses the sidebar
        person.press(XK_p);
        EXPECT_TRUE(person.sees(palette::replay)) << "the label of the replay, and the time line";
    }

    /// The part of the window beside the collapsed sidebar.
    static constexpr Rectangle beside{0, 0, 800 - sidebar_collapsed, 500};
    /// The viewport above the time line.
    static Rectangle viewport() {
        return viewport_of({beside.left, beside.top, beside.width, beside.height - Timeline::height_pixels});
    }

    bool shows(const codec::ReceivedSnapshot& snapshot, Rectangle place) {
        const ExpectedFrame expected{snapshot, camera_in(place, snapshot.about)};
        return Person::looks_until([&] {
            const sf::Image seen = person.looks();
            return seen.getSize() == sf::Vector2u{800, 500} && expected.compare(seen).count == 0;
        });
    }

    bool shows_now(Colour colour) {
        const sf::Image seen = person.looks();
        return seen.getSize().x == 0 || count(seen, colour) > 0; // else the pixels could not be read
    }

    std::optional<Process> evoview;
    Person person;
};

TEST_F(TimelineTest, KeysSeekGenerationsAndReturnToTheLiveWorld) {
    EXPECT_TRUE(shows(*replay_snapshot_of(server, "one", at_tick(421)), viewport())) << "begins at the shown tick";
    person.press(XK_bracketleft);
    person.press(XK_bracketleft);
    EXPECT_TRUE(shows(*replay_snapshot_of(server, "one", at_generation(2)), viewport()));
    person.press(XK_bracketright);
    EXPECT_TRUE(shows(*replay_snapshot_of(server, "one", at_generation(3)), viewport()));
    person.press(XK_period);
    EXPECT_TRUE(shows(*replay_snapshot_of(server, "one", at_tick(241)), viewport()));
    person.press(XK_p);
    EXPECT_TRUE(shows(*snapshot_of(server, "one"), viewport_of(beside))) << "the live world, without a time line";
    person.press(XK_q);
    EXPECT_EQ(evoview->wait(), 0);
}

TEST_F(TimelineTest, DraggingTheLineSeeksAnyTick) {
    EXPECT_TRUE(shows(*replay_snapshot_of(server, "one", at_tick(421)), viewport()));
    const TimeScale line{.first_tick = 0, .last_tick = 421, .left = 18, .width = 764 - sidebar_collapsed};
    const int y = 500 - static_cast<int>(Timeline::height_pixels) + 18;
    const int from = 700, to = 300;
    ASSERT_TRUE(Person::looks_until([&] {
        person.move_mouse(from, y);
        return shows_now(palette::focus);
    })) << "the line is under the mouse";
    person.press_mouse(from, y);
    EXPECT_TRUE(shows(*replay_snapshot_of(server, "one", at_tick(line.tick_at(from))), viewport()));
    for (int x = from; x >= to; x -= 10) {
        person.move_mouse(x, y);
    }
    EXPECT_TRUE(shows(*replay_snapshot_of(server, "one", at_tick(line.tick_at(to))), viewport()));
    person.release_mouse(to, y);
    person.move_mouse(400, 5); // the line uses the keyboard while it is dragged
    EXPECT_TRUE(Person::looks_until([&] { return !shows_now(palette::focus); }));
    person.press(XK_q);
    EXPECT_EQ(evoview->wait(), 0);
}

} // namespace
} // namespace evod::viewer
