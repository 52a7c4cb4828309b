#include "server/runtime/export_job.h"

#include "tests/support/waiting.h"
#include "tests/unit/recording/recorded_run.h"
#include "tests/unit/replay/other_model.h"

#include <gmock/gmock.h>

#include <sstream>

namespace evod::runtime {
namespace {

using base::RefusalCode;
using replay::RunTable;
using run_file::RunFile;
using testing::HasSubstr;

class ExportJobTest : public testing::Test {
  protected:
    /// Records so many generations, and one tick of the next.
    void record(int generations, std::uint64_t keep_every = 1) {
        RunFile::Options options;
        options.keep_every = keep_every;
        recording::StorageThread thread{options};
        recording::RecordedRun run{data, thread};
        while (run.world().moment().generation <= static_cast<std::uint64_t>(generations)) {
            run.advance(1);
        }
        run.advance(1);
        ASSERT_TRUE(wait_until([&] { return thread.idle(); }));
        past.emplace(*replay::StoredRun::of_file(data.file_of("w")));
    }
    base::Result<ExportPart> next(ExportJob& thread) {
        thread.next({.session = 3, .request_id = ++last_request_id, .export_id = 7});
        std::vector<Delivery> deliveries;
        EXPECT_TRUE(wait_until([&] {
            deliveries = outbox.take().deliveries;
            return !deliveries.empty();
        }));
        EXPECT_EQ(deliveries.size(), 1u);
        auto& done = std::get<ExportPartDone>(std::get<Reply>(deliveries.at(0)));
        EXPECT_EQ(done.request.session, 3u);
        EXPECT_EQ(done.request.request_id, last_request_id);
        EXPECT_EQ(done.request.export_id, 7u);
        return std::move(done.part);
    }
    std::string whole(const replay::WantedTable& wanted) {
        const auto file = past->open();
        std::ostringstream out;
        EXPECT_TRUE(replay::write_table({**file, executor}, wanted, out));
        return out.str();
    }

