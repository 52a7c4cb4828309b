// The loop with a recorder, with a manual clock: checkpoints that change nothing, and files that stand in the way.
#include "tests/support/waiting.h"
#include "tests/unit/recording/recorded_run.h"
#include "tests/unit/runtime/loop_with_clock.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <optional>

namespace evod::runtime {
namespace {

TEST_F(Loop, SlowTicksGetCheckpointsThatChangeNothing) {
    recording::TemporaryFolder folder;
    auto data = run_file::DataFolder::open(folder.path());
    base::StateHash hashes[2];
    for (const auto per_look : {1us, 20'000us}) {
        recording::StorageThread thread{{}};
        recording::Recorder recorder{*data, thread};
        clock.per_look = per_look;
        Mailbox letters;
        SimulationLoop kept{
            {letters, demand, executor, clock}, {.events = [](auto&&...) {}, .snapshot = [](auto&&) {}}, {}, &recorder};
        const auto apply = [&](simulation::Command command) {
            letters.try_push(CommandMail{std::move(command), {}, "command"}, "");
            kept.pass();
        };
        apply(create("w", 3));
        apply(simulation::SetSpeed{"w", std::nullopt});
        apply(simulation::RunUntilTick{"w", 1000});
        const simulation::World& run = (*kept.laboratory().find("w"))->world;
        while (run.moment().tick < 1000) {
            kept.pass();
        }
        ASSERT_TRUE(wait_until([&] { return thread.idle(); }));
        const auto file = run_file::RunFile::open_read_only(data->file_of("w"));
        ASSERT_TRUE(file) << to_text(file.error());
        const auto checkpoints = (*file)->checkpoints().read(0, run.moment().tick);
        ASSERT_TRUE(checkpoints) << to_text(checkpoints.error());
        EXPECT_EQ(checkpoints->empty(), per_look == 1us);
        hashes[per_look != 1us] = run.hash();
        recorder.end("w", {3, 1}, {.tick = run.moment().tick});
        ASSERT_TRUE(wait_until([&] { return thread.idle(); }));
        std::filesystem::remove(data->ended_file_of("w", {3, 1}));
    }
    EXPECT_EQ(hashes[0], hashes[1]);
}

TEST_F(Loop, AWorldIsRefusedIfItsFileExists) {
    recording::TemporaryFolder folder;
    auto data = run_file::DataFolder::open(folder.path());
    recording::StorageThread thread{{}};
    recording::Recorder recorder{*data, thread};
    Mailbox letters;
    std::string said; // of the last command; refusals come at once, on this thread
    const auto on_reply = [&](const Reply& reply) {
        if (const auto* done = std::get_if<CommandDone>(&reply); done && !done->outcome) {
            said = to_text(done->outcome.error());
        }
    };
    SimulationLoop kept{{letters, demand, executor, clock},
                        {.events = [](auto&&...) {}, .snapshot = [](auto&&) {}, .reply = on_reply},
                        {},
                        &recorder};
    const auto apply = [&](simulation::Command command) {
        said.clear();
        letters.try_push(CommandMail{std::move(command), {}, "command"}, "");
        kept.pass();
    };
    const std::string taken = data->file_of("taken");
    std::ofstream{taken} << "another program's";
    apply(create("taken"));
    EXPECT_THAT(said, testing::HasSubstr("the run would be stored in " + taken + ", which exists already"));
    std::ofstream{run_file::DataFolder::next_file_of(data->file_of("next"))} << "another program's";
    apply(create("next"));
    EXPECT_THAT(said, testing::HasSubstr("next.evod-next, which exists already"));
    EXPECT_TRUE(kept.laboratory().entries().empty());
    apply(create("w"));
    EXPECT_EQ(said, "");
    apply(create("w"));
    EXPECT_THAT(said, testing::HasSubstr("a world with that name already exists"));
    apply(simulation::ForkWorld{.world = "w", .name = "taken", .at_generation = {}, .run_id = {4, 4}});
    EXPECT_THAT(said, testing::HasSubstr(taken));
    // A name is free at once, although its file may still exist.
    for (int i = 0; i < 20; ++i) {
        apply(simulation::DeleteWorld{"w"});
        EXPECT_EQ(said, "");
        apply(create("w", static_cast<std::uint64_t>(i) + 10));
        EXPECT_EQ(said, "");
    }
    EXPECT_FALSE(recorder.trouble());
    ASSERT_TRUE(wait_until([&] { return thread.idle(); }));
    EXPECT_TRUE(run_file::RunFile::open_read_only(data->file_of("w")));
    std::filesystem::remove(taken);
    apply(create("taken", 99));
    EXPECT_EQ(said, "");
}

} // namespace
} // namespace evod::runtime
