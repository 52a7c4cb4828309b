#include "server/jobs/job_queue.h"

#include "server/jobs/this_thread.h"

#include <algorithm>
#include <system_error>
#include <utility>

namespace evod::jobs {

JobQueue::JobQueue(Options options) : options_{std::move(options)} {
    threads_.reserve(options_.threads_max);
    const std::lock_guard lock{mutex_};
    start_thread();
}

JobQueue::~JobQueue() {
    {
        const std::lock_guard lock{mutex_};
        stopping_ = true;
        for (Running& job : running_) {
            job.stop.request_stop();
        }
    }
    changed_.notify_all();
    for (std::thread& thread : threads_) {
        thread.join();
    }
}

std::stop_source JobQueue::add(Job job, std::string user) {
    std::stop_source stop;
    {
        const std::lock_guard lock{mutex_};
        waiting_.add(user, {std::move(job), stop, user});
        if (waiting_.size() > idle_threads_ && threads_.size() < options_.threads_max) {
            try {
                start_thread();
            } catch (const std::system_error&) { // the system has no further thread: the job waits for one of the queue
            }
        }
    }
    changed_.notify_one();
    return stop;
}

void JobQueue::start_thread() {
    threads_.emplace_back([this] { work(); });
    ++idle_threads_;
}

bool JobQueue::may_run(const std::string& user) const {
    const auto count = std::ranges::count(running_, user, &Running::user);
    return static_cast<std::size_t>(count) < options_.threads_per_user_max;
}

void JobQueue::work() {
    set_up_thread(options_.name, options_.niceness);
    const auto may = [this](const std::string& user, const Waiting&) { return may_run(user); };
    std::unique_lock lock{mutex_};
    while (true) {
        changed_.wait(lock, [&] { return stopping_ || waiting_.has(may); });
        if (stopping_) {
            return;
        }
        Waiting next = *waiting_.take(may);
        --idle_threads_;
        running_.push_back({next.user, next.stop});
        lock.unlock();
        next.job(next.stop.get_token());
        next.job = {};
        lock.lock();
        std::erase_if(running_, [&](const Running& job) { return job.stop == next.stop; });
        ++idle_threads_;
    }
}

} // namespace evod::jobs
