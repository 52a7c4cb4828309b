#include "server/runtime/past_reader.h"

#include <pthread.h>

#include <utility>

namespace evod::runtime {

void PastReader::ask(Read read) {
    {
        const std::lock_guard lock{mutex_};
        waiting_.push_back(std::move(read));
    }
    changed_.notify_one();
    if (!thread_.joinable()) {
        thread_ = std::jthread{[this](const std::stop_token& stop) { work(stop); }};
    }
}

void PastReader::work(const std::stop_token& stop) {
    pthread_setname_np(pthread_self(), "past"); // as `top -H` shows it
    while (true) {
        Read read;
        {
            std::unique_lock lock{mutex_};
            changed_.wait(lock, stop, [this] { return !waiting_.empty(); });
            if (stop.stop_requested()) {
                return;
            }
            read = std::move(waiting_.front());
            waiting_.pop_front();
        }
        mailbox_.push(CallMail{read()});
    }
}

} // namespace evod::runtime
