#include "server/runtime/worker_pool.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <mutex>
#include <set>
#include <thread>
#include <utility>
#include <vector>

namespace evod::runtime {
namespace {

class PoolTest : public testing::TestWithParam<std::size_t> {};
INSTANTIATE_TEST_SUITE_P(Threads, PoolTest, testing::Values(1, 2, 3, 8));

TEST_P(PoolTest, CutsAtMultiplesOfTheGrain) {
    const auto pool = make_executor(GetParam());
    EXPECT_EQ(pool->thread_count(), GetParam());
    for (const auto& [count, grain] :
         {std::pair<std::size_t, std::size_t>{0, 1}, {1, 1}, {10, 3}, {12, 3}, {1000, 7}, {5, 100}}) {
        std::mutex mutex;
        std::set<std::pair<std::size_t, std::size_t>> pieces, expected;
        pool->parallel_for(count, grain, [&](base::Range range) {
            const std::lock_guard lock{mutex};
            EXPECT_TRUE(pieces.emplace(range.begin, range.end).second);
        });
        for (std::size_t begin = 0; begin < count; begin += grain) {
            expected.emplace(begin, std::min(begin + grain, count));
        }
        EXPECT_EQ(pieces, expected) << count << " by " << grain;
    }
}

TEST_P(PoolTest, RunsLoopsInsidePieces) {
    const auto pool = make_executor(GetParam());
    std::vector<int> done(64 * 64);
    pool->parallel_for(64, 1, [&](base::Range outer) {
        pool->parallel_for(64, 1, [&](base::Range inner) { done[outer.begin * 64 + inner.begin] = 1; });
    });
    EXPECT_EQ(std::count(done.begin(), done.end(), 1), 64 * 64);
}

TEST(PoolWithOneThread, RunsEverythingOnItsCaller) {
    const auto pool = make_executor(1);
    pool->parallel_for(
        100, 1, [caller = std::this_thread::get_id()](base::Range) { EXPECT_EQ(std::this_thread::get_id(), caller); });
}

} // namespace
} // namespace evod::runtime
