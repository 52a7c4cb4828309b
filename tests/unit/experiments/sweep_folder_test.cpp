#include "server/experiments/sweep_folder.h"

#include "server/experiments/atomic_file.h"
#include "tests/unit/recording/recorded_run.h"

#include <gmock/gmock.h>

#include <fstream>
#include <iterator>

namespace evod::experiments {
namespace {

using evolution::Outcome;
using testing::EndsWith;
using testing::HasSubstr;
using testing::Not;
using testing::StartsWith;

Sweep two_cells(const std::string& more = "") {
    const auto sweep = parse_sweep(R"({"grid": {"food_count": [1, 2]}, "replicates": 2, "generations": 1)" + more + "}",
                                   [](const std::string&) { return parameters::Experiment{}; });
    EXPECT_TRUE(sweep) << to_text(sweep.error());
    return *sweep;
}

void write(const std::string& path, const std::string& text) {
    std::ofstream{path, std::ios::binary} << text;
}

std::string text_of(const std::string& path) {
    std::ifstream file{path, std::ios::binary};
    return {std::istreambuf_iterator<char>{file}, {}};
}

TEST(SweepFolder, OfAnotherSweepIsRefusedWithTheDifferences) {
    const recording::TemporaryFolder folder;
    const Sweep sweep = two_cells();
    ASSERT_TRUE(SweepFolder::open(folder.path() + "/a/b", sweep));
    ASSERT_TRUE(SweepFolder::open(folder.path() + "/a/b", sweep)); // again
    const auto refused = [&](const Sweep& other) {
        const auto opened = SweepFolder::open(folder.path() + "/a/b", other);
        EXPECT_FALSE(opened);
        return opened ? "" : to_text(opened.error());
    };
    const std::string other_seed = refused(two_cells(R"(, "seed": 5)"));
    EXPECT_THAT(other_seed, HasSubstr("contains the results of another sweep"));
    EXPECT_THAT(other_seed, HasSubstr("\n  seed: got 1, allowed 5"));
    EXPECT_THAT(other_seed, HasSubstr("\n  sweep file: got a changed text"));
    EXPECT_THAT(other_seed, Not(HasSubstr("\n  model")));
    EXPECT_THAT(
        refused(two_cells(R"(, "experiment": {"poison_count": 7})")),
        HasSubstr(
            R"(parameters: got {  "generation_limit": 1}, allowed {  "poison_count": 7,  "generation_limit": 1})"));
    EXPECT_THAT(refused(two_cells(R"(, "experiment": "moved")")),
                Not(HasSubstr("parameters:"))); // the same by another file

    const std::string path = folder.path() + "/a/b/sweep.txt", text = text_of(path);
    std::string older = text;
    older.replace(older.find("# evod: "), 8, "# evod: 0.1.0, ");
    write(path, older);
    EXPECT_THAT(refused(sweep), HasSubstr("\n  evod: got 0.1.0, "));
    older = text;
    older.replace(older.find("# model: "), 9, "# model: 9");
    write(path, older);
    EXPECT_THAT(refused(sweep), HasSubstr("\n  model: got 9"));
    write(path, text + "x");
    EXPECT_THAT(refused(sweep), HasSubstr("sweep.txt"));
}

/// A grid of the first `cells` counts of food, with seeds of the sweep.
Sweep growing(int cells, int replicates, const std::string& more = "") {
    std::string values;
    for (int cell = 1; cell <= cells; ++cell) {
        values += (cell > 1 ? ", " : "") + std::to_string(cell);
    }
    const auto sweep = parse_sweep(R"({"grid": {"food_count": [)" + values + R"(]}, "replicates": )" +
                                       std::to_string(replicates) + R"(, "generations": 1)" + more + "}",
                                   [](const std::string&) { return parameters::Experiment{}; });
    EXPECT_TRUE(sweep) << to_text(sweep.error());
    return *sweep;
}

TEST(SweepFolder, FinishedRunsStayValidInALargerSweep) {
    const recording::TemporaryFolder place;
    const Sweep small = growing(2, 2);
    const auto before = SweepFolder::open(place.path(), small);
    ASSERT_TRUE(before);
    write(before->part_of(3), "1,1,7\n" + to_text(RunEnd{Outcome::GenerationLimit, 1}));
    for (const auto& [cells, replicates] : {std::pair{2, 3}, std::pair{3, 11}, std::pair{11, 11}}) {
        const Sweep large = growing(cells, replicates);
        const auto refused = SweepFolder::open(place.path(), large, SweepFolder::Extension::Refused);
        ASSERT_FALSE(refused);
        EXPECT_THAT(refused.error().message, HasSubstr("without --array-index"));
        const auto after = SweepFolder::open(place.path(), large);
        ASSERT_TRUE(after) << to_text(after.error());
        const std::size_t run = static_cast<std::size_t>(replicates) + 1;
        EXPECT_TRUE(after->end_of(run, SweepFolder::Wanted::Rows)) << after->name_of(run);
        EXPECT_FALSE(after->end_of(run + 1, SweepFolder::Wanted::Rows));
    }
    const auto smaller = SweepFolder::open(place.path(), small);
    ASSERT_FALSE(smaller);
    EXPECT_THAT(smaller.error().message, HasSubstr("can get more replicates or seeds"));
}

TEST(SweepFolder, OtherSeedsOrValuesDoNotExtendASweep) {
    const recording::TemporaryFolder place;
    ASSERT_TRUE(SweepFolder::open(place.path(), growing(2, 2)));
    EXPECT_FALSE(SweepFolder::open(place.path(), growing(2, 3, R"(, "seed": 5)")));
    EXPECT_FALSE(SweepFolder::open(place.path(), growing(2, 3, R"(, "every": 2)")));
    const auto other = parse_sweep(R"({"grid": {"food_count": [0, 1, 2]}, "replicates": 2, "generations": 1})",
                                   [](const std::string&) { return parameters::Experiment{}; });
    EXPECT_FALSE(SweepFolder::open(place.path(), *other));
}

TEST(SweepFolder, WithResultsOfAnUnknownSweepIsRefused) {
    const recording::TemporaryFolder folder;
    write(folder.path() + "/runs.csv", "mine");
    const Sweep sweep = two_cells();
    const auto opened = SweepFolder::open(folder.path(), sweep);
    ASSERT_FALSE(opened);
    EXPECT_THAT(opened.error().message, HasSubstr("/runs.csv exists, but the sweep.txt"));
    EXPECT_EQ(text_of(folder.path() + "/runs.csv"), "mine");
    EXPECT_FALSE(SweepFolder::open(folder.path() + "/runs.csv", sweep)); // a file
}

TEST(SweepFolder, ARunIsFinishedWhenItsPartIsComplete) {
    const recording::TemporaryFolder place;
    const Sweep sweep = two_cells();
    const auto folder = SweepFolder::open(place.path(), sweep);
    ASSERT_TRUE(folder);
    using Wanted = SweepFolder::Wanted;
    EXPECT_EQ(folder->name_of(3), "cell-1-replicate-1");
    EXPECT_FALSE(folder->end_of(3, Wanted::Rows));
    for (const char* torn :
         {"", "1,1\n", "# ended by", "# ended by generation_limit, rows: 1", "# ended by luck, rows: 1\n",
          "# ended by generation_limit, rows: \n", "# ended by generation_limit, rows: 1 \n"}) {
        write(folder->part_of(3), std::string{"1,1,7\n"} + torn);
        EXPECT_FALSE(folder->end_of(3, Wanted::Rows)) << torn;
    }
    for (const Outcome outcome :
         {Outcome::TargetFitness, Outcome::Extinction, Outcome::Stagnation, Outcome::GenerationLimit}) {
        write(folder->part_of(3), "1,1,7\n" + to_text(RunEnd{outcome, 1}));
        ASSERT_TRUE(folder->end_of(3, Wanted::Rows));
        EXPECT_EQ(folder->end_of(3, Wanted::Rows)->outcome, outcome);
        EXPECT_EQ(folder->end_of(3, Wanted::Rows)->rows, 1u);
    }
    EXPECT_FALSE(folder->end_of(3, Wanted::RowsAndRunFile));
    ASSERT_TRUE(folder->create_run_file_folder());
    write(folder->run_file_of(3), "");
    EXPECT_TRUE(folder->end_of(3, Wanted::RowsAndRunFile));
}

TEST(SweepFolder, GathersPartsInOrderAfterTheProvenance) {
    const recording::TemporaryFolder place;
    const Sweep sweep = two_cells();
    const auto folder = SweepFolder::open(place.path(), sweep);
    ASSERT_TRUE(folder);
    for (std::size_t run = 0; run < 4; ++run) {
        write(folder->part_of(run), std::string(run == 2 ? 0 : 1 << 17, 'x') + std::to_string(run) + "\n" +
                                        to_text(RunEnd{run == 2 ? Outcome::Extinction : Outcome::GenerationLimit, 1}));
    }
    const std::string stray = AtomicFile::temporary_name(folder->part_of(1));
    write(stray, "of a killed process");
    const auto gathered = folder->gather();
    ASSERT_TRUE(gathered) << to_text(gathered.error());
    EXPECT_EQ(gathered->rows, 4u);
    EXPECT_EQ(gathered->runs,
              (std::map<Outcome, std::size_t>{{Outcome::Extinction, 1}, {Outcome::GenerationLimit, 3}}));
    EXPECT_FALSE(std::filesystem::exists(stray));
    const std::string table = text_of(folder->table()), provenance = text_of(place.path() + "/sweep.txt");
    EXPECT_THAT(table, StartsWith(provenance + "cell,replicate,seed,food_count,generation,island,end_tick,"));
    EXPECT_THAT(table, HasSubstr("\n2\n"));
    EXPECT_THAT(table, EndsWith("x3\n"));
    EXPECT_LT(table.find("0\nxxx"), table.find("\n2\n"));
    for (std::size_t begin = 0; begin < provenance.size(); begin = provenance.find('\n', begin) + 1) {
        EXPECT_EQ(provenance.substr(begin, 2), "# ");
    }
    ASSERT_TRUE(folder->gather()); // again
    EXPECT_EQ(text_of(folder->table()), table);
}

TEST(SweepFolder, NamesAPartThatWasChanged) {
    const recording::TemporaryFolder place;
    const Sweep sweep = two_cells();
    const auto folder = SweepFolder::open(place.path(), sweep);
    ASSERT_TRUE(folder);
    for (std::size_t run = 0; run < 4; ++run) {
        write(folder->part_of(run), (run == 1 ? "a\nb\n" : "a\n") + to_text(RunEnd{Outcome::GenerationLimit, 1}));
    }
    const auto gathered = folder->gather();
    ASSERT_FALSE(gathered);
    EXPECT_THAT(gathered.error().message, HasSubstr("cell-0-replicate-1.csv was changed"));
    EXPECT_FALSE(std::filesystem::exists(folder->table()));
}

TEST(SweepFolder, LineEndsOfOtherSystemsStayInTheComment) {
    const recording::TemporaryFolder place;
    const Sweep sweep = two_cells(",\r\n\"description\":\r\"x\"\r\n");
    ASSERT_TRUE(SweepFolder::open(place.path(), sweep));
    const std::string provenance = text_of(place.path() + "/sweep.txt");
    EXPECT_THAT(provenance, Not(HasSubstr("\r")));
    EXPECT_THAT(provenance, HasSubstr("\n#   \"description\":\n#   \"x\"\n"));
}

} // namespace
} // namespace evod::experiments
