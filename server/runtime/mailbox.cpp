#include "server/runtime/mailbox.h"

#include <limits>
#include <utility>

namespace evod::runtime {

bool Mailbox::try_push(Mail&& mail) {
    return push(std::move(mail), capacity_);
}

void Mailbox::push(Mail&& mail) {
    push(std::move(mail), std::numeric_limits<std::size_t>::max());
}

bool Mailbox::push(Mail&& mail, std::size_t capacity) {
    {
        const std::lock_guard lock{mutex_};
        if (waiting_.size() >= capacity) {
            return false;
        }
        waiting_.push_back(std::move(mail));
        pending_.store(true, std::memory_order_release);
    }
    changed_.notify_one();
    return true;
}

void Mailbox::wake() {
    {
        const std::lock_guard lock{mutex_};
        pending_.store(true, std::memory_order_release);
    }
    changed_.notify_one();
}

std::vector<Mail> Mailbox::drain(std::vector<Mail> emptied) {
    emptied.clear();
    const std::lock_guard lock{mutex_};
    pending_.store(false, std::memory_order_release);
    waiting_.swap(emptied);
    return emptied;
}

Mailbox::FillLevel Mailbox::fill() const {
    const std::lock_guard lock{mutex_};
    return {.waiting = waiting_.size(), .capacity = capacity_};
}

void Mailbox::wait(std::optional<Clock::time_point> until) {
    std::unique_lock lock{mutex_};
    const auto wanted = [this] { return pending_.load(std::memory_order_relaxed); };
    if (until) {
        changed_.wait_until(lock, *until, wanted);
    } else {
        changed_.wait(lock, wanted);
    }
}

} // namespace evod::runtime
