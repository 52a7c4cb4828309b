#include "server/files/regular_file.h"

#include "tests/support/temporary_folder.h"

#include <gmock/gmock.h>

#include <unistd.h>

#include <filesystem>
#include <fstream>

namespace evod::files {
namespace {

using base::RefusalCode;
using testing::HasSubstr;

class RegularFileTest : public testing::Test {
  protected:
    void write(const std::string& bytes) const { std::ofstream{path, std::ios::binary} << bytes; }

    support::TemporaryFolder temporary;
    const std::string& folder = temporary.path();
    const std::string path = folder + "/file";
};

TEST_F(RegularFileTest, IsReadCompletely) {
    const std::string bytes(200'000, 'x');
    write(bytes);
    EXPECT_EQ(*read_file(path, "a text", 1 << 20), bytes);
    EXPECT_EQ(*read_file(path, "a text", bytes.size()), bytes);
    write("");
    EXPECT_EQ(*read_file(path, "a text", 0), "");
}

TEST_F(RegularFileTest, IsReadThoughTheKernelReportsSizeZero) {
    EXPECT_THAT(*read_file("/proc/self/stat", "a text", 1 << 20), HasSubstr(std::to_string(::getpid())));
}

TEST_F(RegularFileTest, IsRefusedIfTooLarge) {
    write("12345");
    const auto refused = read_file(path, "a text", 4);
    ASSERT_FALSE(refused);
    EXPECT_EQ(refused.error().code, RefusalCode::InvalidArgument);
    EXPECT_EQ(refused.error().message, path + ": too large for a text (4 bytes at most)");
    EXPECT_THAT(read_file("/proc/self/stat", "a text", 4).error().message, HasSubstr("too large"));
}

TEST_F(RegularFileTest, RefusesPipesFoldersAndDevicesAtOnce) {
    ASSERT_EQ(::mkfifo(path.c_str(), 0600), 0);
    for (const auto& [named, kind] :
         {std::pair{path, "a pipe"}, {folder, "a folder"}, {std::string{"/dev/zero"}, "a device"}}) {
        const auto refused = read_file(named, "a text", 1 << 20);
        ASSERT_FALSE(refused);
        EXPECT_EQ(refused.error().code, RefusalCode::FailedPrecondition);
        EXPECT_EQ(refused.error().message, named + ": this is " + kind + ", not a text");
    }
}

TEST_F(RegularFileTest, IsNotFoundIfMissing) {
    const auto refused = read_file(path, "a text", 1);
    ASSERT_FALSE(refused);
    EXPECT_EQ(refused.error().code, RefusalCode::NotFound);
    EXPECT_EQ(refused.error().message, path + ": cannot be read: No such file or directory");
}

TEST_F(RegularFileTest, ALinkIsFollowedUnlessRefused) {
    write("1");
    const std::string link = folder + "/link";
    std::filesystem::create_symlink(path, link);
    EXPECT_TRUE(RegularFile::open(link, "a text"));
    EXPECT_FALSE(RegularFile::open(link, "a text", Links::Refused));
}

TEST_F(RegularFileTest, ReadsFromAnyOffset) {
    write("0123456789");
    const auto file = RegularFile::open(path, "a text");
    ASSERT_TRUE(file);
    char bytes[4];
    const auto into = std::as_writable_bytes(std::span{bytes});
    EXPECT_EQ(file->read_at(3, into), 4u);
    EXPECT_EQ(std::string(bytes, 4), "3456");
    EXPECT_EQ(file->read_at(8, into), 2u);
    EXPECT_EQ(file->read_at(20, into), 0u);
}

} // namespace
} // namespace evod::files
