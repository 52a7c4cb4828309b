#include "server/streaming/snapshot_streams.h"

#include "server/streaming/quantise.h"

#include <algorithm>
#include <array>
#include <chrono>
#include <utility>

namespace evod::streaming {
namespace {

/// Number of steps of one distribute() call, after which the thread serves other clients. With small islands they take
/// 1 to 5 ms together.
constexpr std::size_t steps_at_once = 128;

/// A subscription receives keyframes on request at most once per interval between its snapshots, but at least this
/// often.
constexpr std::chrono::seconds keyframe_period_max{1};

runtime::Clock::duration between_snapshots(double rate_hz) {
    return std::chrono::duration_cast<runtime::Clock::duration>(std::chrono::duration<double>{1 / rate_hz});
}

/// Whether a group with this rate receives a snapshot now. If so, sets the time of the group's next snapshot.
bool is_due(double rate_hz, runtime::Clock::time_point& next, bool after_change, runtime::Clock::time_point now) {
    const auto between = between_snapshots(rate_hz);
    // A snapshot may be sent a tenth of the interval too early. Otherwise the group might have to wait for the next
    // snapshot of the simulation.
    if (!after_change && now + between / 10 < next) {
        return false;
    }
    next += between;
    if (after_change || next <= now) {
        next = now + between;
    }
    return true;
}

} // namespace

void SnapshotStreams::subscribe(std::uint64_t session, SnapshotQueue& queue, std::uint32_t subscription_id,
                                SnapshotSubscription subscription) {
    queues_.emplace(session, &queue);
    Group& group = groups_[group_of(subscription)];
    ++group.subscription_count;
    // If no snapshot exists yet, the simulation must copy one for this viewer. Otherwise the viewer receives the newest
    // existing one.
    bool joins = false;
    each_newest(subscription, [&](std::uint32_t, const StreamedSnapshotPtr&) { joins = true; });
    if (!joins) {
        subscription.newcomer = ++newcomers_;
        group.next_snapshot = {};
    }
    queue.subscriptions.emplace(subscription_id, std::move(subscription));
    if (joins) {
        send_keyframes(queue, subscription_id);
    }
}

bool SnapshotStreams::unsubscribe(std::uint64_t session, SnapshotQueue& queue, std::uint32_t subscription_id) {
    const auto found = queue.subscriptions.find(subscription_id);
    if (found == queue.subscriptions.end()) {
        return false;
    }
    leave_group(found->second);
    queue.unsubscribe(subscription_id);
    if (queue.subscriptions.empty()) {
        queues_.erase(session);
    }
    return true;
}

void SnapshotStreams::forget(std::uint64_t session) {
    const auto queue = queues_.find(session);
    if (queue == queues_.end()) {
        return;
    }
    for (const auto& [id, subscription] : queue->second->subscriptions) {
        leave_group(subscription);
    }
    queues_.erase(queue);
}

void SnapshotStreams::leave_group(const SnapshotSubscription& subscription) {
    const auto group = groups_.find(group_of(subscription));
    if (group != groups_.end() && --group->second.subscription_count == 0) {
        groups_.erase(group);
    }
}

std::optional<std::size_t> SnapshotStreams::send_keyframes(SnapshotQueue& queue, std::uint32_t subscription_id) {
    const auto found = queue.subscriptions.find(subscription_id);
    if (found == queue.subscriptions.end()) {
        return std::nullopt;
    }
    SnapshotSubscription& subscription = found->second;
    const auto at = std::max(subscription.keyframes_from, queue.now());
    std::size_t examined = 0;
    each_newest(subscription, [&](std::uint32_t island, const StreamedSnapshotPtr& newest) {
        if (queue.send_keyframe(subscription_id, island, newest, at)) {
            subscription.keyframes_from =
                at + std::min<runtime::Clock::duration>(between_snapshots(subscription.rate_hz), keyframe_period_max);
        }
        ++examined;
    });
    return examined;
}

std::size_t SnapshotStreams::set_view(SnapshotQueue& queue, std::uint32_t subscription_id, const v1::View& view) {
    SnapshotSubscription& subscription = queue.subscriptions.at(subscription_id);
    subscription.set_view(view);
    std::size_t sent_again = 0;
    each_newest(subscription, [&](std::uint32_t island, const StreamedSnapshotPtr& newest) {
        queue.send_again(subscription_id, island, newest);
        ++sent_again;
    });
    return sent_again;
}

std::map<std::uint64_t, std::size_t> SnapshotStreams::shared_bytes() const {
    std::map<GroupName, std::size_t> of_groups;
    for (const auto& [name, group] : groups_) {
        for (const auto& [island, newest] : group.newest) {
            of_groups[name] += newest->bytes();
        }
    }
    std::map<std::uint64_t, std::size_t> of_sessions;
    for (const auto& [session, queue] : queues_) {
        for (const auto& [id, subscription] : queue->subscriptions) {
            const GroupName name = group_of(subscription);
            of_sessions[session] += of_groups[name] / groups_.at(name).subscription_count;
        }
    }
    return of_sessions;
}

void SnapshotStreams::forget_world(const std::string& world) {
    for (auto& [name, group] : groups_) {
        if (name.world == world) {
            group.newest.clear();
        }
    }
    for (const auto& [session, queue] : queues_) {
        for (auto& [id, subscription] : queue->subscriptions) {
            if (subscription.world == world) {
                queue->forget_islands(subscription, 0);
            }
        }
    }
    std::erase_if(in_progress_, [&](const InProgress& of) { return of.snapshot.snapshot->world == world; });
}

template <class Do>
void SnapshotStreams::each_newest(const SnapshotSubscription& subscription, const Do& what) const {
    const auto group = groups_.find(group_of(subscription));
    if (group == groups_.end()) {
        return;
    }
    const auto& all = group->second.newest;
    if (subscription.island) {
        if (const auto found = all.find(*subscription.island); found != all.end()) {
            what(found->first, found->second);
        }
        return;
    }
    for (const auto& [island, newest] : all) {
        what(island, newest);
    }
}

SnapshotStreams::GroupName SnapshotStreams::group_of(const SnapshotSubscription& subscription) {
    return {subscription.world, subscription.rate_hz, subscription.form(), subscription.with};
}

runtime::WorldDemands SnapshotStreams::demand() const {
    runtime::WorldDemands worlds;
    for (const auto& [session, queue] : queues_) {
        for (const auto& [id, subscription] : queue->subscriptions) {
            runtime::WorldDemand& world = worlds[subscription.world];
            world.rate_hz = std::max(world.rate_hz, subscription.rate_hz);
            world.newcomers = std::max(world.newcomers, subscription.newcomer);
            if (subscription.island) {
                world.islands.push_back(*subscription.island);
            } else {
                world.all_islands = true;
            }
        }
    }
    for (auto& [name, world] : worlds) {
        std::sort(world.islands.begin(), world.islands.end());
        world.islands.erase(std::unique(world.islands.begin(), world.islands.end()), world.islands.end());
    }
    return worlds;
}

void SnapshotStreams::deliver(std::vector<runtime::Outbox::NewestSnapshot> snapshots) {
    for (runtime::Outbox::NewestSnapshot& snapshot : snapshots) {
        const auto of = std::ranges::find_if(in_progress_, [&](const InProgress& other) {
            return other.snapshot.snapshot->world == snapshot.snapshot->world;
        });
        if (of == in_progress_.end()) {
            in_progress_.push_back({.snapshot = std::move(snapshot)});
            continue;
        }
        if (of->next) {
            snapshot.replaced_count += of->next->replaced_count + 1;
            snapshot.after_change = snapshot.after_change || of->next->after_change;
        }
        of->next = std::move(snapshot);
    }
}

bool SnapshotStreams::distribute(runtime::Clock::time_point now) {
    std::size_t steps_left = steps_at_once;
    while (steps_left > 0 && !in_progress_.empty()) {
        InProgress of = std::move(in_progress_.front());
        in_progress_.pop_front();
        if (!of.begun) {
            begin(of, now);
        }
        advance(of, steps_left);
        if (of.next_island < of.snapshot.snapshot->islands.size()) {
            in_progress_.push_back(std::move(of));
        } else if (of.next) {
            in_progress_.push_back({.snapshot = std::move(*of.next)});
        }
    }
    return !in_progress_.empty();
}

void SnapshotStreams::begin(InProgress& of, runtime::Clock::time_point now) {
    const runtime::Snapshot& snapshot = *of.snapshot.snapshot;
    of.begun = true;
    of.began = now;
    for (auto& [name, group] : groups_) {
        if (name.world != snapshot.world || !is_due(name.rate_hz, group.next_snapshot, of.snapshot.after_change, now)) {
            continue;
        }
        of.groups.insert(name);
        if (std::exchange(group.run_id, snapshot.run_id) != snapshot.run_id) {
            group.newest.clear(); // these snapshots may belong to an earlier run, which may have had more islands
        }
    }
    for (const auto& [session, queue] : queues_) {
        for (auto& [id, subscription] : queue->subscriptions) {
            if (!of.groups.contains(group_of(subscription))) {
                continue;
            }
            queue->count_dropped(subscription, of.snapshot.replaced_count);
            queue->forget_islands(subscription, snapshot.island_count);
        }
    }
}

std::vector<SnapshotStreams::Viewer> SnapshotStreams::viewers_of(const InProgress& of) {
    std::vector<Viewer> viewers;
    for (const auto& [session, queue] : queues_) {
        for (const auto& [id, subscription] : queue->subscriptions) {
            if (subscription.world != of.snapshot.snapshot->world) {
                continue;
            }
            // Since begin() a group may have lost its last viewer, and another viewer may have created the group again.
            const GroupName name = group_of(subscription);
            if (of.groups.contains(name)) {
                viewers.push_back({queue, id, &subscription, &groups_.at(name)});
            }
        }
    }
    return viewers;
}

void SnapshotStreams::advance(InProgress& of, std::size_t& steps_left) {
    const runtime::Snapshot& snapshot = *of.snapshot.snapshot;
    std::vector<Viewer> viewers = viewers_of(of);
    if (viewers.empty()) {
        of.next_island = snapshot.islands.size();
    }
    for (; steps_left > 0 && of.next_island < snapshot.islands.size(); ++of.next_island) {
        const runtime::IslandSnapshot& island = snapshot.islands[of.next_island];
        std::map<OptionalColumns, std::shared_ptr<EncodedIsland>>
            encodings; // shared by the viewers of all rates and forms
        std::size_t steps = 1;
        for (Viewer& viewer : viewers) {
            if (viewer.subscription->island && *viewer.subscription->island != island.island) {
                continue;
            }
            const OptionalColumns wanted = viewer.subscription->with;
            const OptionalColumns with{.headings = wanted.headings && !island.organisms.heading.empty(),
                                       .species = wanted.species && !island.organisms.species.empty()};
            std::shared_ptr<EncodedIsland>& encoded = encodings[with];
            if (!encoded) {
                v1::SnapshotFrame about = frame_without_entities(snapshot, island);
                about.set_sequence(++sequence_);
                encoded =
                    std::make_shared<EncodedIsland>(std::move(about), quantise(island, with), compressor_, memory_);
            }
            StreamedSnapshotPtr& newest = viewer.group->newest[island.island];
            if (!newest || newest->sequence() != encoded->sequence()) { // this viewer is the first of its group
                newest = std::make_shared<StreamedSnapshot>(encoded, viewer.subscription->form(), newest, of.began,
                                                            between_snapshots(viewer.subscription->rate_hz));
            }
            viewer.queue->offer(viewer.subscription_id, island.island, newest);
            viewer.has_new = true;
            ++steps;
        }
        steps_left -= std::min(steps_left, steps);
    }
    for (const Viewer& viewer : viewers) {
        if (viewer.has_new) {
            viewer.queue->sender().send_snapshots();
        }
    }
}

} // namespace evod::streaming
