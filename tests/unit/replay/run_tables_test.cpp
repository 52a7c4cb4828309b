// Run tables of files that do not retain every generation, most of them of another model version.
#include "server/base/inline_executor.h"
#include "server/replay/run_tables.h"
#include "server/replay/stored_run.h"
#include "tests/support/waiting.h"
#include "tests/unit/recording/recorded_run.h"
#include "tests/unit/replay/other_model.h"

#include <gmock/gmock.h>

#include <sstream>

namespace evod::replay {
namespace {

using namespace run_file;
using namespace recording;

using base::RefusalCode;
using testing::ElementsAre;
using testing::HasSubstr;

class OtherModel : public testing::Test {
  protected:
    void record(const parameters::Parameters& parameters) {
        file = replay::record_other_model(folder.path() + "/w.evod", parameters);
    }
    base::Result<void> write(const WantedTable& wanted) {
        std::ostringstream text;
        const auto written = write_table({*file, executor}, wanted, text);
        lines.clear();
        std::istringstream rows{text.str()};
        for (std::string line; std::getline(rows, line);) {
            lines.push_back(line);
        }
        return written;
    }
    /// Of every row of a table, in order, each once.
    std::vector<std::string> generations() const {
        std::vector<std::string> found;
        for (std::size_t i = 1; i < lines.size(); ++i) {
            if (const std::string generation = lines[i].substr(0, lines[i].find(','));
                found.empty() || found.back() != generation) {
                found.push_back(generation);
            }
        }
        return found;
    }
    std::string row_of(const std::string& organism) const {
        for (const std::string& line : lines) {
            if (line.starts_with(organism + ",")) {
                return line;
            }
        }
        return "none";
    }

