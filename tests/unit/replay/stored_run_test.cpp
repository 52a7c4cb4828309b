#include "server/replay/stored_run.h"

#include "tests/unit/recording/recorded_run.h"

namespace evod::replay {
namespace {

using namespace run_file;
using namespace recording;

TEST(StoredRun, NewRecordsBeginAfterTheLastKnownEntry) {
    const TemporaryFolder folder;
    auto data = DataFolder::open(folder.path());
    ASSERT_TRUE(data);
    {
        StorageThread thread{{}};
        RecordedRun run{*data, thread};
        for (const double value : {1.0, 2.0, 3.0}) {
            run.advance(10);
            run.command(set_parameter("food_health", value));
        }
        run.advance(10);
        run.recorder().close_all(run.laboratory());
    }
    const StoredRun past{{data->file_of("w")}, {1, 2}};
    for (const std::uint64_t known : {0u, 1u, 2u, 3u}) {
        const auto news = past.new_records(known);
        ASSERT_TRUE(news) << to_text(news.error());
        EXPECT_EQ(news->after_entry, known);
        EXPECT_EQ(news->last_entry, 3u);
        EXPECT_EQ(news->there.last_tick, 40u);
        ASSERT_EQ(news->changes.size(), 3 - known);
        for (std::size_t i = 0; i < news->changes.size(); ++i) {
            EXPECT_EQ(news->changes[i].entry, known + 1 + i);
        }
    }
    // Entries that are known are not read, so the damage of this row is not found.
    change(data->file_of("w"), "UPDATE journal SET user = 'mallory' WHERE number = 1");
    EXPECT_FALSE(past.new_records(0));
    EXPECT_TRUE(past.new_records(1));
}

} // namespace
} // namespace evod::replay
