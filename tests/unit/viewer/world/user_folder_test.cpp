#include "client/viewer/world/user_folder.h"

#include <gtest/gtest.h>

#include <cstdlib>

namespace evod::viewer {
namespace {

TEST(UserFolder, IsTheOneNamedOrBelowHome) {
    const char* const variable = "EVOD_TEST_FOLDER";
    setenv(variable, "/data", 1);
    EXPECT_EQ(user_folder(variable, ".local/share"), "/data/evod");
    const char* const home = std::getenv("HOME");
    ASSERT_NE(home, nullptr);
    for (const char* ignored : {"", "relative"}) {
        setenv(variable, ignored, 1);
        EXPECT_EQ(user_folder(variable, ".local/share"), std::filesystem::path{home} / ".local/share/evod");
    }
}

} // namespace
} // namespace evod::viewer
