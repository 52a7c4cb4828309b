#include "server/recording/packing_thread.h"

#include <sys/resource.h>
#include <unistd.h>

#include <utility>

namespace evod::recording {

PackingThread::PackingThread() : thread_{[this] { work(); }} {}

PackingThread::~PackingThread() {
    {
        const std::lock_guard lock{mutex_};
        stopping_ = true;
    }
    changed_.notify_one();
    thread_.join();
}

void PackingThread::add(Job job) {
    {
        const std::lock_guard lock{mutex_};
        jobs_.push_back(std::move(job));
    }
    changed_.notify_one();
}

void PackingThread::work() {
    pthread_setname_np(pthread_self(), "packing"); // as `top -H` shows it
    // Where processors are few it gives way to threads that somebody waits for; Linux has this for each thread, and
    // where it is refused all is well but slower.
    (void)setpriority(PRIO_PROCESS, static_cast<id_t>(gettid()), niceness);
    for (;;) {
        Job job;
        {
            std::unique_lock lock{mutex_};
            changed_.wait(lock, [this] { return stopping_ || !jobs_.empty(); });
            if (stopping_) {
                return;
            }
            job = std::move(jobs_.front());
            jobs_.pop_front();
        }
        job();
    }
}

} // namespace evod::recording
