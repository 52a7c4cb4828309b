#include "server/runtime/job_turns.h"

#include "server/base/assert.h"

#include <algorithm>
#include <utility>

namespace evod::runtime {

std::size_t JobTurns::count_for(std::size_t processors) {
    constexpr std::size_t left_free = 2; // packing has a thread of its own
    return processors > left_free ? processors - left_free : 1;
}

JobTurns::Turn::Turn(JobTurns& turns, std::string user, const std::stop_token& stop)
    : turns_{turns}, user_{std::move(user)}, stop_{stop} {
    take();
}

bool JobTurns::Turn::go_on() {
    if (!stop_.stop_requested() && turns_.waiting_count_ > 0) {
        std::unique_lock lock{turns_.mutex_};
        if (is_held_ && turns_.clock_.now() - since_ >= slice) {
            turns_.account(*this);
            const auto next = turns_.next();
            if (next != turns_.waiting_.end() && turns_.shares_.spent((*next)->user_) <= turns_.shares_.spent(user_)) {
                turns_.free(*this);
                wait(lock);
            }
        }
    }
    return !stop_.stop_requested();
}

void JobTurns::Turn::give_back() {
    const std::lock_guard lock{turns_.mutex_};
    if (is_held_) {
        turns_.account(*this);
        turns_.free(*this);
    }
}

void JobTurns::Turn::take() {
    std::unique_lock lock{turns_.mutex_};
    EVOD_ASSERT(!is_held_);
    wait(lock);
}

void JobTurns::Turn::wait(std::unique_lock<std::mutex>& lock) {
    if (turns_.waiting_.empty()) {
        turns_.contended_since_ = turns_.clock_.now();
    }
    turns_.waiting_.push_back(this);
    turns_.waiting_count_ = turns_.waiting_.size();
    turns_.grant_free_turns();
    if (!granted_.wait(lock, stop_, [this] { return is_held_; })) {
        std::erase(turns_.waiting_, this);
        turns_.waiting_count_ = turns_.waiting_.size();
    }
}

void JobTurns::account(Turn& turn) {
    const Clock::time_point now = clock_.now();
    if (!waiting_.empty()) { // time that no other job wanted is free
        shares_.spend(turn.user_, now - std::max(turn.since_, contended_since_));
    }
    turn.since_ = now;
}

void JobTurns::free(Turn& turn) {
    turn.is_held_ = false;
    ++free_;
    grant_free_turns();
}

void JobTurns::grant_free_turns() {
    while (free_ > 0 && !waiting_.empty()) {
        const auto chosen = next();
        Turn& turn = **chosen;
        waiting_.erase(chosen);
        waiting_count_ = waiting_.size();
        shares_.serve(turn.user_);
        --free_;
        turn.is_held_ = true;
        turn.since_ = clock_.now();
        turn.granted_.notify_one();
    }
}

std::deque<JobTurns::Turn*>::iterator JobTurns::next() {
    return std::ranges::min_element(waiting_, {}, [this](const Turn* turn) { return shares_.spent(turn->user_); });
}

} // namespace evod::runtime
