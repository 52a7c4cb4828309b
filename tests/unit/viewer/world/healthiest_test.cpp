#include "client/viewer/world/healthiest.h"

#include "tests/unit/codec/px_column.h"

#include <gtest/gtest.h>

namespace evod::viewer {
namespace {

TEST(Healthiest, AreOrderedByHealthThenById) {
    const auto snapshot = codec::snapshot_with(
        {.id = {1, 3, 7}, .x = {}, .y = {}, .width = {}, .height = codec::px_column({50, 80, 80})});
    EXPECT_EQ(healthiest(snapshot->organisms, 2), (std::vector<std::size_t>{1, 2}));
    EXPECT_EQ(healthiest(snapshot->organisms, 9), (std::vector<std::size_t>{1, 2, 0}));
}

} // namespace
} // namespace evod::viewer
