#include "server/runtime/file_jobs.h"

#include "tests/support/waiting.h"

#include <gtest/gtest.h>

#include <atomic>
#include <future>
#include <string>
#include <vector>

namespace evod::runtime {
namespace {

class FileJobsTest : public testing::Test {
  protected:
    SteadyClock clock;
    JobTurns turns{1, clock};
    FileJobs jobs{turns};
};

TEST_F(FileJobsTest, OneUsersFilesDoNotDelayAnotherUser) {
    std::atomic<bool> ada_has_read = false;
    std::atomic<int> read_by_eve = 0;
    std::promise<void> all_read;
    for (int i = 0; i < 32; ++i) {
        jobs.add("eve", [&](const base::StopCheck& stop) {
            while (!ada_has_read && !stop()) { // a long file
            }
            if (++read_by_eve == 32) {
                all_read.set_value();
            }
        });
    }
    jobs.add("ada", [&](const base::StopCheck&) { ada_has_read = true; });
    EXPECT_TRUE(wait_until_ready(all_read.get_future()));
}

TEST_F(FileJobsTest, JobsOfAUserEndInTheirOrder) {
    std::vector<int> ended; // one job of the user runs at a time
    std::promise<void> all_ended;
    for (int i = 0; i < 20; ++i) {
        jobs.add("eve", [&, i](const base::StopCheck&) {
            ended.push_back(i);
            if (i == 19) {
                all_ended.set_value();
            }
        });
    }
    ASSERT_TRUE(wait_until_ready(all_ended.get_future()));
    EXPECT_TRUE(std::ranges::is_sorted(ended));
    EXPECT_EQ(ended.size(), 20u);
}

TEST_F(FileJobsTest, ACancelledJobIsStoppedOrDoesNotBegin) {
    std::promise<void> begun, stopped, last;
    std::stop_source running = jobs.add("eve", [&](const base::StopCheck& stop) {
        begun.set_value();
        while (!stop()) {
        }
        stopped.set_value();
    });
    std::atomic<bool> ran = false;
    std::stop_source waiting = jobs.add("eve", [&](const base::StopCheck&) { ran = true; });
    begun.get_future().wait();
    waiting.request_stop();
    running.request_stop();
    EXPECT_TRUE(wait_until_ready(stopped.get_future()));
    jobs.add("eve", [&](const base::StopCheck&) { last.set_value(); });
    EXPECT_TRUE(wait_until_ready(last.get_future()));
    EXPECT_FALSE(ran);
}

} // namespace
} // namespace evod::runtime
