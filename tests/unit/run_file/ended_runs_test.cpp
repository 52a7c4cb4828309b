#include "server/run_file/ended_runs.h"

#include "server/run_file/data_folder.h"
#include "tests/unit/recording/recorded_run.h"

#include <gmock/gmock.h>

#include <chrono>
#include <filesystem>
#include <fstream>

namespace evod::run_file {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

class EndedRunsTest : public testing::Test {
  protected:
    static std::string id(int number) { return std::string(31, '0') + std::to_string(number); }
    /// A file of 4 bytes, with a log of 2 bytes, that ended `minute` minutes after the others.
    std::string add(const std::string& name, int minute) {
        const std::string path = folder_.path() + "/" + name;
        std::ofstream{path} << "text";
        std::ofstream{path + "-wal"} << "hi";
        std::filesystem::last_write_time(path, std::filesystem::file_time_type{} + std::chrono::minutes{minute});
        return path;
    }
    std::vector<std::string> surplus(std::uint64_t keep, const std::string& world = {}) {
        std::vector<std::string> paths;
        for (const EndedRun& run : *surplus_runs(folder_.path(), keep, world)) {
            paths.push_back(run.path);
        }
        return paths;
    }

    recording::TemporaryFolder folder_;
    const std::string old_a_ = add("a." + id(2) + ".evod", 1), new_a_ = add("a." + id(1) + ".evod", 3),
                      b_ = add("b." + id(3) + ".evod", 2), present_ = add("a.evod", 4),
                      aside_ = add("a.damaged-1.evod", 0);
};

TEST_F(EndedRunsTest, TheOldestOfEachWorldAreSurplus) {
    EXPECT_THAT(surplus(0), ElementsAre(old_a_, b_, new_a_));
    EXPECT_THAT(surplus(1), ElementsAre(old_a_));
    EXPECT_THAT(surplus(2), IsEmpty());
    EXPECT_THAT(surplus(0, "b"), ElementsAre(b_));
    EXPECT_THAT(surplus(0, "c"), IsEmpty());
    EXPECT_FALSE(surplus_runs(folder_.path() + "/none", 0));
}

TEST_F(EndedRunsTest, OnlySurplusRunsAreDeleted) {
    const std::uint64_t before = bytes_of_folder(folder_.path());
    EXPECT_EQ(before, 30u);
    EXPECT_EQ(bytes_of_run(old_a_), 6u);
    const auto deleted = prune(folder_.path(), 1);
    ASSERT_TRUE(deleted);
    EXPECT_THAT(deleted->failures, IsEmpty());
    ASSERT_EQ(deleted->deleted.size(), 1u);
    EXPECT_EQ(deleted->deleted.front().world, "a");
    EXPECT_EQ(deleted->deleted.front().bytes, 6u);
    EXPECT_EQ(bytes_of_folder(folder_.path()), before - 6);
    EXPECT_FALSE(std::filesystem::exists(old_a_ + "-wal"));
    EXPECT_TRUE(std::filesystem::exists(aside_));
}

TEST_F(EndedRunsTest, FilesOfPersonsAreNoRuns) {
    for (const char* name : {"a.backup.evod", "a.notes.evod", "a.x.y.evod"}) {
        add(name, 0);
    }
    add("a." + id(5) + ".copy.evod", 0);
    add("a." + std::string(32, 'X') + ".evod", 0);
    std::filesystem::create_symlink(present_, folder_.path() + "/a." + id(6) + ".evod");
    std::filesystem::create_directories(folder_.path() + "/a." + id(7) + ".evod/within");
    EXPECT_THAT(surplus(0), ElementsAre(old_a_, b_, new_a_));
    EXPECT_THAT(surplus(1), ElementsAre(old_a_));
    EXPECT_THAT(prune(folder_.path(), 0)->failures, IsEmpty());
    EXPECT_TRUE(std::filesystem::exists(folder_.path() + "/a.backup.evod"));
}

} // namespace
} // namespace evod::run_file
