#include "proto/files/input_file.h"

#include "tests/support/temporary_folder.h"

#include <gmock/gmock.h>

#include <unistd.h>

#include <filesystem>
#include <fstream>

namespace evod::files {
namespace {

using Kind = InputError::Kind;
using testing::HasSubstr;

class InputFileTest : public testing::Test {
  protected:
    void write(const std::string& bytes) const { std::ofstream{path, std::ios::binary} << bytes; }

    support::TemporaryFolder temporary;
    const std::string& folder = temporary.path();
    const std::string path = folder + "/file";
};

TEST_F(InputFileTest, IsReadCompletely) {
    const std::string bytes(200'000, 'x');
    write(bytes);
    EXPECT_EQ(*read_input(path, "a text", 1 << 20), bytes);
    EXPECT_EQ(*read_input(path, "a text", bytes.size()), bytes);
    write("");
    EXPECT_EQ(*read_input(path, "a text", 0), "");
}

TEST_F(InputFileTest, IsReadThoughTheKernelReportsSizeZero) {
    EXPECT_THAT(*read_input("/proc/self/stat", "a text", 1 << 20), HasSubstr(std::to_string(::getpid())));
}

TEST_F(InputFileTest, IsRefusedIfTooLarge) {
    write("12345");
    const auto refused = read_input(path, "a text", 4);
    ASSERT_FALSE(refused);
    EXPECT_EQ(refused.error().kind, Kind::TooLarge);
    EXPECT_EQ(refused.error().why, "too large for a text (4 bytes at most)");
    EXPECT_THAT(read_input("/proc/self/stat", "a text", 4).error().why, HasSubstr("too large"));
}

TEST_F(InputFileTest, RefusesPipesFoldersAndDevicesAtOnce) {
    ASSERT_EQ(::mkfifo(path.c_str(), 0600), 0);
    for (const auto& [named, kind] :
         {std::pair{path, "a pipe"}, {folder, "a folder"}, {std::string{"/dev/zero"}, "a device"}}) {
        const auto refused = read_input(named, "a text", 1 << 20);
        ASSERT_FALSE(refused);
        EXPECT_EQ(refused.error().kind, Kind::NotAFile);
        EXPECT_EQ(refused.error().why, std::string{"this is "} + kind + ", not a text");
    }
}

TEST_F(InputFileTest, IsNotFoundIfMissing) {
    const auto refused = read_input(path, "a text", 1);
    ASSERT_FALSE(refused);
    EXPECT_EQ(refused.error().kind, Kind::NotFound);
    EXPECT_EQ(refused.error().why, "cannot be read: No such file or directory");
}

TEST_F(InputFileTest, ALinkIsFollowedUnlessRefused) {
    write("1");
    const std::string link = folder + "/link";
    std::filesystem::create_symlink(path, link);
    EXPECT_TRUE(InputFile::open(link, "a text"));
    EXPECT_FALSE(InputFile::open(link, "a text", Links::Refused));
}

TEST_F(InputFileTest, ReadsFromAnyOffset) {
    write("0123456789");
    const auto file = InputFile::open(path, "a text");
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