    recording::TemporaryFolder folder;
    run_file::DataFolder data{*run_file::DataFolder::open(folder.path())};
    base::InlineExecutor executor;
    Outbox outbox{[] {}};
    std::uint64_t last_request_id = 0;
    SteadyClock clock;
    JobTurns turns{1, clock};
    jobs::JobQueue jobs{{.name = "export", .threads_max = 8}};
    const ExportJob::Tools tools{jobs, turns, outbox};
    std::optional<replay::StoredRun> past;
};

TEST_F(ExportJobTest, PartsPutTogetherAreTheTable) {
    record(300, 100);
    const replay::WantedTable wanted{.table = RunTable::Organisms, .format = replay::Table::Format::JsonLines};
    ExportJob thread{tools, "ada", *past, wanted};
    std::string text;
    int parts = 0;
    for (bool last = false; !last; ++parts) {
        const auto part = next(thread);
        ASSERT_TRUE(part) << to_text(part.error());
        EXPECT_TRUE(part->last || part->text.size() >= ExportJob::part_bytes);
        text += part->text;
        last = part->last;
    }
    EXPECT_GT(parts, 2);
    EXPECT_EQ(text, whole(wanted));
    EXPECT_EQ(next(thread).error().code, RefusalCode::FailedPrecondition);
}

TEST_F(ExportJobTest, ReportsHowManyGenerationsAreLeftOut) {
    const auto run_id = replay::record_other_model(data.file_of("w"), recording::small_world())->identity().run_id;
    past.emplace(std::vector{data.file_of("w")}, run_id);
    for (const auto& [table, left_out] :
         {std::pair{RunTable::Organisms, 4u}, std::pair{RunTable::Lineage, 4u}, std::pair{RunTable::Generations, 0u}}) {
        ExportJob thread{tools, "ada", *past, {.table = table}};
        const auto part = next(thread);
        ASSERT_TRUE(part) << to_text(part.error());
        EXPECT_EQ(part->generations_left_out, left_out);
    }
}

TEST_F(ExportJobTest, AnErrorIsReportedInsteadOfAPart) {
    record(2);
    ExportJob thread{tools, "ada", *past, {.table = RunTable::Population, .generation = 7}};
    const auto part = next(thread);
    ASSERT_FALSE(part);
    EXPECT_EQ(part.error().code, RefusalCode::NotFound);
    EXPECT_EQ(part.error().violations.at(0).field, "generation");
}

TEST_F(ExportJobTest, AnAbandonedExportIsCancelledAndNeverCutShort) {
    record(300);
    ExportJob thread{tools, "ada", *past, {.table = RunTable::Organisms}, std::chrono::milliseconds{1}};
    ASSERT_TRUE(wait_until([&] { return thread.finished(); }));
    const auto part = next(thread);
    ASSERT_FALSE(part);
    EXPECT_THAT(part.error().message, HasSubstr("was cancelled"));
}

TEST_F(ExportJobTest, StoppingEndsASimulationUnderWay) {
    record(300, 1'000'000); // all but the first and the last are simulated again
    ExportJob thread{tools, "ada", *past, {.table = RunTable::Population, .generation = 299}};
    thread.cancel(refusal(RefusalCode::Aborted, "not wanted"));
    const auto part = next(thread);
    ASSERT_FALSE(part);
    ASSERT_TRUE(wait_until([&] { return thread.finished(); }));
}

TEST_F(ExportJobTest, ACancelledExportSaysWhy) {
    record(300);
    ExportJob thread{tools, "ada", *past, {.table = RunTable::Organisms}};
    const std::stop_token never;
    ASSERT_TRUE(next(thread));
    JobTurns::Turn holds_all{turns, "test", never}; // once the job waits for its client, or for its turn
    thread.next({.session = 3, .request_id = 9, .export_id = 7});
    thread.cancel(refusal(RefusalCode::Aborted, "another user needs the place"));
    ASSERT_TRUE(wait_until([&] { return thread.finished(); })) << "a cancelled job needs no turn";
    bool is_reported = false;
    for (const Delivery& delivery : outbox.take().deliveries) {
        const auto& part = std::get<ExportPartDone>(std::get<Reply>(delivery)).part;
        EXPECT_TRUE(!part || !part->last) << "a table that is cut short must not look complete";
        is_reported = !part && part.error().message == "another user needs the place";
    }
    EXPECT_TRUE(is_reported);
}

TEST_F(ExportJobTest, CancellingNeverMakesATableLookComplete) {
    record(300);
    for (int i = 0; i < 20; ++i) {
        ExportJob thread{tools, "ada", *past, {.table = RunTable::Organisms}};
        thread.next({.session = 3, .request_id = 9, .export_id = 7});
        for (int nap = 0; nap < i; ++nap) {
            take_a_nap();
        }
        thread.cancel(refusal(RefusalCode::Aborted, "not wanted"));
        ASSERT_TRUE(wait_until([&] { return thread.finished(); }));
        for (const Delivery& delivery : outbox.take().deliveries) {
            const auto& part = std::get<ExportPartDone>(std::get<Reply>(delivery)).part;
            EXPECT_TRUE(!part || !part->last);
        }
    }
}

TEST_F(ExportJobTest, AnExportThatWaitsForItsClientLetsOthersCompute) {
    record(300);
    const replay::WantedTable wanted{.table = RunTable::Organisms};
    ExportJob slow{tools, "eve", *past, wanted}; // computes its second part, then waits
    ASSERT_TRUE(next(slow));
    ExportJob quick{tools, "ada", *past, wanted};
    for (bool last = false; !last;) {
        const auto part = next(quick);
        ASSERT_TRUE(part) << to_text(part.error());
        last = part->last;
    }
    EXPECT_FALSE(slow.finished());
}

} // namespace
} // namespace evod::runtime
