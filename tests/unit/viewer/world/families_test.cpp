#include "client/viewer/world/families.h"

#include <gmock/gmock.h>

namespace evod::viewer {
namespace {

using testing::ElementsAre;

TEST(Families, AreOrderedBySize) {
    // 9 has one, 4 and 8 have two, ten others one each, and 5 has the rest.
    const std::uint32_t founders[] = {9, 8, 4, 8, 4, 10, 11, 12, 13, 14, 15, 16, 17, 18, 19, 5, 5, 5, 5, 5};
    const Families families{founders};
    EXPECT_EQ(families.count(), 14u);
    std::vector<std::uint32_t> shown;
    for (const Families::Family& family : families.shown()) {
        shown.push_back(family.founder);
    }
    EXPECT_THAT(shown, ElementsAre(5, 4, 8, 9, 10, 11, 12));
    EXPECT_EQ(families.shown()[0].size, 5u);
    EXPECT_EQ(families.of(1), 2) << "of 8";
    EXPECT_EQ(families.of(14), Families::none) << "too small to be shown";
    EXPECT_EQ(families.of(20), Families::none) << "no such organism";
}

TEST(Families, LeaveOutUnknownFounders) {
    const std::uint32_t founders[] = {Families::unknown, 3, Families::unknown};
    const Families families{founders};
    EXPECT_EQ(families.count(), 1u);
    EXPECT_EQ(families.size(), 1u);
    EXPECT_EQ(families.of(0), Families::none);
    EXPECT_EQ(families.of(1), 0);
}

} // namespace
} // namespace evod::viewer
