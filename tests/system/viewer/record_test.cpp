// evoview --record: the wanted frames, each of the tick in its name; afterwards a world that ran runs again.
//
// Runs under Xvfb.
#include "client/viewer/drawing/window_layout.h"
#include "client/viewer/shell/frame_writer.h"
#include "tests/system/viewer/support/expected_frame.h"
#include "tests/system/viewer/support/playing_server.h"
#include "tests/system/viewer/support/replay_of_world.h"

#include <gtest/gtest.h>

#include <fstream>
#include <tuple>

namespace evod::viewer {
namespace {

struct RecordTest : testing::Test {
    TemporaryFolder folder;
    RealServer server{{"--seed", "7", "--data", folder.file("data")}};
    std::string frames = folder.file("frames");

    Ran record(const std::string& path, const std::string& arguments) {
        return run_evoview("--server " + server.address() + " --world one --skin classic --size 640x400 --record " +
                           path + " " + arguments);
    }
    evod::v1::WorldInfo state() { return server.state("one"); }
    void expect_frame(std::size_t number, std::uint64_t tick) { expect_frame(number, tick, at_tick(tick)); }
    void expect_frame(std::size_t number, std::uint64_t tick, const evod::v1::RunMoment& moment) {
        sf::Image image;
        ASSERT_TRUE(image.loadFromFile(frames + "/" + frame_file_name(number, tick)));
        const auto snapshot = replay_snapshot_of(server, "one", moment);
        const ExpectedFrame expected{*snapshot, camera_of(snapshot->about, 640, 400)};
        EXPECT_GT(expected.count(palette::organism), 100u);
        const auto mismatch = expected.compare(image);
        EXPECT_EQ(mismatch.count, 0u) << "tick " << tick << " " << mismatch.first;
    }
    std::ptrdiff_t frame_count() const { return std::distance(std::filesystem::directory_iterator{frames}, {}); }
};

TEST_F(RecordTest, RecordsEveryTickOfAPausedWorldWhichStaysPaused) {
    make_world(server, "one", 50);
    const Ran ran = record(frames, "--record-ticks 4");
    ASSERT_EQ(ran.status, 0) << ran.output;
    EXPECT_EQ(frame_count(), 5);
    for (std::size_t i = 0; i < 5; ++i) {
        expect_frame(i, 50 + i);
    }
    EXPECT_EQ(state().tick(), 54u);
    EXPECT_EQ(state().state(), evod::v1::RUN_STATE_PAUSED);
}

TEST_F(RecordTest, ARunningWorldRunsAgainAfterTheRecording) {
    make_world(server, "one", 50);
    evod::v1::Request speed, run;
    speed.mutable_set_speed()->set_world("one");
    speed.mutable_set_speed()->mutable_speed()->set_real_time_factor(1);
    server.ask(speed);
    run.mutable_run()->set_world("one");
    server.ask(run);
    const Ran ran = record(frames, "--record-ticks 30 --every 10");
    ASSERT_EQ(ran.status, 0) << ran.output;
    EXPECT_EQ(frame_count(), 4);
    EXPECT_EQ(ran.output.find("missed"), std::string::npos) << ran.output;
    const auto before = state();
    EXPECT_FALSE(before.leased());
    EXPECT_EQ(before.state(), evod::v1::RUN_STATE_RUNNING);
    EXPECT_TRUE(wait_until([&] { return state().tick() > before.tick(); }));
}

TEST_F(RecordTest, RecordsAReplayWithoutChangingTheWorld) {
    make_world(server, "one", 300);
    const Ran ran = record(frames, "--past 2 --record-generations 1 --every 40");
    ASSERT_EQ(ran.status, 0) << ran.output;
    EXPECT_EQ(frame_count(), 4);            // ticks 120, 160, 200 and 240, the last
    expect_frame(0, 120, at_generation(2)); // a seek to tick 120 would show the end of generation 1
    expect_frame(3, 240);
    EXPECT_EQ(state().tick(), 300u);
}

/// Replaces ffmpeg by scripts; the real one may not be installed.
struct FfmpegTest : RecordTest {
    FfmpegTest() {
        make_world(server, "one", 50);
        std::filesystem::create_directory(folder.file("bin"));
        setenv("PATH", (folder.file("bin") + ":" + path).c_str(), 1);
    }
    ~FfmpegTest() override { setenv("PATH", path.c_str(), 1); }
    void install(const std::string& script) {
        std::ofstream{folder.file("bin/ffmpeg")} << "#!/bin/sh\n" << script << "\n";
        std::filesystem::permissions(folder.file("bin/ffmpeg"), std::filesystem::perms::owner_all);
    }
    const std::string path = std::getenv("PATH");
};

TEST_F(FfmpegTest, ReceivesEveryFrameComplete) {
    install(
        R"(echo "$@" >"${0%/*}/words"; for last; do :; done; cat >"${last#file:}"; ls "${0%/*}/.." >"${0%/*}/names")");
    const Ran ran = record(folder.file("film.mp4"), "--record-ticks 2 --fps 30");
    ASSERT_EQ(ran.status, 0) << ran.output;
    EXPECT_EQ(std::filesystem::file_size(folder.file("film.mp4")), 3u * 640 * 400 * 4);
    std::ifstream words_file{folder.file("bin/words")};
    std::string words;
    std::getline(words_file, words);
    EXPECT_NE(words.find("-pix_fmt rgba -s 640x400 -r 30"), std::string::npos) << words;
    std::ifstream names_file{folder.file("bin/names")};
    const std::string names{std::istreambuf_iterator<char>{names_file}, {}};
    EXPECT_NE(names.find("film.part.mp4\n"), std::string::npos) << names;
    EXPECT_EQ(names.find("film.mp4\n"), std::string::npos) << "the film has its name before it is complete";
    EXPECT_FALSE(std::filesystem::exists(folder.file("film.part.mp4")));
    std::ifstream film{folder.file("film.mp4"), std::ios::binary};
    for (const std::uint64_t tick : {50u, 51u, 52u}) {
        std::vector<sf::Uint8> pixels(640 * 400 * 4);
        film.read(reinterpret_cast<char*>(pixels.data()), static_cast<std::streamsize>(pixels.size()));
        sf::Image image;
        image.create(640, 400, pixels.data());
        const auto snapshot = replay_snapshot_of(server, "one", at_tick(tick));
        EXPECT_EQ((ExpectedFrame{*snapshot, camera_of(snapshot->about, 640, 400)}.compare(image).count), 0u) << tick;
    }
}

TEST_F(FfmpegTest, ReportsTheMessageOfAFailedFfmpeg) {
    install(
        "for last; do :; done; head -c 100 >\"${last#file:}\"; echo 'film.mp4: No space left on device' >&2; exit 3");
    const Ran ran = record(folder.file("film.mp4"), "--record-ticks 20");
    EXPECT_EQ(ran.status, 1);
    EXPECT_NE(ran.output.find("could not write " + folder.file("film.mp4") +
                              ": ffmpeg ended with status 3: film.mp4: No space"),
              std::string::npos)
        << ran.output;
    EXPECT_FALSE(std::filesystem::exists(folder.file("film.mp4")));
    EXPECT_FALSE(std::filesystem::exists(folder.file("film.part.mp4")));
    EXPECT_EQ(state().state(), evod::v1::RUN_STATE_PAUSED);
}

TEST_F(FfmpegTest, ReportsAMissingFfmpegBeforeAnyCommand) {
    setenv("PATH", folder.file("bin").c_str(), 1);
    const Ran ran = record(folder.file("film.mp4"), "--record-ticks 2");
    EXPECT_EQ(ran.status, 1);
    EXPECT_NE(ran.output.find("could not start ffmpeg to create"), std::string::npos) << ran.output;
    EXPECT_EQ(state().tick(), 50u);
}

TEST(RecordAsAViewer, RecordsWithoutSendingCommands) {
    const TemporaryFolder folder;
    evod::v1::SnapshotFrame snapshot;
    snapshot.set_width_px(100);
    snapshot.set_height_px(100);
    codec::encode_plain({}, snapshot);
    snapshot.set_world("default");
    snapshot.set_run_id(std::string("\x00\x11\x22\x33\x44\x55\x66\x77\x88\x99\xaa\xbb\xcc\xdd\xee\xff", 16));
    snapshot.set_island_count(1);
    snapshot.set_tick(77);
    snapshot.set_generation(2);
    snapshot.set_state(evod::v1::RUN_STATE_TERMINATED); // no further snapshot will arrive
    PlayingServer server{snapshot};
    const Ran ran = run_evoview("--server " + server.address() + " --record " + folder.file("frames"));
    EXPECT_EQ(ran.status, 0) << ran.output;
    EXPECT_EQ(server.command_count(), 0u);
    EXPECT_TRUE(std::filesystem::exists(folder.file("frames/frame-000000-tick-77.png"))) << ran.output;
}

} // namespace
} // namespace evod::viewer
