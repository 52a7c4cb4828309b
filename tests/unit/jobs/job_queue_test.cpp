#include "server/jobs/job_queue.h"

#include <gtest/gtest.h>

#include <pthread.h>

#include <atomic>
#include <future>
#include <optional>
#include <set>
#include <system_error>
#include <thread>
#include <vector>

namespace evod::jobs {
namespace {

TEST(JobQueue, RunsJobsInOrderOnOneThread) {
    std::vector<int> done;
    std::set<std::thread::id> threads;
    std::promise<void> last;
    {
        JobQueue queue{{.name = "test"}};
        for (int i = 0; i < 3; ++i) {
            queue.add([&, i](const std::stop_token&) {
                done.push_back(i);
                threads.insert(std::this_thread::get_id());
                if (i == 2) {
                    last.set_value();
                }
            });
        }
        last.get_future().wait();
    }
    EXPECT_EQ(done, (std::vector{0, 1, 2}));
    EXPECT_EQ(threads.size(), 1u);
    EXPECT_FALSE(threads.contains(std::this_thread::get_id()));
}

TEST(JobQueue, RunsAtMostSoManyJobsAtATime) {
    std::atomic<int> running = 0, done = 0;
    std::atomic<bool> too_many = false;
    std::promise<void> two_run, all_done;
    std::promise<void> go_on;
    std::shared_future<void> may_end = go_on.get_future().share();
    JobQueue queue{{.name = "test", .threads_max = 2}};
    for (int i = 0; i < 4; ++i) {
        queue.add([&](const std::stop_token&) {
            const int now = ++running;
            too_many = too_many || now > 2;
            if (now == 2 && done == 0) {
                two_run.set_value();
            }
            may_end.wait();
            const bool last = ++done == 4;
            --running;
            if (last) {
                all_done.set_value();
            }
        });
    }
    two_run.get_future().wait();
    go_on.set_value();
    all_done.get_future().wait();
    EXPECT_FALSE(too_many);
}

TEST(JobQueue, ServesUsersInTurn) {
    std::vector<std::string> done;
    std::promise<void> begun, may_end, all_done;
    JobQueue queue{{.name = "test"}};
    queue.add(
        [&](const std::stop_token&) {
            begun.set_value();
            may_end.get_future().wait();
        },
        "eve");
    begun.get_future().wait();
    for (const char* user : {"eve", "eve", "eve", "ada", "bob"}) {
        queue.add(
            [&, user](const std::stop_token&) {
                done.push_back(user);
                if (done.size() == 5) {
                    all_done.set_value();
                }
            },
            user);
    }
    may_end.set_value();
    all_done.get_future().wait();
    EXPECT_EQ(done, (std::vector<std::string>{"eve", "ada", "bob", "eve", "eve"}));
}

TEST(JobQueue, AUserHasAtMostSoManyThreads) {
    std::atomic<int> of_eve = 0;
    std::atomic<bool> too_many = false;
    std::promise<void> ada_done, eve_done;
    std::shared_future<void> ada_has_run = ada_done.get_future().share();
    JobQueue queue{{.name = "test", .threads_max = 4, .threads_per_user_max = 2}};
    for (int i = 0; i < 6; ++i) {
        queue.add(
            [&, i](const std::stop_token&) {
                too_many = too_many || ++of_eve > 2;
                ada_has_run.wait();
                --of_eve;
                if (i == 5) {
                    eve_done.set_value();
                }
            },
            "eve");
    }
    queue.add([&](const std::stop_token&) { ada_done.set_value(); }, "ada");
    eve_done.get_future().wait();
    EXPECT_FALSE(too_many);
}

TEST(JobQueue, ACancelledJobSeesItsStopToken) {
    JobQueue queue{{.name = "test"}};
    std::promise<void> ended;
    std::stop_source job = queue.add([&](const std::stop_token& stop) {
        while (!stop.stop_requested()) {
            std::this_thread::yield();
        }
        ended.set_value();
    });
    job.request_stop();
    ended.get_future().wait();
}

TEST(JobQueue, ItsEndStopsRunningJobsAndDropsWaitingOnes) {
    std::promise<void> begun;
    bool stopped = false, other_ran = false;
    {
        std::optional<JobQueue> queue{std::in_place, JobQueue::Options{.name = "test"}};
        queue->add([&](const std::stop_token& stop) {
            begun.set_value();
            while (!stop.stop_requested()) {
                std::this_thread::yield();
            }
            stopped = true;
        });
        queue->add([&](const std::stop_token&) { other_ran = true; });
        begun.get_future().wait();
    }
    EXPECT_TRUE(stopped);
    EXPECT_FALSE(other_ran);
}

/// As long as it exists, no thread can be started: the stacks of new threads do not fit into memory.
class NoFurtherThreads {
  public:
    NoFurtherThreads() {
        pthread_getattr_default_np(&before_);
        pthread_attr_t huge;
        pthread_attr_init(&huge);
        pthread_attr_setstacksize(&huge, std::size_t{1} << 50);
        pthread_setattr_default_np(&huge);
        pthread_attr_destroy(&huge);
    }
    ~NoFurtherThreads() {
        pthread_setattr_default_np(&before_);
        pthread_attr_destroy(&before_);
    }

  private:
    pthread_attr_t before_;
};

TEST(JobQueue, AJobWithoutItsOwnThreadWaits) {
    JobQueue queue{{.name = "test", .threads_max = 2}};
    std::promise<void> may_end;
    std::promise<std::thread::id> first, second;
    {
        const NoFurtherThreads none;
        EXPECT_THROW(JobQueue{{.name = "test"}}, std::system_error);
        queue.add([&](const std::stop_token&) {
            may_end.get_future().wait();
            first.set_value(std::this_thread::get_id());
        });
        queue.add([&](const std::stop_token&) { second.set_value(std::this_thread::get_id()); });
    }
    may_end.set_value();
    EXPECT_EQ(first.get_future().get(), second.get_future().get());
}

} // namespace
} // namespace evod::jobs
