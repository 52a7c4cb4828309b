#include "server/files/regular_file.h"

#include "tests/support/temporary_folder.h"

#include <gtest/gtest.h>

#include <fstream>

namespace evod::files {
namespace {

using base::RefusalCode;

TEST(RegularFile, RefusesWithTheCodeOfTheErrorAndThePath) {
    const support::TemporaryFolder temporary;
    const std::string path = temporary.path() + "/file";
    EXPECT_EQ(read_file(path, "a text", 1).error().code, RefusalCode::NotFound);
    EXPECT_EQ(read_file(path, "a text", 1).error().message, path + ": cannot be read: No such file or directory");
    EXPECT_EQ(read_file(temporary.path(), "a text", 1).error().code, RefusalCode::FailedPrecondition);
    EXPECT_EQ(read_file("/proc/self/mem", "a text", 1).error().code, RefusalCode::Unavailable);
    std::ofstream{path} << "12345";
    EXPECT_EQ(read_file(path, "a text", 4).error().code, RefusalCode::InvalidArgument);
    EXPECT_EQ(*read_file(path, "a text", 5), "12345");
}

} // namespace
} // namespace evod::files
