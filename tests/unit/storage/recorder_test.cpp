#include "server/storage/recorder.h"

#include "server/storage/archive.h"
#include "tests/unit/storage/recorded_run.h"

namespace evod::storage {
namespace {

class RecorderTest : public testing::Test {
  protected:
    TemporaryFolder folder;
    base::InlineExecutor executor;
};

TEST_F(RecorderTest, AGenerationThatWasBredIsToldOfWithItsFirstTick) {
    {
        auto data = DataFolder::open(folder.path());
        StorageThread thread{{}};
        RecordedRun run{*data, thread};
        run.advance(121); // the second generation's beginning is the last that is told
    }
    const auto archive = Archive::open(folder.path(), {}, executor);
    ASSERT_TRUE(archive) << to_text(archive.error());
    const simulation::Laboratory laboratory = (*archive)->take_laboratory();
    const simulation::World& world = (*laboratory.find("w"))->world;
    // Were it at tick 120 with the second generation bred, a command would come too late for a breeding that it was
    // applied before by everybody's count.
    EXPECT_EQ(world.moment().tick, 121u);
    EXPECT_EQ(world.moment().generation_tick, 1u);
}

} // namespace
} // namespace evod::storage
