#include "server/experiments/trials.h"

#include <gmock/gmock.h>

#include <atomic>
#include <barrier>
#include <mutex>
#include <set>
#include <thread>
#include <vector>

namespace evod::experiments {
namespace {

constexpr auto never = [] { return false; };

TEST(Trials, EachIsDoneOnceByAtMostSoManyThreads) {
    for (const std::size_t jobs : {1u, 2u, 3u, 8u}) {
        std::vector<std::atomic<int>> done(100);
        std::atomic<int> at_a_time = 0, most = 0;
        for_each_trial(
            done.size(), jobs,
            [&](std::size_t index) {
                const int now = ++at_a_time;
                for (int seen = most; seen < now && !most.compare_exchange_weak(seen, now);) {
                }
                ++done[index];
                --at_a_time;
            },
            never);
        for (const auto& count : done) {
            EXPECT_EQ(count.load(), 1);
        }
        EXPECT_LE(most.load(), static_cast<int>(jobs));
    }
}

TEST(Trials, AsManyRunAtATimeAsAskedFor) {
    constexpr std::size_t jobs = 3;
    std::barrier together{jobs}; // fewer threads than `jobs` would wait for ever
    for_each_trial(
        2 * jobs, jobs, [&](std::size_t) { together.arrive_and_wait(); }, never);
}

TEST(Trials, OneJobTakesThemInOrder) {
    std::vector<std::size_t> order;
    std::set<std::thread::id> threads;
    for_each_trial(
        5, 1,
        [&](std::size_t index) {
            order.push_back(index);
            threads.insert(std::this_thread::get_id());
        },
        never);
    EXPECT_THAT(order, testing::ElementsAre(0, 1, 2, 3, 4));
    EXPECT_EQ(threads.size(), 1u);
}

TEST(Trials, NoneBeginsAfterTheStop) {
    std::atomic<bool> stopped = false;
    std::atomic<int> begun = 0;
    for_each_trial(
        1000, 2,
        [&](std::size_t) {
            if (++begun >= 10) {
                stopped = true;
            }
        },
        [&] { return stopped.load(); });
    EXPECT_GE(begun.load(), 10);
    EXPECT_LE(begun.load(), 11); // the other thread may have been in between
    for_each_trial(
        3, 2, [&](std::size_t) { ADD_FAILURE(); }, [] { return true; });
    for_each_trial(
        0, 2, [&](std::size_t) { ADD_FAILURE(); }, never);
}

TEST(Trials, SeedsOfReplicatesDifferAndNeverChange) {
    std::set<std::uint64_t> seeds;
    for (std::uint32_t replicate = 0; replicate < 1000; ++replicate) {
        seeds.insert(replicate_seed({7}, replicate).value);
    }
    for (std::uint32_t replicate = 0; replicate < 1000; ++replicate) {
        seeds.insert(replicate_seed({8}, replicate).value);
    }
    EXPECT_EQ(seeds.size(), 2000u);
    EXPECT_EQ(replicate_seed({7}, 0).value, 1590899994837747u);
    EXPECT_EQ(replicate_seed({7}, 3).value, 4210857784167327u);
}

} // namespace
} // namespace evod::experiments
