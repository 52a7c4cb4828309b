#include "server/recording/recorder.h"

#include "server/replay/archive.h"
#include "server/run_file/check.h"
#include "tests/unit/recording/recorded_run.h"

namespace evod::recording {
namespace {

using namespace run_file;
using namespace replay;

class RecorderTest : public testing::Test {
  protected:
    TemporaryFolder folder;
    base::InlineExecutor executor;
};

TEST_F(RecorderTest, ABredGenerationIsRecordedWithItsFirstTick) {
    {
        auto data = DataFolder::open(folder.path());
        StorageThread thread{{}};
        RecordedRun run{*data, thread};
        run.advance(121); // the last record is the beginning of the second generation
    }
    const auto archive = Archive::open(folder.path(), {}, executor);
    ASSERT_TRUE(archive) << to_text(archive.error());
    const simulation::Laboratory laboratory = (*archive)->take_laboratory();
    const simulation::World& world = (*laboratory.find("w"))->world;
    // If recovery stopped at tick 120 with the second generation bred, a command that was applied before the breeding
    // would come too late for it.
    EXPECT_EQ(world.moment().tick, 121u);
    EXPECT_EQ(world.moment().generation_tick, 1u);
}

TEST_F(RecorderTest, ARunThatEndsWhileItIsReadStaysWhole) {
    auto data = DataFolder::open(folder.path());
    const std::string path = data->file_of("w"), ended_path = data->ended_file_of("w", {1, 2});
    base::StateHash ended_hash, hash;
    std::unique_ptr<RunFile> reading;
    {
        StorageThread thread{{}};
        RecordedRun run{*data, thread};
        run.advance(150);
        while (!thread.idle()) {
        }
        reading = *RunFile::open_read_only(path);
        ASSERT_TRUE(reading->pin_snapshot());
        EXPECT_EQ(reading->generations().last(), 2u);
        run.advance(150); // in the log alone, while a reader has the file open
        ended_hash = run.world().hash();
        run.reset({9}, {3, 4});
        run.advance(50);
        hash = run.world().hash();
        run.recorder().close_all(run.laboratory());
    }
    EXPECT_EQ(reading->generations().last(), 2u) << "what it held still has changed";
    const auto expect_whole = [&](const std::string& at, std::uint64_t tick, const base::StateHash& last) {
        const auto file = RunFile::open_read_only(at);
        ASSERT_TRUE(file) << to_text(file.error());
        const auto checked = check(**file);
        EXPECT_TRUE(checked) << to_text(checked.error());
        EXPECT_TRUE((*file)->end_mark()->has_value());
        const auto recovered = recover(**file, executor);
        ASSERT_TRUE(recovered) << to_text(recovered.error());
        EXPECT_EQ(recovered->world.moment().tick, tick);
        EXPECT_EQ(recovered->world.hash(), last);
    };
    expect_whole(ended_path, 300, ended_hash);
    expect_whole(path, 50, hash);
    reading.reset();
    expect_whole(ended_path, 300, ended_hash);
    expect_whole(path, 50, hash);
}

} // namespace
} // namespace evod::recording
