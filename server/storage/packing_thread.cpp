#include "server/storage/packing_thread.h"

#include <utility>

namespace evod::storage {

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
    for (;;) {
        Job job;
        {
            std::unique_lock lock{mutex_};
            changed_.wait(lock, [this] { return stopping_ || !jobs_.empty(); });
            if (stopping_)
                return;
            job = std::move(jobs_.front());
            jobs_.pop_front();
        }
        job();
    }
}

} // namespace evod::storage
