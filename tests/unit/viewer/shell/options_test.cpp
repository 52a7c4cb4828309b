#include "client/viewer/shell/options.h"

#include <gtest/gtest.h>

#include <vector>

namespace evod::viewer {
namespace {

std::variant<Options, int> parse(std::vector<const char*> arguments) {
    arguments.insert(arguments.begin(), "evoview");
    return parse_options(static_cast<int>(arguments.size()), arguments.data());
}

Options parsed(std::vector<const char*> arguments) {
    const auto options = parse(std::move(arguments));
    EXPECT_TRUE(std::holds_alternative<Options>(options));
    return std::holds_alternative<Options>(options) ? std::get<Options>(options) : Options{};
}

TEST(ViewerOptions, OpenAWindowByDefault) {
    const Options options = parsed({"--server", "lab.example:7744"});
    EXPECT_EQ(options.connection.server, (core::Endpoint{"lab.example", 7744}));
    EXPECT_FALSE(options.screenshot || options.record || options.script || options.size);
}

TEST(ViewerOptions, ContainTheWantedWorld) {
    const Options options = parsed({"--world", "one", "--island", "2", "--all-islands", "--past", "12"});
    const WantedWorld wanted = wanted_of(options, 60);
    EXPECT_EQ(wanted.world, "one");
    EXPECT_EQ(wanted.island, 2u);
    EXPECT_TRUE(wanted.all_islands);
    EXPECT_EQ(wanted.replay_generation, 12u);
    EXPECT_EQ(wanted.rate_hz, 60);
}

TEST(ViewerOptions, SizeIsInPixelsOrFollowsTheScale) {
    const Options::Size given = size_of(parsed({"--size", "640x400"}), 2);
    EXPECT_EQ(given.width, 640u);
    EXPECT_EQ(given.height, 400u);
    const Options::Size scaled = size_of(parsed({}), 2);
    EXPECT_EQ(scaled.width, 2560u);
    EXPECT_EQ(scaled.height, 1440u);
}

TEST(ViewerOptions, ScreenshotsAndRecordingsShareTheTimeout) {
    const Options shot = parsed({"--screenshot", "a.png", "--at-tick", "600", "--timeout", "5"});
    ASSERT_TRUE(shot.screenshot);
    EXPECT_EQ(shot.screenshot->path, "a.png");
    EXPECT_EQ(shot.screenshot->tick, 600u);
    EXPECT_EQ(shot.screenshot->timeout_s, 5);
    const Options recording = parsed({"--record", "film.mp4", "--every", "10", "--timeout", "5"});
    ASSERT_TRUE(recording.record);
    EXPECT_EQ(recording.record->every_ticks, 10u);
    EXPECT_EQ(recording.record->timeout_s, 5);
}

TEST(ViewerOptions, ContainTheLook) {
    EXPECT_EQ(view_of(parsed({})), ViewOptions{}) << "vivid and dark";
    EXPECT_EQ(view_of(parsed({"--skin", "classic"})), default_options({Skin::Classic}));
    EXPECT_EQ(view_of(parsed({"--background", "light"})).look, (Look{Skin::Vivid, Background::Light}));
}

TEST(ViewerOptions, RefuseInvalidValuesAndCombinations) {
    const std::vector<std::vector<const char*>> invalid{{"--size", "12by4"},
                                                        {"--size", "1280x9999999"},
                                                        {"--timeout", "5"},
                                                        {"--skin", "neon"},
                                                        {"--background", "blue"},
                                                        {"--skin", "classic", "--background", "dark"},
                                                        {"--at-tick", "5"},
                                                        {"--past", "0"},
                                                        {"--screenshot", "a.png", "--record", "b.mp4"},
                                                        {"--script", "/no/such/script"}};
    for (const auto& arguments : invalid) {
        const auto options = parse(arguments);
        ASSERT_TRUE(std::holds_alternative<int>(options)) << arguments.front();
        EXPECT_EQ(std::get<int>(options), 2) << arguments.front();
    }
}

} // namespace
} // namespace evod::viewer
