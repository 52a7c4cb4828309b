#include "server/replay/past.h"

#include "tests/unit/recording/recorded_run.h"

namespace evod::replay {
namespace {

using namespace run_file;
using namespace recording;

TEST(Past, NewsAreReadAfterTheLastEntryThatIsKnown) {
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
    const Past past{{data->file_of("w")}, {1, 2}};
    for (const std::uint64_t known : {0u, 1u, 2u, 3u}) {
        const auto news = past.news(known);
        ASSERT_TRUE(news) << to_text(news.error());
        EXPECT_EQ(news->after_entry, known);
        EXPECT_EQ(news->last_entry, 3u);
        EXPECT_EQ(news->there.last_tick, 40u);
        ASSERT_EQ(news->changes.size(), 3 - known);
        for (std::size_t i = 0; i < news->changes.size(); ++i) {
            EXPECT_EQ(news->changes[i].entry, known + 1 + i);
        }
    }
    // What is known is not read: it does not show that this row is damaged.
    change(data->file_of("w"), "UPDATE journal SET client = 'nobody' WHERE number = 1");
    EXPECT_FALSE(past.news(0));
    EXPECT_TRUE(past.news(1));
}

} // namespace
} // namespace evod::replay
