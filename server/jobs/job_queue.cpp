#include "server/jobs/job_queue.h"

#include "server/jobs/this_thread.h"

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
        for (std::stop_source& job : running_) {
            job.request_stop();
        }
    }
    changed_.notify_all();
    for (std::thread& thread : threads_) {
        thread.join();
    }
}

std::stop_source JobQueue::add(Job job) {
    std::stop_source stop;
    {
        const std::lock_guard lock{mutex_};
        waiting_.push_back({std::move(job), stop});
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

void JobQueue::work() {
    set_up_thread(options_.name, options_.niceness);
    std::unique_lock lock{mutex_};
    while (true) {
        changed_.wait(lock, [this] { return stopping_ || !waiting_.empty(); });
        if (stopping_) {
            return;
        }
        Waiting next = std::move(waiting_.front());
        waiting_.pop_front();
        --idle_threads_;
        running_.push_back(next.stop);
        lock.unlock();
        next.job(next.stop.get_token());
        next.job = {};
        lock.lock();
        std::erase(running_, next.stop);
        ++idle_threads_;
    }
}

} // namespace evod::jobs
