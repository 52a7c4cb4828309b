#include "server/experiments/bundle.h"

#include "server/base/inline_executor.h"
#include "server/experiments/experiment_file.h"
#include "server/experiments/run_writer.h"
#include "tests/unit/recording/recorded_run.h"

#include <gmock/gmock.h>

#include <filesystem>
#include <fstream>
#include <iterator>
#include <set>

namespace evod::experiments {
namespace {

namespace fs = std::filesystem;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::Not;

class BundleTest : public testing::Test {
  protected:
    /// Records so many generations of a small world.
    void record(std::uint64_t generations, const simulation::FirstPopulation& first = {}) {
        simulation::World world{recording::small_world(), base::Seed{7}, first};
        RunWriter writer{run, "w", {1, 2}, world};
        ASSERT_TRUE(writer.follow(world));
        for (std::uint64_t ended = 0; ended < generations; ended += world.generation_over() ? 1 : 0) {
            if (world.generation_over()) {
                world.breed_next_generation(executor);
            }
            world.advance_tick(executor);
            ASSERT_TRUE(writer.follow(world));
        }
        ASSERT_TRUE(writer.finish());
    }
    base::Result<void> write(const std::string& folder_name) {
        auto file = run_file::RunFile::open_checked(run);
        EXPECT_TRUE(file);
        EXPECT_TRUE((*file)->pin_snapshot());
        return write_bundle({**file, executor}, folder.path() + "/" + folder_name);
    }
    std::set<std::string> names() const {
        std::set<std::string> found;
        for (const auto& file : fs::directory_iterator{folder.path() + "/bundle"}) {
            found.insert(file.path().filename().string());
        }
        return found;
    }
    std::string text_of(const std::string& name) const {
        std::ifstream file{folder.path() + "/bundle/" + name};
        return {std::istreambuf_iterator<char>{file}, {}};
    }

    const recording::TemporaryFolder folder;
    const std::string run = folder.path() + "/w.evod";
    base::InlineExecutor executor;
};

TEST_F(BundleTest, ContainsWhatRepeatsTheRun) {
    record(2);
    ASSERT_TRUE(write("bundle"));
    EXPECT_THAT(names(), ElementsAre("REPEAT.md", "SHA256SUMS", "events.csv", "experiment.json", "generations.csv",
                                     "lineage.csv", "notes.csv", "organisms.csv", "w.evod"));
    const auto experiment = load_experiment(folder.path() + "/bundle/experiment.json");
    ASSERT_TRUE(experiment) << to_text(experiment.error());
    EXPECT_EQ(experiment->seed, base::Seed{7});
    EXPECT_EQ(experiment->parameters, recording::small_world());
    EXPECT_THAT(text_of("REPEAT.md"), HasSubstr("evod run experiment.json --generations 2 --csv again.csv"));
    EXPECT_TRUE(run_file::RunFile::open_checked(folder.path() + "/bundle/w.evod"));
}

TEST_F(BundleTest, ChecksumsCoverAllOtherFiles) {
    record(1);
    ASSERT_TRUE(write("bundle"));
    std::set<std::string> expected = names(), listed;
    expected.erase("SHA256SUMS");
    std::istringstream sums{text_of("SHA256SUMS")};
    for (std::string line; std::getline(sums, line);) {
        ASSERT_GT(line.size(), 66u) << line;
        EXPECT_EQ(line.find_first_not_of("0123456789abcdef"), 64u) << line;
        EXPECT_EQ(line.substr(64, 2), "  ");
        listed.insert(line.substr(66));
    }
    EXPECT_EQ(listed, expected);
    const std::string command = "cd '" + folder.path() + "/bundle' && sha256sum --check --quiet SHA256SUMS";
    EXPECT_EQ(std::system(command.c_str()), 0);
}

TEST_F(BundleTest, AGivenPopulationIsPartOfIt) {
    const evolution::GeneMatrix genes = evolution::GeneMatrix::Constant(evolution::body_gene_count, 12, 100);
    record(1, std::make_shared<const std::vector<evolution::GeneMatrix>>(2, genes));
    ASSERT_TRUE(write("bundle"));
    EXPECT_TRUE(names().contains("population.csv"));
    EXPECT_THAT(text_of("REPEAT.md"), HasSubstr("--population population.csv"));
}

TEST_F(BundleTest, WithoutAGenerationNothingIsCompared) {
    record(0);
    ASSERT_TRUE(write("bundle"));
    EXPECT_THAT(text_of("REPEAT.md"), HasSubstr("No generation has ended"));
    EXPECT_THAT(text_of("REPEAT.md"), Not(HasSubstr("cmp again.csv")));
}

TEST_F(BundleTest, IsRefusedIfTheFolderExistsOrHasNoParent) {
    record(0);
    fs::create_directory(folder.path() + "/bundle");
    const auto exists = write("bundle");
    ASSERT_FALSE(exists);
    EXPECT_EQ(exists.error().code, base::RefusalCode::AlreadyExists);
    EXPECT_TRUE(fs::is_empty(folder.path() + "/bundle"));
    const auto nowhere = write("nowhere/bundle");
    ASSERT_FALSE(nowhere);
    EXPECT_THAT(nowhere.error().message, HasSubstr("--bundle: cannot create"));
}

TEST_F(BundleTest, ReplacesWhatAnEndedProgramLeftUnfinished) {
    record(0);
    const std::string part = folder.path() + "/bundle.part";
    fs::create_directory(part);
    std::ofstream{part + "/events.csv"} << "half";
    std::ofstream{part + "/note"} << "of the user";
    const auto other = write("bundle");
    ASSERT_FALSE(other);
    EXPECT_THAT(other.error().message, HasSubstr("bundle.part exists, and is not an unfinished bundle"));
    EXPECT_TRUE(fs::exists(part + "/note"));
    fs::remove(part + "/note");
    ASSERT_TRUE(write("bundle"));
    EXPECT_TRUE(names().contains("SHA256SUMS"));
    EXPECT_FALSE(fs::exists(part));
}

} // namespace
} // namespace evod::experiments
