#include "server/storage/storage_thread.h"

#include "server/storage/rerun.h"
#include "tests/unit/storage/failing_disk.h"
#include "tests/unit/storage/recorded_run.h"

#include <gmock/gmock.h>

#include <chrono>
#include <future>

namespace evod::storage {
namespace {

using namespace std::chrono_literals;

class StorageThreadTest : public testing::Test {
  protected:
    StorageThreadTest() : data{*DataFolder::open(folder.path())} {}

    TemporaryFolder folder;
    DataFolder data;
    base::InlineExecutor executor;
};

TEST_F(StorageThreadTest, TellsOnceTheCommandCanBeReadByOthers) {
    StorageThread thread{{}};
    RecordedRun run{data, thread};
    for (std::uint64_t number = 1; number <= 20; ++number) {
        std::promise<void> told;
        run.command(set_parameter("food_health", static_cast<double>(number)), [&] { told.set_value(); });
        told.get_future().wait();
        const auto file = RunFile::open_read_only(data.file_of("w"));
        ASSERT_TRUE(file) << to_text(file.error());
        EXPECT_EQ((*file)->journal()->size(), number);
    }
}

TEST_F(StorageThreadTest, AnEndedRunHasItsEndMarkAndItsNameIsFree) {
    StorageThread thread{{}};
    {
        RecordedRun run{data, thread, {1}};
        run.advance(70);
        run.recorder().end("w", {1, 2}, 70);
    }
    std::promise<void> told;
    RecordedRun next{data, thread, {2}};
    next.command(set_parameter("food_health", 1.0), [&] { told.set_value(); });
    told.get_future().wait();
    const auto ended = RunFile::open_read_only(data.ended_file_of("w", {1, 2}));
    ASSERT_TRUE(ended) << to_text(ended.error());
    EXPECT_TRUE((*ended)->end_mark()->value().ended);
    EXPECT_EQ((*ended)->end_mark()->value().tick, 70u);
    const auto present = RunFile::open_read_only(data.file_of("w"));
    ASSERT_TRUE(present);
    EXPECT_EQ((*present)->identity().seed.value, 2u);
}

/// Runs of some commits; in each another operation of the disk fails, until there is none left to fail.
class FailingDisk : public StorageThreadTest, public testing::WithParamInterface<Failure> {};

TEST_P(FailingDisk, NothingIsToldBeforeItIsWrittenAndAllIsWrittenInTheEnd) {
    std::uint64_t operation = 0;
    do {
        ASSERT_LT(++operation, 10'000u);
        folder.clear();
        fail_operation(operation, GetParam());
        base::StateHash hash;
        std::atomic<int> told = 0;
        {
            StorageThread thread{{.durability = Durability::Full, .vfs = failing_disk()}, 1ms};
            RecordedRun run{data, thread};
            for (int round = 0; round < 4; ++round) {
                std::promise<void> durable;
                run.command(set_parameter("food_health", 1.0 * round), [&] {
                    ++told;
                    durable.set_value();
                });
                ASSERT_EQ(durable.get_future().wait_for(60s), std::future_status::ready) << "operation " << operation;
                run.advance(70);
            }
            run.recorder().close_all(run.laboratory());
            hash = run.world().hash();
            // The end is waited for too: a thread that stops gives up what cannot be written.
            while (!thread.idle())
                std::this_thread::yield();
        }
        EXPECT_EQ(told, 4);
        const auto file = RunFile::open_read_only(data.file_of("w"));
        ASSERT_TRUE(file) << "operation " << operation << ": " << to_text(file.error());
        const auto checked = (*file)->check();
        ASSERT_TRUE(checked) << "operation " << operation << ": " << to_text(checked.error());
        EXPECT_EQ((*file)->journal()->size(), 4u);
        const auto recovered = recover(**file, executor);
        ASSERT_TRUE(recovered) << to_text(recovered.error());
        EXPECT_EQ(recovered->world.moment().tick, 280u);
        EXPECT_EQ(recovered->world.hash(), hash);
    } while (has_failed());
    EXPECT_GT(operation, 10u);
    fail_operation(0, GetParam());
}

std::string name_of(const testing::TestParamInfo<Failure>& how) {
    constexpr const char* names[] = {"InputOutput", "Full", "Torn"};
    return names[static_cast<int>(how.param)];
}

INSTANTIATE_TEST_SUITE_P(All, FailingDisk, testing::Values(Failure::InputOutput, Failure::Full, Failure::Torn),
                         name_of);

} // namespace
} // namespace evod::storage
