#include "server/runtime/job_turns.h"

#include "tests/support/waiting.h"

#include <gtest/gtest.h>

#include <atomic>
#include <functional>
#include <map>
#include <optional>
#include <thread>
#include <vector>

namespace evod::runtime {
namespace {

using namespace std::chrono_literals;

/// A clock that the threads of a test advance.
class SharedClock final : public Clock {
  public:
    time_point now() override { return time_point{now_.load()}; }
    void advance(duration passed) { now_ = now_.load() + passed; }

  private:
    std::atomic<duration> now_{std::chrono::hours{1}};
};

class JobTurnsTest : public testing::Test {
  protected:
    using Turn = JobTurns::Turn;

    /// A job on a thread of its own.
    std::thread job(const std::string& user, std::function<void(Turn&)> work, std::stop_token stop = {}) {
        return std::thread{[this, user, work = std::move(work), stop = std::move(stop)] {
            Turn turn{turns, user, stop};
            work(turn);
        }};
    }
    void wait_for_jobs(std::size_t count) {
        ASSERT_TRUE(wait_until([&] { return turns.waiting_count() == count; }));
    }

    SharedClock clock;
    JobTurns turns{1, clock};
    std::stop_token never;
};

TEST(JobTurns, LeaveProcessorsForOtherWork) {
    EXPECT_EQ(JobTurns::count_for(0), 1u) << "the number of processors is unknown";
    EXPECT_EQ(JobTurns::count_for(1), 1u);
    EXPECT_EQ(JobTurns::count_for(2), 1u);
    EXPECT_EQ(JobTurns::count_for(3), 1u);
    EXPECT_EQ(JobTurns::count_for(16), 14u);
}

TEST_F(JobTurnsTest, ALongJobPassesItsTurnOnAfterASlice) {
    Turn eve{turns, "eve", never};
    clock.advance(5ms);
    std::atomic<bool> ada_computed = false;
    std::thread ada = job("ada", [&](Turn&) { ada_computed = true; });
    wait_for_jobs(1);
    clock.advance(4ms);
    EXPECT_TRUE(eve.go_on());
    EXPECT_FALSE(ada_computed) << "the slice is not over";
    clock.advance(1ms);
    EXPECT_TRUE(eve.go_on());
    EXPECT_TRUE(ada_computed);
    ada.join();
}

TEST_F(JobTurnsTest, NoMoreJobsComputeThanThereAreTurns) {
    JobTurns two{2, clock};
    std::atomic<int> computing = 0, most = 0;
    std::vector<std::thread> jobs;
    for (int i = 0; i < 6; ++i) {
        jobs.emplace_back([&, i] {
            Turn turn{two, std::to_string(i % 3), never};
            for (int tick = 0; tick < 200; ++tick) {
                const int now = ++computing;
                most = std::max(most.load(), now);
                clock.advance(3ms);
                --computing;
                turn.go_on();
            }
        });
    }
    for (std::thread& thread : jobs) {
        thread.join();
    }
    EXPECT_LE(most, 2);
    EXPECT_EQ(two.waiting_count(), 0u);
}

TEST_F(JobTurnsTest, UsersGetEqualTimeWhateverJobsTheyHave) {
    std::map<std::string, std::atomic<int>> ticks;
    ticks["ada"] = ticks["eve"] = 0;
    std::atomic<int> total = 0;
    std::optional<Turn> holds_all{std::in_place, turns, "test", never};
    std::vector<std::thread> jobs;
    for (const char* user : {"eve", "eve", "eve", "ada", "eve"}) {
        jobs.push_back(job(user, [&, user](Turn& turn) {
            for (; total < 3000; ++total, ++ticks.at(user)) {
                clock.advance(1ms);
                turn.go_on();
            }
        }));
    }
    wait_for_jobs(5);
    holds_all.reset();
    for (std::thread& thread : jobs) {
        thread.join();
    }
    EXPECT_NEAR(ticks["ada"], ticks["eve"], 25) << "two slices";
}

TEST_F(JobTurnsTest, TimeThatNoOtherJobWantedIsFree) {
    Turn eve{turns, "eve", never};
    clock.advance(1h);
    std::atomic<int> ada_ticks = 0;
    std::atomic<bool> is_over = false;
    std::thread ada = job("ada", [&](Turn& turn) {
        while (!is_over) {
            ++ada_ticks;
            clock.advance(1ms);
            turn.go_on();
        }
    });
    wait_for_jobs(1);
    for (int tick = 0; tick < 100; ++tick) {
        clock.advance(1ms);
        EXPECT_TRUE(eve.go_on());
    }
    is_over = true;
    EXPECT_LE(ada_ticks, 120);
    eve.give_back();
    ada.join();
}

TEST_F(JobTurnsTest, AJobThatWaitsForItsClientLetsOthersCompute) {
    Turn eve{turns, "eve", never};
    eve.give_back();
    eve.give_back(); // has no effect
    job("ada", [](Turn&) {}).join();
    eve.take();
    std::atomic<bool> ada_computed = false;
    std::thread ada = job("ada", [&](Turn&) { ada_computed = true; });
    wait_for_jobs(1);
    EXPECT_FALSE(ada_computed);
    eve.give_back();
    ada.join();
}

TEST_F(JobTurnsTest, AStoppedJobDoesNotWait) {
    std::optional<Turn> eve{std::in_place, turns, "eve", never};
    std::stop_source stop;
    bool goes_on = true;
    std::thread ada = job(
        "ada", [&](Turn& turn) { goes_on = turn.go_on() || !turn.stop_check()(); }, stop.get_token());
    wait_for_jobs(1);
    stop.request_stop();
    ada.join();
    EXPECT_FALSE(goes_on);
    EXPECT_EQ(turns.waiting_count(), 0u);
    eve.reset();
    job("ada", [](Turn&) {}).join(); // the turn is free
}

} // namespace
} // namespace evod::runtime
