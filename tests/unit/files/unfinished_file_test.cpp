#include "proto/files/unfinished_file.h"

#include "tests/support/temporary_folder.h"

#include <gtest/gtest.h>

#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <filesystem>
#include <sstream>

namespace evod::files {
namespace {

class UnfinishedFileTest : public testing::Test {
  protected:
    std::string contents() const {
        std::stringstream text;
        text << std::ifstream{path}.rdbuf();
        return text.str();
    }

    support::TemporaryFolder temporary;
    const std::string path = temporary.path() + "/file", part = path + ".part";
};

TEST_F(UnfinishedFileTest, GetsItsNameWhenComplete) {
    std::ofstream{path} << "before";
    std::ofstream{part} << "of an ended program";
    UnfinishedFile file{path};
    file.stream() << "after";
    EXPECT_EQ(contents(), "before");
    EXPECT_TRUE(file.finish());
    EXPECT_EQ(contents(), "after");
    EXPECT_FALSE(std::filesystem::exists(part));
}

TEST_F(UnfinishedFileTest, LeavesNothingIfItIsNotFinished) {
    UnfinishedFile{path}.stream() << "half";
    EXPECT_TRUE(std::filesystem::is_empty(temporary.path()));
}

TEST_F(UnfinishedFileTest, IsDeletedBySignals) {
    for (const int signal : {SIGINT, SIGTERM, SIGHUP}) {
        const pid_t child = ::fork();
        if (child == 0) {
            UnfinishedFile file{path};
            file.stream() << "half" << std::flush;
            std::raise(signal);
            ::_exit(1);
        }
        int status = 0;
        ASSERT_EQ(::waitpid(child, &status, 0), child);
        EXPECT_TRUE(WIFSIGNALED(status));
        EXPECT_TRUE(std::filesystem::is_empty(temporary.path()));
    }
}

TEST_F(UnfinishedFileTest, ADeviceIsWrittenDirectly) {
    UnfinishedFile file{"/dev/full"};
    file.stream() << "text";
    EXPECT_FALSE(file.finish());
    UnfinishedFile other{"/dev/null"};
    other.stream() << "text";
    EXPECT_TRUE(other.finish());
    EXPECT_TRUE(std::filesystem::is_character_file("/dev/null"));
}

TEST_F(UnfinishedFileTest, KeepsALinkToTheFile) {
    const std::string link = temporary.path() + "/link";
    std::ofstream{path} << "before";
    std::filesystem::create_symlink(path, link);
    UnfinishedFile file{link};
    file.stream() << "after";
    EXPECT_TRUE(file.finish());
    EXPECT_TRUE(std::filesystem::is_symlink(link));
    EXPECT_EQ(contents(), "after");
}

TEST_F(UnfinishedFileTest, FailsInAMissingFolder) {
    UnfinishedFile file{temporary.path() + "/none/file"};
    EXPECT_FALSE(file.stream());
    EXPECT_FALSE(file.finish());
}

} // namespace
} // namespace evod::files
