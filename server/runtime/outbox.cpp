#include "server/runtime/outbox.h"

#include <algorithm>
#include <utility>

namespace evod::runtime {

void Outbox::add(Delivery delivery) {
    std::unique_lock lock{mutex_};
    waiting_.deliveries.push_back(std::move(delivery));
    added(std::move(lock));
}

void Outbox::event(v1::Event event, const std::string& user) {
    std::unique_lock lock{mutex_};
    const bool of_replay = !user.empty();
    if (events_waiting_ < events_max_ && (!of_replay || of_replays_.ask(user) == base::Quota::Verdict::Free)) {
        waiting_.deliveries.push_back(std::move(event));
        ++events_waiting_;
        if (of_replay) {
            of_replays_.take(user);
        }
    } else {
        ++waiting_.dropped_events[user];
    }
    added(std::move(lock));
}

void Outbox::snapshot(SnapshotPtr snapshot) {
    std::unique_lock lock{mutex_};
    const bool after_change = snapshot->after_change;
    const auto same_world =
        std::find_if(waiting_.snapshots.begin(), waiting_.snapshots.end(),
                     [&](const NewestSnapshot& other) { return other.snapshot->world == snapshot->world; });
    SnapshotPtr replaced; // freed after the lock is released, because freeing a snapshot may take a while
    if (same_world == waiting_.snapshots.end()) {
        waiting_.snapshots.push_back({std::move(snapshot), 0, after_change});
    } else {
        replaced = std::exchange(same_world->snapshot, std::move(snapshot));
        ++same_world->replaced_count;
        same_world->after_change |= after_change;
    }
    added(std::move(lock));
}

void Outbox::added(std::unique_lock<std::mutex> lock) {
    const bool wake = !std::exchange(woken_, true);
    lock.unlock();
    if (wake) {
        wake_();
    }
}

Outbox::Taken Outbox::take() {
    const std::lock_guard lock{mutex_};
    woken_ = false;
    events_waiting_ = 0;
    of_replays_.give_back_all();
    return std::exchange(waiting_, {});
}

Outbox::FillLevel Outbox::fill() const {
    const std::lock_guard lock{mutex_};
    return {.deliveries = waiting_.deliveries.size(), .events = events_waiting_, .events_max = events_max_};
}

} // namespace evod::runtime
