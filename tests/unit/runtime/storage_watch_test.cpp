// A disk or a run file that cannot be written.
#include "server/runtime/storage_watch.h"

#include "tests/unit/runtime/loops_with_disk.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

namespace evod::runtime {
namespace {

TEST_F(LoopsWithDisk, WaitingWorldsAreShownAndReplaysContinue) {
    ask_create("w");
    ask_run("w");
    pass_until([&] { return tick("w") > 300; });
    std::string look;
    ask(OpenReplay{.world = "w", .at = {}}, 1, [&](const base::Result<std::string>& name) {
        ASSERT_TRUE(name) << to_text(name.error());
        look = *name;
    });
    pass_until([&] { return !look.empty(); });
    make_crowd();
    pass_until([&] { return laboratory().find("crowd") && thread.idle(); });
    take_away();
    send(simulation::Run{"crowd", {}});
    pass_until([&] { return state() == simulation::StorageState::Stalled; });
    EXPECT_EQ(entry("w").storage->state, simulation::StorageState::Stalled);
    EXPECT_EQ(entry("w").ticks_per_s, 0);
    EXPECT_FALSE(entry(look).storage);
    EXPECT_FALSE(loops.pass()) << "the loop is idle until the disk state changes";

    const std::uint64_t stands = tick("w");
    snapshots.clear();
    loops.simulations.set_demand(
        {{"w", WorldDemand{.rate_hz = 25, .all_islands = true, .islands = {}, .newcomers = 7}}}, false);
    loops.pass();
    ASSERT_EQ(snapshots.size(), 1) << "a new viewer";
    EXPECT_EQ(snapshots[0]->moment.tick, stands);
    ask_run(look);
    pass_until([&] { return tick(look) > 100; });
    EXPECT_EQ(tick("w"), stands);

    const int news_before = news;
    give_back();
    pass_until([&] { return state() == simulation::StorageState::KeepsUp; });
    EXPECT_GE(news, news_before + 2) << "one for the free queue, one for the working disk";
    pass_until([&] { return tick("w") > stands; });
    // While the queue has room, only failures are reported. A state may be too short to be seen. Before the failure is
    // detected, the disk may be reported as behind.
    std::erase(reported, simulation::StorageState::Failing);
    std::erase(reported, simulation::StorageState::Behind);
    // A state is reported again after Failing or Behind.
    reported.erase(std::unique(reported.begin(), reported.end()), reported.end());
    if (!reported.empty() && reported.front() == simulation::StorageState::KeepsUp) {
        reported.erase(reported.begin()); // after Behind
    }
    EXPECT_EQ(reported, (std::vector{simulation::StorageState::Stalled, simulation::StorageState::KeepsUp}));
}

TEST_F(LoopsWithDisk, ADamagedFileStopsOnlyItsWorld) {
    const std::string look = look_at_the_past_of_a_run(); // of the world "long"
    ask_create("w");
    EXPECT_TRUE(answer_of_last());
    ask_run("w");
    EXPECT_TRUE(answer_of_last());
    pass_until([&] { return thread.idle() || tick("w") > 10; });
    const std::string path = data.file_of("long");
    for (const std::string& file : {path, path + "-wal", path + "-shm"}) {
        const std::string bytes(std::filesystem::file_size(file), 'x');
        std::fstream{file, std::ios::in | std::ios::out | std::ios::binary} << bytes;
    }
    ask_run("long");
    const auto unrecorded = answer_of_last();
    ASSERT_FALSE(unrecorded);
    EXPECT_EQ(unrecorded.error().reason, base::Reason::WorldDamaged);
    EXPECT_THAT(unrecorded.error().message, testing::HasSubstr(path + " is damaged"));
    EXPECT_THAT(unrecorded.error().message, testing::HasSubstr("deleting the world moves the file away"));
    pass_until([&] { return !damaged.empty(); });
    ASSERT_EQ(damaged.size(), 1u);
    EXPECT_EQ(unrecorded.error().message, damaged[0].refusal().message);
    ASSERT_TRUE(laboratory().find_damaged("long"));
    EXPECT_EQ(counted.damaged(), std::vector<std::string>{"long"});
    // Later commands are refused in the same words, and the other world runs on.
    ask_run("long");
    EXPECT_EQ(answer_of_last().error().message, unrecorded.error().message);
    const std::uint64_t before = tick("w");
    pass_until([&] { return tick("w") > before + 10; });
    ask_run("w");
    EXPECT_TRUE(answer_of_last());
    EXPECT_TRUE(reported.empty());
    EXPECT_EQ(tick(look), 0u) << "the replay stays";
    ask_create("long");
    EXPECT_EQ(answer_of_last().error().code, base::RefusalCode::AlreadyExists);
    v1::Request remove;
    remove.mutable_delete_world()->set_world("long");
    ask(std::move(remove));
    EXPECT_TRUE(answer_of_last());
    EXPECT_TRUE(std::filesystem::exists(folder.path() + "/long.damaged-1.evod"));
    ask_create("long");
    EXPECT_TRUE(answer_of_last());
}

TEST_F(LoopsWithDisk, AMovedFileLetsOnlyItsWorldWait) {
    for (const char* name : {"w", "moved"}) {
        ask_create(name);
        ask_run(name);
        EXPECT_TRUE(answer_of_last());
    }
    const std::string path = data.file_of("moved");
    std::filesystem::rename(path, path + ".away");
    pass_until([&] { return !reported_of_world.empty(); });
    const std::uint64_t stands = tick("moved"), before = tick("w");
    EXPECT_EQ(entry("moved").storage->state, simulation::StorageState::Stalled);
    EXPECT_EQ(entry("w").storage->state, simulation::StorageState::KeepsUp);
    ask_run("moved");
    EXPECT_EQ(answer_of_last().error().code, base::RefusalCode::Unavailable);
    ask_run("w");
    EXPECT_TRUE(answer_of_last());
    pass_until([&] { return tick("w") > before + 100; });
    EXPECT_EQ(tick("moved"), stands);
    std::filesystem::rename(path + ".away", path);
    pass_until([&] { return tick("moved") > stands; });
    ask_run("moved");
    EXPECT_TRUE(answer_of_last());
    using State = simulation::StorageState;
    EXPECT_EQ(reported_of_world,
              (std::vector<std::pair<std::string, State>>{{"moved", State::Stalled}, {"moved", State::KeepsUp}}));
    EXPECT_TRUE(reported.empty());
}

TEST_F(LoopsWithDisk, AFailedCreationRefusesNothingElse) {
    ask_create("w");
    EXPECT_TRUE(answer_of_last());
    hold_storage_thread();
    // The file appears between the check of the name and the creation of the file.
    ask_create("new");
    loops.pass();
    std::ofstream{run_file::DataFolder::next_file_of(data.file_of("new"))} << std::string(5000, 'x');
    go_on.set_value();
    const auto created = answer_of_last();
    ASSERT_FALSE(created);
    EXPECT_EQ(created.error().reason, base::Reason::WorldDamaged);
    ask_run("w");
    EXPECT_TRUE(answer_of_last());
    pass_until([&] { return laboratory().find_damaged("new") != nullptr; });
}

TEST_F(LoopsWithDisk, ASlowDiskIsReportedAfterAWhile) {
    ask_create("w");
    loops.pass();
    hold_storage_thread();
    make_crowd();
    send(simulation::Run{"crowd", {}});
    pass_until([&] { return !recorder.has_room(); });
    loops.pass();
    const std::uint64_t stands = tick("crowd");
    const auto next = loops.pass();
    ASSERT_TRUE(next);
    EXPECT_GT(*next, clock.now()) << "the loop may sleep";
    EXPECT_TRUE(reported.empty());
    clock.advance(StorageWatch::slow_disk_patience);
    EXPECT_FALSE(loops.pass());
    EXPECT_EQ(state(), simulation::StorageState::Behind);
    EXPECT_FALSE(recorder.refusal());
    EXPECT_EQ(tick("crowd"), stands);
    go_on.set_value();
    pass_until([&] { return state() == simulation::StorageState::KeepsUp; });
    EXPECT_EQ(reported, (std::vector{simulation::StorageState::Behind, simulation::StorageState::KeepsUp}));
    pass_until([&] { return tick("crowd") > stands; });
}

} // namespace
} // namespace evod::runtime
