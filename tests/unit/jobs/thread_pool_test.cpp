#include "server/base/inline_executor.h"
#include "server/jobs/thread_pool.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

namespace evod::base {
namespace {

class AnyExecutor : public testing::TestWithParam<std::size_t> {};

TEST_P(AnyExecutor, RunsEveryIndexOnceInPiecesOfTheGrain) {
    jobs::ThreadPool threads{GetParam()};
    for (const std::size_t count : {0ul, 1ul, 6ul, 99ul, 1000ul}) {
        std::vector<int> visits(count);
        threads.parallel_for(count, 7, [&](Range range) {
            EXPECT_EQ(range.begin % 7, 0u);
            EXPECT_LE(range.end - range.begin, 7u);
            for (std::size_t i = range.begin; i < range.end; ++i) {
                ++visits[i];
            }
        });
        EXPECT_EQ(std::count(visits.begin(), visits.end(), 1), static_cast<std::ptrdiff_t>(count));
    }
}

TEST_P(AnyExecutor, LoopsMayBeNested) {
    jobs::ThreadPool threads{GetParam()};
    std::vector<int> visits(64 * 64);
    threads.parallel_for(64, 1, [&](Range outer) {
        threads.parallel_for(64, 8, [&](Range inner) {
            for (std::size_t i = inner.begin; i < inner.end; ++i) {
                ++visits[outer.begin * 64 + i];
            }
        });
    });
    EXPECT_EQ(std::count(visits.begin(), visits.end(), 1), 64 * 64);
}

INSTANTIATE_TEST_SUITE_P(Threads, AnyExecutor, testing::Values(1, 2, 3, 8));

} // namespace
} // namespace evod::base
