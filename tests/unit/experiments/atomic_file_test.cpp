#include "server/experiments/atomic_file.h"

#include "tests/unit/recording/recorded_run.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <iterator>

namespace evod::experiments {
namespace {

std::string contents_of(const std::string& path) {
    std::ifstream file{path, std::ios::binary};
    return {std::istreambuf_iterator<char>{file}, {}};
}

TEST(AtomicFile, IsCompleteOrAbsent) {
    const recording::TemporaryFolder folder;
    const std::string path = folder.path() + "/file";
    {
        AtomicFile file{path};
        file.write(std::string(1 << 20, 'x'));
    }
    EXPECT_TRUE(std::filesystem::is_empty(folder.path()));
    std::ofstream{path} << "before";
    AtomicFile file{path};
    file.write("new");
    EXPECT_EQ(contents_of(path), "before");
    ASSERT_TRUE(file.finish());
    EXPECT_EQ(contents_of(path), "new");
    EXPECT_EQ(std::distance(std::filesystem::directory_iterator{folder.path()}, {}), 1);
}

TEST(AtomicFile, ReportsWhyItCannotBeWritten) {
    AtomicFile file{"/nowhere/file"};
    EXPECT_FALSE(file.error().empty());
    file.write("x");
    const auto finished = file.finish();
    ASSERT_FALSE(finished);
    EXPECT_EQ(finished.error().message, "/nowhere/file cannot be written: No such file or directory");
    AtomicFile full{"/dev/full/file"};
    EXPECT_FALSE(full.finish());
}

TEST(AtomicFile, TemporaryNamesDifferAndAreRecognised) {
    const std::string name = AtomicFile::temporary_name("/a/file.csv");
    EXPECT_NE(name, AtomicFile::temporary_name("/a/file.csv"));
    EXPECT_TRUE(name.starts_with("/a/file.csv"));
    EXPECT_TRUE(AtomicFile::is_temporary(name));
    EXPECT_FALSE(AtomicFile::is_temporary("/a/file.csv"));
}

} // namespace
} // namespace evod::experiments