    recording::TemporaryFolder folder;
    base::InlineExecutor executor;
    std::unique_ptr<run_file::RunFile> file;
    std::vector<std::string> lines;
};

TEST_F(OtherModel, LivesThatEndWithinAGapHaveAnUnknownCause) {
    parameters::Parameters colony = recording::small_world();
    colony.reproduction = parameters::Reproduction::Births;
    colony.births = parameters::Births::Asexual;
    colony.lifespan_s = 3 * colony.generation_s;
    colony.migration_epoch = 100;
    record(colony);
    ASSERT_TRUE(write({.table = RunTable::Births}));
    std::size_t unknown = 0;
    for (const std::string& line : lines) {
        unknown += line.find(",unknown,") != std::string::npos;
        EXPECT_THAT(line, testing::Not(HasSubstr(",replaced,"))) << "there are no migrants";
    }
    EXPECT_GT(unknown, 0u);

    int asked = 0;
    const base::StopCheck stop{[&] { return ++asked > 2; }};
    std::ostringstream part;
    EXPECT_FALSE(write_table({*file, executor, stop}, {.table = RunTable::Births}, part));
    EXPECT_EQ(asked, 3);
}

/// Every table asks often whether it is to stop, also about generations that it leaves out.
TEST_F(OtherModel, StoppedTablesEndAtTheNextGeneration) {
    record(recording::small_world());
    for (const RunTable table : {RunTable::Generations, RunTable::Organisms, RunTable::Lineage, RunTable::Population}) {
        int asked = 0, allowed = 1'000'000;
        const base::StopCheck stop{[&] { return ++asked > allowed; }};
        std::ostringstream whole, part;
        const WantedTable wanted{.table = table};
        ASSERT_TRUE(write_table({*file, executor, stop}, wanted, whole));
        const int needed = asked;
        EXPECT_GE(needed, table == RunTable::Population ? 1 : 8) << "as many as there are generations";
        for (allowed = 0; allowed < needed; ++allowed) {
            asked = 0;
            part.str("");
            const auto written = write_table({*file, executor, stop}, wanted, part);
            ASSERT_FALSE(written);
            EXPECT_EQ(written.error().code, RefusalCode::Unavailable);
            EXPECT_EQ(asked, allowed + 1) << "it ends at once";
        }
    }
    int asked = 0;
    EXPECT_LE(generations_out_of_reach(*file, base::StopCheck{[&] { return ++asked > 3; }}), 3u);
    EXPECT_EQ(asked, 4);
}

TEST(RunTables, StoppedWorkEndsAmidTheJournalOrASimulation) {
    const recording::TemporaryFolder folder;
    run_file::DataFolder data{*run_file::DataFolder::open(folder.path())};
    RunFile::Options options;
    options.keep_every = 1'000'000;
    recording::StorageThread thread{options};
    recording::RecordedRun run{data, thread};
    while (run.world().moment().generation <= 5) {
        run.advance(1);
    }
    ASSERT_TRUE(wait_until([&] { return thread.idle(); }));
    const auto file = RunFile::open_read_only(data.file_of("w"));
    ASSERT_TRUE(file);
    ASSERT_TRUE((*file)->pin_snapshot());
    base::InlineExecutor executor;
    int asked = 0;
    std::ostringstream text;
    const base::StopCheck stop{[&] { return ++asked > 100; }};
    const auto written = write_table({**file, executor, stop}, {.table = RunTable::Population, .generation = 4}, text);
    ASSERT_FALSE(written);
    EXPECT_EQ(written.error().code, RefusalCode::Unavailable);
    EXPECT_EQ(asked, 101);
    EXPECT_EQ(world_changes(**file, 0, base::StopCheck{[] { return true; }}).error().code, RefusalCode::Unavailable);
    const StoredRun stored{{data.file_of("w")}, (*file)->identity().run_id};
    EXPECT_EQ(stored.start_seek({}, {}, executor, base::StopCheck{[] { return true; }}).error().code,
              RefusalCode::Unavailable);
    EXPECT_EQ(stored.new_records(0, base::StopCheck{[] { return true; }}).error().code, RefusalCode::Unavailable);
}

TEST_F(OtherModel, LineageLeavesOutWhatIsPurgedOrUnknown) {
    parameters::Parameters parameters = recording::small_world();
    parameters.migration = evolution::Topology::None;
    record(parameters);
    auto written = write({.table = RunTable::Lineage});
    ASSERT_TRUE(written) << to_text(written.error());
    EXPECT_THAT(generations(), ElementsAre("1", "4", "7", "8"));
    EXPECT_EQ(generations_out_of_reach(*file), 4u);
    EXPECT_THAT(row_of("4,0,11"), HasSubstr("4,0,11,,,,,,,")) << "its parents are in a generation that is not held";
    EXPECT_THAT(row_of("8,0,11"), HasSubstr("8,0,11,7,0,"));

    written = write({.table = RunTable::Lineage, .of = OrganismName{8, 0, 11}});
    ASSERT_TRUE(written) << to_text(written.error());
    EXPECT_THAT(generations(), ElementsAre("8", "7"));

    written = write({.table = RunTable::Lineage, .first_generation = 5});
    ASSERT_TRUE(written) << to_text(written.error());
    EXPECT_THAT(generations(), ElementsAre("7", "8"));
    EXPECT_THAT(row_of("8,0,11"), HasSubstr("8,0,11,7,0,"));
    written = write({.table = RunTable::Lineage, .first_generation = 8});
    ASSERT_TRUE(written) << to_text(written.error());
    EXPECT_THAT(generations(), ElementsAre("8"));
    EXPECT_THAT(row_of("8,0,11"), HasSubstr("8,0,11,7,0,")) << "its parents are known";
    EXPECT_EQ(write({.table = RunTable::Lineage, .first_generation = 9}).error().code, RefusalCode::NotFound);
}

TEST_F(OtherModel, LineageHasNoParentsWhereMigrantsMayHaveCome) {
    parameters::Parameters parameters = recording::small_world();
    parameters.migration_epoch = 1;
    record(parameters);
    const auto written = write({.table = RunTable::Lineage});
    ASSERT_TRUE(written) << to_text(written.error());
    EXPECT_THAT(generations(), ElementsAre("1", "4", "7", "8"));
    EXPECT_THAT(row_of("8,0,11"), HasSubstr("8,0,11,,,,,,,"));
    EXPECT_TRUE(row_of("7,0,11").ends_with(",,")) << row_of("7,0,11");
}

TEST_F(OtherModel, APurgedGenerationIsRefusedWithTheNearest) {
    record(recording::small_world());
    for (const auto& [wanted, field] :
         {std::pair{WantedTable{.table = RunTable::Population, .generation = 5}, "generation"},
          std::pair{WantedTable{.table = RunTable::Lineage, .of = OrganismName{5, 0, 0}}, "of.generation"}}) {
        const auto refused = write(wanted).error();
        EXPECT_EQ(refused.code, RefusalCode::FailedPrecondition);
        ASSERT_EQ(refused.violations.size(), 1u) << to_text(refused);
        EXPECT_EQ(refused.violations[0].field, field);
        EXPECT_THAT(refused.violations[0].allowed, HasSubstr("4 and 7"));
    }
    EXPECT_TRUE(write({.table = RunTable::Population, .generation = 4}));
    EXPECT_TRUE(write({.table = RunTable::Population}));
}

} // namespace
} // namespace evod::replay
