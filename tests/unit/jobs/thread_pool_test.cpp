
#include "server/jobs/thread_pool.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <new>
#include <vector>

namespace evod::jobs {
namespace {

class ThreadPoolTest : public testing::TestWithParam<std::size_t> {};

TEST_P(ThreadPoolTest, RunsEveryIndexOnceInPiecesOfTheGrain) {
    ThreadPool threads{GetParam()};
    for (const std::size_t count : {0ul, 1ul, 6ul, 99ul, 1000ul}) {
        std::vector<int> visits(count);
        threads.parallel_for(count, 7, [&](base::Range range) {
            EXPECT_EQ(range.begin % 7, 0u);
            EXPECT_LE(range.end - range.begin, 7u);
            for (std::size_t i = range.begin; i < range.end; ++i) {
                ++visits[i];
            }
        });
        EXPECT_EQ(std::count(visits.begin(), visits.end(), 1), static_cast<std::ptrdiff_t>(count));
    }
}

TEST_P(ThreadPoolTest, LoopsMayBeNested) {
    ThreadPool threads{GetParam()};
    std::vector<int> visits(64 * 64);
    threads.parallel_for(64, 1, [&](base::Range outer) {
        threads.parallel_for(64, 8, [&](base::Range inner) {
            for (std::size_t i = inner.begin; i < inner.end; ++i) {
                ++visits[outer.begin * 64 + i];
            }
        });
    });
    EXPECT_EQ(std::count(visits.begin(), visits.end(), 1), 64 * 64);
}

TEST_P(ThreadPoolTest, ThrowsWhatAPieceHasThrown) {
    ThreadPool threads{GetParam()};
    for (const std::size_t bad : {0ul, 50ul, 99ul}) {
        EXPECT_THROW(threads.parallel_for(100, 1,
                                          [&](base::Range range) {
                                              if (range.begin == bad) {
                                                  throw std::bad_alloc{};
                                              }
                                          }),
                     std::bad_alloc);
        std::atomic<int> visits = 0;
        threads.parallel_for(100, 1, [&](base::Range) { ++visits; });
        EXPECT_EQ(visits, 100) << "the pool works on";
    }
}

INSTANTIATE_TEST_SUITE_P(Threads, ThreadPoolTest, testing::Values(1, 2, 3, 8));

} // namespace
} // namespace evod::jobs
