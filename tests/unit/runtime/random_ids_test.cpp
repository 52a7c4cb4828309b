#include "server/runtime/random_ids.h"

#include <gtest/gtest.h>

namespace evod::runtime {
namespace {

TEST(RandomIds, AreDifferentOnEveryDraw) {
    EXPECT_NE(draw_seed(), draw_seed());
    EXPECT_NE(draw_run_id(), draw_run_id());
}

} // namespace
} // namespace evod::runtime
