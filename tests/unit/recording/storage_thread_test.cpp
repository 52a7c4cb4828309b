#include "server/recording/storage_thread.h"

#include "server/replay/archive.h"
#include "server/run_file/check.h"
#include "tests/support/everyday.h"
#include "tests/support/waiting.h"
#include "tests/unit/recording/failing_disk.h"
#include "tests/unit/recording/recorded_run.h"

#include <gmock/gmock.h>

#include <atomic>
#include <chrono>
#include <fstream>
#include <future>

namespace evod::recording {
namespace {

using namespace run_file;
using namespace replay;

using namespace std::chrono_literals;

class StorageThreadTest : public testing::Test {
  protected:
    StorageThreadTest() : data{*DataFolder::open(folder.path())} {}

    // In memory if possible: a sync is slow on a disk.
    TemporaryFolder folder{std::filesystem::exists("/dev/shm") ? "/dev/shm" : std::filesystem::temp_directory_path()};
    DataFolder data;
    base::InlineExecutor executor;
};

TEST_F(StorageThreadTest, TheReceiptComesWhenOthersCanReadTheCommand) {
    StorageThread thread{{}};
    RecordedRun run{data, thread};
    for (std::uint64_t number = 1; number <= 20; ++number) {
        run.command(set_parameter("food_health", static_cast<double>(number)));
        EXPECT_FALSE(run.receipt().refused);
        const auto file = RunFile::open_read_only(data.file_of("w"));
        ASSERT_TRUE(file) << to_text(file.error());
        EXPECT_EQ((*file)->journal().read()->size(), number);
    }
}

TEST_F(StorageThreadTest, AnEndedRunHasItsEndMarkAndItsNameIsFree) {
    StorageThread thread{{}};
    {
        RecordedRun run{data, thread, {1}};
        run.advance(70);
        run.delete_world();
    }
    RecordedRun next{data, thread, {2}};
    next.command(set_parameter("food_health", 1.0));
    EXPECT_FALSE(next.receipt().refused);
    const auto ended = RunFile::open_read_only(data.ended_file_of("w", {1, 2}));
    ASSERT_TRUE(ended) << to_text(ended.error());
    EXPECT_TRUE((*ended)->end_mark()->value().ended);
    EXPECT_EQ((*ended)->end_mark()->value().tick, 70u);
    EXPECT_EQ((*ended)->journal().read()->size(), 1u);
    const auto present = RunFile::open_read_only(data.file_of("w"));
    ASSERT_TRUE(present);
    EXPECT_EQ((*present)->identity().seed.value, 2u);
}

TEST_F(StorageThreadTest, TheOldestWaitingRecordDeterminesTheAge) {
    fail_operation(1, Failure::Full);
    {
        StorageThread thread{{.vfs = failing_disk()}, 1h};
        RecordedRun run{data, thread};
        ASSERT_TRUE(wait_until([&] { return thread.disk().trouble().has_value(); }));
        const auto since = thread.waiting_since();
        ASSERT_TRUE(since);
        EXPECT_LE(*since, std::chrono::steady_clock::now());
        const std::size_t bytes = thread.disk().waiting_bytes();
        run.command(set_parameter("food_health", 1.0));
        EXPECT_EQ(thread.waiting_since(), since);
        EXPECT_GT(thread.disk().waiting_bytes(), bytes);
    }
    fail_operation(0, Failure::Full);
}

/// The message of the fault of the only faulty run; empty: there is none.
std::string fault_in(StorageThread& thread, RunFault::Kind kind) {
    const RunFaults faults = thread.disk().faults();
    return faults.size() == 1 && faults.begin()->second.kind == kind ? faults.begin()->second.why.message : "";
}

/// Overwrites a run file and its log in place, while the storage thread has them open.
void overwrite(const std::string& path) {
    for (const std::string& file : {path, path + "-wal", path + "-shm"}) {
        std::error_code error;
        const auto bytes = std::filesystem::file_size(file, error);
        std::fstream{file, std::ios::in | std::ios::out | std::ios::binary} << std::string(error ? 0 : bytes, 'x');
    }
}

TEST_F(StorageThreadTest, AMovedFileIsAnErrorUntilItIsMovedBack) {
    StorageThread thread{{}, 1ms};
    RecordedRun run{data, thread};
    TemporaryFolder other_folder;
    DataFolder other_data = *DataFolder::open(other_folder.path());
    RecordedRun other{other_data, thread};
    std::atomic<int> written = 0;
    double value = 0;
    const auto command = [&] { run.command(set_parameter("food_health", ++value), [&](auto&&) { ++written; }); };
    const std::string path = data.file_of("w"), away = path + ".away";
    command();
    ASSERT_TRUE(wait_until([&] { return thread.idle(); }));
    for (const bool another : {false, true}) {
        std::filesystem::rename(path, away);
        if (another) {
            std::ofstream{path} << "another file";
        }
        ASSERT_TRUE(wait_until([&] { return !thread.disk().faults().empty(); }, // the name is checked once a second
                               [&] {
                                   command();
                                   std::this_thread::sleep_for(10ms);
                               }));
        EXPECT_FALSE(thread.disk().trouble());
        EXPECT_THAT(fault_in(thread, RunFault::Kind::Displaced),
                    testing::HasSubstr(
                        path + (another ? " is not the file that the server writes" : " has been moved or deleted")));
        const int at_trouble = written;
        command();
        other.command(set_parameter("food_health", value));
        EXPECT_FALSE(other.receipt().refused);
        EXPECT_EQ(written, at_trouble) << "no receipt comes while the file is lost";
        run.once_written();
        EXPECT_EQ(run.receipt().refused.value().code, base::RefusalCode::NotFound) << "a barrier does not wait";
        other.once_written();
        EXPECT_FALSE(other.receipt().refused);
        std::filesystem::rename(away, path);
        ASSERT_TRUE(wait_until([&] { return written >= static_cast<int>(value) && thread.disk().faults().empty(); }));
    }
    EXPECT_EQ((*RunFile::open_read_only(path))->journal().read()->size(), static_cast<std::size_t>(value));
}

TEST_F(StorageThreadTest, ADamagedFileStopsOnlyItsRun) {
    TemporaryFolder other_folder;
    DataFolder other_data = *DataFolder::open(other_folder.path());
    StorageThread thread{{}, 1ms};
    RecordedRun run{data, thread};
    RecordedRun other{other_data, thread};
    run.command(set_parameter("food_health", 1.0));
    EXPECT_FALSE(run.receipt().refused);
    const std::string path = data.file_of("w");
    overwrite(path);
    run.advance(200);
    run.checkpoint();
    run.command(set_parameter("food_health", 2.0));
    const base::Refusal why = run.receipt().refused.value();
    EXPECT_EQ(why.code, base::RefusalCode::DataLoss);
    EXPECT_THAT(why.message, testing::HasSubstr(path + " is damaged"));
    EXPECT_EQ(fault_in(thread, RunFault::Kind::Damaged), why.message);
    EXPECT_FALSE(thread.disk().trouble());
    // A later record is refused too, and nothing waits.
    run.command(set_parameter("food_health", 3.0));
    EXPECT_EQ(run.receipt().refused.value().message, why.message);
    run.once_written();
    EXPECT_EQ(run.receipt().refused.value().message, why.message);
    ASSERT_TRUE(wait_until([&] { return thread.idle(); }));
    EXPECT_EQ(thread.disk().waiting_bytes(), 0u);
    other.command(set_parameter("food_health", 2.0));
    EXPECT_FALSE(other.receipt().refused);
    run.recorder().give_up("w");
    ASSERT_TRUE(wait_until([&] { return thread.disk().faults().empty(); }));
    other.recorder().close_all(other.laboratory());
    EXPECT_TRUE(thread.finish());
    EXPECT_TRUE(check(**RunFile::open_read_only(other_data.file_of("w"))));
}

TEST_F(StorageThreadTest, ABarrierDoesNotWaitForAFailingDisk) {
    {
        StorageThread thread{{.vfs = failing_disk()}, 1h};
        RecordedRun run{data, thread};
        run.once_written();
        EXPECT_FALSE(run.receipt().refused);
        EXPECT_TRUE(std::filesystem::exists(data.file_of("w")));
        fail_operation(1, Failure::Full);
        bool command_written = false;
        run.command(set_parameter("food_health", 1.0),
                    [&](const Receipt& receipt) { command_written = !receipt.refused; });
        run.once_written(); // may come before or after the failure
        EXPECT_EQ(run.receipt().refused.value().code, base::RefusalCode::Unavailable);
        ASSERT_TRUE(wait_until([&] { return thread.disk().trouble().has_value(); }));
        for (int count = 0; count < 3; ++count) { // the next attempt to write is due in an hour
            run.once_written();
            EXPECT_EQ(run.receipt().refused.value().message, *thread.disk().trouble());
        }
        EXPECT_FALSE(command_written);
        EXPECT_TRUE(thread.finish()) << "the thread tries again when it ends";
        EXPECT_TRUE(command_written);
    }
    EXPECT_EQ((*RunFile::open_read_only(data.file_of("w")))->journal().read()->size(), 1u);
}

TEST_F(StorageThreadTest, AWorldWithADamagedFileCanBeDeletedAndReset) {
    for (const bool reset : {false, true}) {
        folder.clear();
        StorageThread thread{{}, 1ms};
        RecordedRun run{data, thread};
        run.command(set_parameter("food_health", 1.0));
        EXPECT_FALSE(run.receipt().refused);
        overwrite(data.file_of("w"));
        run.advance(200);
        reset ? run.reset({2}, {3, 4}) : run.delete_world();
        EXPECT_FALSE(run.receipt().refused);
        EXPECT_TRUE(std::filesystem::exists(data.ended_file_of("w", {1, 2})));
        EXPECT_EQ(std::filesystem::exists(data.file_of("w")), reset);
        if (reset) {
            EXPECT_TRUE(check(**RunFile::open_read_only(data.file_of("w"))));
        }
        ASSERT_TRUE(wait_until([&] { return thread.idle(); }));
        EXPECT_TRUE(thread.disk().faults().empty());
    }
}

TEST_F(StorageThreadTest, AResetThatCannotBeStoredKeepsTheOldRun) {
    StorageThread thread{{}, 1ms};
    RecordedRun run{data, thread};
    run.command(set_parameter("food_health", 1.0));
    run.advance(70);
    ASSERT_TRUE(wait_until([&] { return thread.idle(); }));
    std::ofstream{DataFolder::next_file_of(data.file_of("w"))} << std::string(5000, 'x');
    run.reset({2}, {3, 4});
    EXPECT_EQ(run.receipt().refused.value().code, base::RefusalCode::DataLoss);
    EXPECT_FALSE(fault_in(thread, RunFault::Kind::Damaged).empty());
    run.recorder().give_up("w");
    ASSERT_TRUE(wait_until([&] { return thread.idle() && thread.disk().faults().empty(); }));
    const auto file = RunFile::open_read_only(data.file_of("w"));
    ASSERT_TRUE(file);
    EXPECT_EQ((*file)->identity().run_id, (simulation::RunId{1, 2}));
    EXPECT_FALSE(*(*file)->end_mark()) << "a restart continues this run";
    EXPECT_EQ((*file)->journal().read()->size(), 1u);
}

TEST_F(StorageThreadTest, DamageWhileTheServerStopsIsReported) {
    StorageThread thread{{}, 1ms};
    RecordedRun run{data, thread};
    run.command(set_parameter("food_health", 1.0));
    EXPECT_FALSE(run.receipt().refused);
    overwrite(data.file_of("w"));
    run.recorder().close_all(run.laboratory());
    EXPECT_FALSE(thread.finish());
}

TEST_F(StorageThreadTest, LogsAtItsEndWhatItCouldNotWrite) {
    testing::internal::CaptureStdout();
    {
        StorageThread thread{{.vfs = failing_disk()}, 1h};
        RecordedRun run{data, thread};
        run.command(set_parameter("food_health", 1.0));
        EXPECT_FALSE(run.receipt().refused);
        fail_operation(1, Failure::Gone); // and all after it
        run.command(set_parameter("food_health", 2.0));
        ASSERT_TRUE(wait_until([&] { return thread.disk().trouble().has_value(); }));
        EXPECT_FALSE(run.has_receipt());
        run.command(set_parameter("food_health", 3.0));
        EXPECT_FALSE(run.has_receipt());
    }
    fail_operation(0, Failure::Gone);
    const std::string said = testing::internal::GetCapturedStdout();
    EXPECT_THAT(
        said, testing::ContainsRegex("world \"w\": [0-9]+ bytes could not be written: the results of 0 generations, 2 "
                                     "commands, and the last tick. " +
                                     data.file_of("w") + " contains every acknowledged command"));
    EXPECT_EQ((*RunFile::open_read_only(data.file_of("w")))->journal().read()->size(), 1u);
}

TEST_F(StorageThreadTest, ItIsIdleOnceEverythingIsWritten) {
    StorageThread thread{{}};
    RecordedRun run{data, thread};
    run.command(set_parameter("food_health", 1.0));
    EXPECT_FALSE(run.receipt().refused);
    ASSERT_TRUE(wait_until([&] { return !thread.waiting_since(); }));
    EXPECT_EQ(thread.disk().waiting_bytes(), 0u);
}

TEST_F(StorageThreadTest, EachOfSeveralResetsEndsTheRunBefore) {
    StorageThread thread{{}};
    RecordedRun run{data, thread};
    for (std::uint64_t number = 1; number <= 5; ++number) {
        run.advance(10 * number);
        run.reset({number}, {0, number});
    }
    EXPECT_FALSE(run.receipt().refused);
    const auto files = data.files();
    EXPECT_TRUE(files->replaced.empty());
    EXPECT_EQ(files->ended.size(), 5u);
    for (std::uint64_t number = 0; number < 5; ++number) {
        const simulation::RunId run_id = number == 0 ? simulation::RunId{1, 2} : simulation::RunId{0, number};
        const auto ended = RunFile::open_read_only(data.ended_file_of("w", run_id));
        ASSERT_TRUE(ended) << to_text(ended.error());
        EXPECT_EQ((*ended)->end_mark()->value().tick, 10 * (number + 1));
        EXPECT_TRUE(check(**ended));
    }
    EXPECT_EQ((*RunFile::open_read_only(data.file_of("w")))->identity().seed.value, 5u);
}

TEST_F(StorageThreadTest, ACommandIsWrittenBeforeACheckpointIsCompressed) {
    StorageThread thread{{}};
    RecordedRun run{data, thread};
    std::promise<void> at_work, go_on;
    run.command(set_parameter("food_health", 1.0), [&](auto&&) {
        at_work.set_value();
        go_on.get_future().wait();
    });
    at_work.get_future().wait();
    run.advance(70);
    run.checkpoint();
    std::size_t commands = 0, checkpoints = 1;
    run.command(set_parameter("food_health", 2.0), [&](auto&&) {
        const auto file = RunFile::open_read_only(data.file_of("w"));
        commands = (*file)->journal().read()->size();
        checkpoints = (*file)->checkpoints().read(0, 70)->size();
    });
    go_on.set_value();
    EXPECT_FALSE(run.receipt().refused);
    EXPECT_EQ(commands, 2u);
    EXPECT_EQ(checkpoints, 0u);
    ASSERT_TRUE(wait_until([&] { return thread.idle(); }));
    EXPECT_EQ((*RunFile::open_read_only(data.file_of("w")))->checkpoints().read(0, 70)->size(), 1u);
}

/// The ticks of complete checkpoints, and of those with orphaned parts.
struct PartCount {
    std::int64_t of_whole = 0, of_none = 0;
};
PartCount parts_in(const std::string& path) {
    Database file{path, Database::Mode::Read};
    const std::string parts = "SELECT count(*) FROM checkpoint_part WHERE tick ";
    const PartCount count{file.number((parts + "IN (SELECT tick FROM checkpoint)").c_str()),
                          file.number((parts + "NOT IN (SELECT tick FROM checkpoint)").c_str())};
    EXPECT_FALSE(file.failed()) << file.error();
    return count;
}

TEST_F(StorageThreadTest, ACommandComesBetweenThePartsOfACheckpoint) {
    StorageThread thread{{.vfs = failing_disk(), .part_bytes = 64}};
    RecordedRun run{data, thread};
    run.advance(70);
    run.checkpoint();
    ASSERT_TRUE(wait_until([&] { return thread.idle(); }));
    const std::int64_t parts = parts_in(data.file_of("w")).of_whole;
    ASSERT_GT(parts, 20);

    run.advance(70);
    ASSERT_TRUE(wait_until([&] { return thread.idle(); }));
    std::promise<void> written_to, go_on;
    call_before_operation(40, [&] { // a part takes several operations: pages and a sync
        written_to.set_value();
        go_on.get_future().wait();
    });
    run.checkpoint();
    written_to.get_future().wait();
    PartCount when_done;
    run.command(set_parameter("food_health", 1.0), [&](auto&&) { when_done = parts_in(data.file_of("w")); });
    go_on.set_value();
    EXPECT_FALSE(run.receipt().refused);
    EXPECT_EQ(when_done.of_whole, parts);
    EXPECT_GT(when_done.of_none, 0);
    EXPECT_LT(when_done.of_none, parts / 2);
    ASSERT_TRUE(wait_until([&] { return thread.idle(); }));
    const auto file = RunFile::open_read_only(data.file_of("w"));
    EXPECT_EQ((*file)->checkpoints().read(0, 140)->size(), 2u);
    EXPECT_TRUE(check(**file));
    EXPECT_EQ(parts_in(data.file_of("w")).of_none, 0);
}

TEST_F(StorageThreadTest, PartsOfDroppedCheckpointsAreDeleted) {
    StorageThread thread{{.part_bytes = 256}};
    RecordedRun run{data, thread};
    for (int count = 0; count < 6; ++count) {
        run.advance(30);
        run.checkpoint();
        ASSERT_TRUE(wait_until([&] { return thread.idle(); }));
        EXPECT_EQ(parts_in(data.file_of("w")).of_none, 0);
    }
    EXPECT_GT(parts_in(data.file_of("w")).of_whole, 3 * 2);
    const auto file = RunFile::open_read_only(data.file_of("w"));
    EXPECT_EQ((*file)->checkpoints().read(0, 180)->size(), 3u);
    EXPECT_TRUE(check(**file));
}

TEST_F(StorageThreadTest, AWaitingCheckpointIsDroppedWhenItsRunEnds) {
    StorageThread thread{{.part_bytes = 256}};
    RecordedRun run{data, thread};
    std::promise<void> at_work, go_on;
    run.command(set_parameter("food_health", 1.0), [&](auto&&) {
        at_work.set_value();
        go_on.get_future().wait();
    });
    at_work.get_future().wait();
    run.advance(70);
    run.checkpoint();
    run.reset({2}, {3, 4});
    go_on.set_value();
    EXPECT_FALSE(run.receipt().refused);
    ASSERT_TRUE(wait_until([&] { return thread.idle(); }));
    const std::string path = data.ended_file_of("w", {1, 2});
    const auto file = RunFile::open_read_only(path);
    ASSERT_TRUE(file) << to_text(file.error());
    EXPECT_EQ((*file)->end_mark()->value().tick, 70u);
    EXPECT_TRUE((*file)->checkpoints().read(0, 70)->empty());
    EXPECT_TRUE(check(**file));
    EXPECT_EQ(parts_in(path).of_none, 0);
}

TEST_F(StorageThreadTest, ALongLogIsCopiedIntoItsFile) {
    StorageThread thread{{.log_pages_max = 16}};
    RecordedRun run{data, thread};
    const auto command = [&](double value) {
        run.command(set_parameter("food_health", value));
        EXPECT_FALSE(run.receipt().refused);
    };
    command(0);
    const auto bytes = std::filesystem::file_size(data.file_of("w"));
    for (int number = 1; number <= 100; ++number) {
        command(number);
    }
    ASSERT_TRUE(wait_until([&] { return thread.idle(); }));
    EXPECT_GT(std::filesystem::file_size(data.file_of("w")), bytes);
    const auto file = RunFile::open_read_only(data.file_of("w"));
    EXPECT_EQ((*file)->journal().read()->size(), 101u);
    EXPECT_TRUE(check(**file));
}

std::vector<std::uint64_t> ticks_of_checkpoints(RunFile& file) {
    std::vector<std::uint64_t> ticks;
    for (const StoredCheckpoint& checkpoint : *file.checkpoints().read(0, file.contents().tick)) {
        ticks.push_back(checkpoint.moment.tick);
    }
    return ticks;
}

TEST_F(StorageThreadTest, ACheckpointOfAPurgedGenerationIsNotWritten) {
    StorageThread thread{{.keep_every = 5}};
    RecordedRun run{data, thread};
    const auto in_generation = [&](std::uint64_t generation) {
        while (run.world().moment().generation < generation) {
            run.advance(1);
        }
    };
    in_generation(2);
    std::promise<void> at_work, go_on;
    run.command(set_parameter("food_health", 1.0), [&](auto&&) {
        at_work.set_value();
        go_on.get_future().wait();
    });
    at_work.get_future().wait();
    run.checkpoint();
    in_generation(3);
    go_on.set_value();
    ASSERT_TRUE(wait_until([&] { return thread.idle(); }));
    const auto file = RunFile::open_read_only(data.file_of("w"));
    EXPECT_EQ((*file)->generations().last(), 3u);
    EXPECT_TRUE(ticks_of_checkpoints(**file).empty());
    EXPECT_TRUE(check(**file));
}

/// Runs of some commits, with checkpoints. In each run one operation of the disk fails, until a run has too few
/// operations for one to fail. Every day only each eighth operation fails: all of them take two minutes.
class FailingDisk : public StorageThreadTest, public testing::WithParamInterface<Failure> {};

TEST_P(FailingDisk, EverythingIsWrittenInTheEnd) {
    const std::uint64_t stride = everyday_size("FAILING_STRIDE", 8);
    std::uint64_t operation = 0;
    do {
        operation += stride;
        ASSERT_LT(operation, 10'000u);
        folder.clear();
        fail_operation(operation, GetParam());
        base::StateHash ended_hash, hash;
        std::atomic<int> written = 0;
        const auto written_one = [&](const Receipt& receipt) { written += receipt.refused ? 0 : 1; };
        {
            StorageThread thread{
                {.durability = Durability::Full, .vfs = failing_disk(), .part_bytes = 700, .log_pages_max = 32}, 1ms};
            RecordedRun run{data, thread};
            for (int round = 0; round < 4; ++round) {
                run.command(set_parameter("food_health", 1.0 * round), written_one);
                ASSERT_TRUE(wait_until([&] { return run.has_receipt(); })) << "operation " << operation;
                run.advance(70);
                run.checkpoint();
                ended_hash = run.world().hash();
            }
            ASSERT_TRUE(wait_until([&] { return thread.idle(); })); // otherwise the last checkpoint is dropped
            run.reset({9}, {3, 4}, written_one);
            ASSERT_TRUE(wait_until([&] { return run.has_receipt(); })) << "operation " << operation;
            run.advance(70);
            run.checkpoint();
            run.recorder().close_all(run.laboratory());
            hash = run.world().hash();
            // Waits for the end as well: a thread that stops drops what it cannot write.
            ASSERT_TRUE(wait_until([&] { return thread.idle(); }));
        }
        EXPECT_EQ(written, 5);
        const auto expect_whole = [&](const std::string& path, std::size_t commands,
                                      const std::vector<std::uint64_t>& checkpoints, const base::StateHash& last) {
            const auto file = RunFile::open_read_only(path);
            ASSERT_TRUE(file) << "operation " << operation << ": " << to_text(file.error());
            const auto checked = check(**file);
            ASSERT_TRUE(checked) << "operation " << operation << ": " << to_text(checked.error());
            EXPECT_EQ(parts_in(path).of_none, 0) << "operation " << operation;
            EXPECT_EQ((*file)->journal().read()->size(), commands);
            EXPECT_EQ(ticks_of_checkpoints(**file), checkpoints) << "operation " << operation;
            const auto recovered = recover(**file, executor);
            ASSERT_TRUE(recovered) << to_text(recovered.error());
            EXPECT_EQ(recovered->world.moment().tick, checkpoints.back());
            EXPECT_EQ(recovered->world.hash(), last);
        };
        expect_whole(data.ended_file_of("w", {1, 2}), 4, {140, 210, 280}, ended_hash);
        expect_whole(data.file_of("w"), 1, {70}, hash);
    } while (has_failed());
    EXPECT_GT(operation, 10u);
    fail_operation(0, GetParam());
}

INSTANTIATE_TEST_SUITE_P(All, FailingDisk, testing::Values(Failure::InputOutput, Failure::Full, Failure::Torn),
                         testing::PrintToStringParamName());

/// Simulates a kill right before each disk operation in turn.
TEST_F(StorageThreadTest, AfterAKillTheFileHasExactlyWhatWasAnswered) {
    const std::uint64_t stride =
        std::max<std::uint64_t>(1, everyday_size("FAILING_STRIDE", 8) / 8); // a kill takes 30 ms
    std::uint64_t operation = 0;
    int half_written = 0;
    { DataFolder taken = std::move(data); }
    do {
        operation += stride;
        ASSERT_LT(operation, 10'000u);
        SCOPED_TRACE("killed before operation " + std::to_string(operation));
        folder.clear();
        fail_operation(operation, Failure::Gone);
        std::vector<base::StateHash> hashes; // of the origin, by tick
        std::atomic<std::uint64_t> written = 0;
        std::uint64_t asked = 0;
        {
            auto own = DataFolder::open(folder.path());
            StorageThread thread{{.durability = Durability::Full, .vfs = failing_disk(), .part_bytes = 700}, 1ms};
            RecordedRun run{*own, thread};
            const auto counts = [&] {
                ++asked;
                return [&](const Receipt& receipt) { written += receipt.refused ? 0 : 1; };
            };
            const auto wait = [&] {
                EXPECT_TRUE(wait_until([&] { return written == asked || thread.disk().trouble(); }));
                return !thread.disk().trouble();
            };
            const auto advance = [&] {
                for (int tick = 0; tick < 70; ++tick) {
                    hashes.push_back(run.world().hash());
                    run.advance(1);
                }
                run.checkpoint();
            };
            for (int round = 0; round < 4; ++round) {
                run.command(set_parameter("food_health", 1.0 * round), counts());
                if (!wait()) {
                    break;
                }
                advance(); // the next command comes while the checkpoint is written
                if (round == 3) {
                    run.fork({5, 6}, counts());
                }
            }
            hashes.push_back(run.world().hash());
            (void)wait();
        }
        // A file with a world's name contains its identity without its log.
        for (const std::string world : {"w", "fork"}) {
            if (const std::string path = folder.path() + "/" + world + ".evod"; std::filesystem::exists(path)) {
                std::string head(72, '\0');
                std::ifstream{path, std::ios::binary}.read(head.data(), std::ssize(head));
                EXPECT_EQ(head.substr(68), "EVOD") << path;
            }
        }
        const std::string path = folder.path() + "/w.evod";
        if (std::filesystem::exists(path)) {
            half_written += parts_in(path).of_none > 0;
        }
        const auto archive = Archive::open(folder.path(), {}, executor);
        ASSERT_TRUE(archive) << to_text(archive.error());
        for (const auto& file : std::filesystem::directory_iterator{folder.path()}) {
            EXPECT_EQ(file.path().string().find("-next"), std::string::npos) << file.path();
        }
        simulation::Laboratory laboratory = (*archive)->take_laboratory();
        for (const auto& entry : laboratory.entries()) {
            const std::uint64_t tick = entry->world.moment().tick;
            ASSERT_LT(tick, hashes.size());
            EXPECT_EQ(entry->world.hash(), hashes[tick]) << entry->name << " at tick " << tick;
        }
        // Every answered command is there; the one that was not answered is there or not.
        const std::size_t there = (*archive)->take_answers().size();
        EXPECT_GE(there, written);
        EXPECT_LE(there, asked);
        EXPECT_EQ(static_cast<bool>(laboratory.find("fork")), there == 5);
        EXPECT_TRUE(written == 0 || laboratory.find("w"));
        (*archive)->recorder().close_all(laboratory);
        (*archive)->close();
        if (std::filesystem::exists(path)) {
            EXPECT_EQ(parts_in(path).of_none, 0);
        }
    } while (has_failed());
    EXPECT_GT(operation, 10u);
    EXPECT_GT(half_written, 0);
    fail_operation(0, Failure::Gone);
}

} // namespace
} // namespace evod::recording
