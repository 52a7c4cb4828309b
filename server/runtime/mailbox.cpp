#include "server/runtime/mailbox.h"

#include <utility>

namespace evod::runtime {

bool Mailbox::try_push(Mail&& mail, const std::string& user) {
    std::unique_lock lock{mutex_};
    if (places_.ask(user) != base::Quota::Verdict::Free) {
        return false;
    }
    places_.take(user);
    add(std::move(mail), std::move(lock));
    return true;
}

void Mailbox::push(Mail&& mail) {
    add(std::move(mail), std::unique_lock{mutex_});
}

void Mailbox::add(Mail&& mail, std::unique_lock<std::mutex> lock) {
    waiting_.push_back(std::move(mail));
    pending_.store(true, std::memory_order_release);
    lock.unlock();
    changed_.notify_one();
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
    places_.give_back_all();
    waiting_.swap(emptied);
    return emptied;
}

base::Quota Mailbox::places() const {
    const std::lock_guard lock{mutex_};
    return places_;
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
