#include "client/viewer/shell/recent_servers.h"

#include "tests/support/temporary_folder.h"

#include <gmock/gmock.h>
#include <sys/stat.h>

#include <cstdlib>
#include <fstream>
#include <iterator>

namespace evod::viewer {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

struct RecentServersTest : testing::Test {
    void write(const std::string& text) const {
        std::filesystem::create_directories(file.parent_path());
        std::ofstream{file} << text;
    }
    std::string read() const {
        std::ifstream in{file};
        return {std::istreambuf_iterator<char>{in}, {}};
    }
    support::TemporaryFolder temporary;
    const std::filesystem::path folder = temporary.path(), file = folder / "evod" / "recent_servers";
};

TEST_F(RecentServersTest, ListsTheNewestFirstAndEachOnce) {
    RecentServers recent{file};
    EXPECT_TRUE(recent.addresses().empty());
    for (const char* host : {"a", "b", "a"}) {
        recent.add({.host = host, .port = 7744});
    }
    EXPECT_THAT(RecentServers{file}.addresses(), ElementsAre("a:7744", "b:7744"));
    EXPECT_EQ(recent.problem(), "");
    EXPECT_EQ(read(), "a:7744\nb:7744\n");
}

TEST_F(RecentServersTest, OnlyTheOwnerCanReadTheFile) {
    RecentServers{file}.add({.host = "a", .port = 1});
    struct stat about {};
    ASSERT_EQ(stat(file.c_str(), &about), 0);
    EXPECT_EQ(about.st_mode & 0777, 0600u);
}

TEST_F(RecentServersTest, DropsTheOldest) {
    RecentServers recent{file};
    for (std::uint16_t port = 1; port <= 12; ++port) {
        recent.add({.host = "a", .port = port});
    }
    const RecentServers again{file};
    ASSERT_EQ(again.addresses().size(), RecentServers::kept_max);
    EXPECT_EQ(again.addresses().front(), "a:12");
    EXPECT_EQ(again.addresses().back(), "a:3");
}

TEST_F(RecentServersTest, ReportsAnInvalidFileAndKeepsIt) {
    const std::string bad = "lab:7744\nthis is not an address\n";
    write(bad);
    RecentServers recent{file};
    EXPECT_TRUE(recent.addresses().empty());
    EXPECT_THAT(recent.problem(), HasSubstr("recent_servers:2: "));
    recent.add({.host = "a", .port = 1});
    EXPECT_THAT(recent.addresses(), ElementsAre("a:1")) << "until the program ends";
    EXPECT_EQ(read(), bad);
}

TEST_F(RecentServersTest, ReportsAFileThatCannotBeWritten) {
    std::ofstream{folder / "evod"} << "a file in place of the folder";
    RecentServers recent{file};
    recent.add({.host = "a", .port = 1});
    EXPECT_NE(recent.problem(), "");
    EXPECT_THAT(recent.addresses(), ElementsAre("a:1"));
}

} // namespace
} // namespace evod::viewer
