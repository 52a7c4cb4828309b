#include "server/streaming/snapshot_queue.h"

#include "proto/codec/framing.h"

#include <google/protobuf/wire_format_lite.h>

#include <algorithm>
#include <numeric>
#include <utility>

namespace evod::streaming {

namespace {

std::size_t bytes_of(const std::vector<std::uint64_t>& sequences) {
    return sequences.capacity() == 0 ? 0 : sequences.capacity() * sizeof(std::uint64_t) + allocation_bytes;
}

} // namespace

std::size_t OutgoingFrame::body_bytes() const {
    return std::accumulate(parts.begin(), parts.end(), tail_bytes,
                           [](std::size_t bytes, const SharedBytes* part) { return bytes + (*part)->size(); });
}

void SnapshotQueue::count_dropped(SnapshotSubscription& of, std::uint64_t count) {
    if (count > 0) {
        of.dropped_count += count;
        dropped_.add(count);
    }
}

std::size_t SnapshotQueue::held_bytes() const {
    constexpr std::size_t node = 4 * sizeof(void*) + allocation_bytes; // of a map
    std::size_t bytes =
        unacknowledged_bytes_ + turns_.size() * sizeof(Turn) + postponed_.size() * (sizeof *postponed_.begin() + node);
    for (const auto& [id, subscription] : subscriptions) {
        bytes +=
            sizeof subscription + node + subscription.islands.size() * (sizeof(std::uint64_t) + sizeof(Island) + node);
    }
    return bytes;
}

void SnapshotQueue::unsubscribe(std::uint32_t subscription_id) {
    const auto found = subscriptions.find(subscription_id);
    for (const auto& [index, island] : found->second.islands) {
        unacknowledged_bytes_ -= bytes_of(island.unacknowledged);
    }
    subscriptions.erase(found);
    std::erase_if(turns_, [&](const Turn& turn) { return turn.subscription_id == subscription_id; });
    std::erase_if(postponed_, [&](const auto& item) { return item.second.subscription_id == subscription_id; });
}

void SnapshotQueue::forget_islands(SnapshotSubscription& subscription, std::uint32_t first) {
    const auto from = subscription.islands.lower_bound(first);
    for (auto island = from; island != subscription.islands.end(); ++island) {
        unacknowledged_bytes_ -= bytes_of(island->second.unacknowledged);
    }
    subscription.islands.erase(from, subscription.islands.end());
}

void SnapshotQueue::offer(std::uint32_t subscription_id, std::uint32_t island, StreamedSnapshotPtr snapshot) {
    const auto subscription = subscriptions.find(subscription_id);
    if (subscription == subscriptions.end() || stopped_) {
        return;
    }
    Island& of = subscription->second.islands[island];
    const bool waited = of.waiting != nullptr, was_shown = of.shown.has_value();
    if (waited && !was_shown) {
        count_dropped(subscription->second, 1);
    }
    of.shown.reset();
    of.waiting = std::move(snapshot);
    if (waited && was_shown) {
        delay_until({}, subscription_id, island, of);
    } else if (!waited) {
        line_up(subscription_id, island, of);
    }
}

bool SnapshotQueue::send_keyframe(std::uint32_t subscription_id, std::uint32_t island, StreamedSnapshotPtr newest,
                                  Clock::time_point at) {
    const auto found = subscriptions.find(subscription_id);
    if (found == subscriptions.end()) {
        return false;
    }
    Island& of = found->second.islands[island];
    if (of.waiting && of.sent.is_reset()) {
        return false;
    }
    of.sent.reset();
    send_again(subscription_id, island, std::move(newest), at);
    return true;
}

void SnapshotQueue::send_again(std::uint32_t subscription_id, std::uint32_t island, StreamedSnapshotPtr newest,
                               Clock::time_point at) {
    const auto subscription = subscriptions.find(subscription_id);
    if (subscription == subscriptions.end()) {
        return;
    }
    Island& of = subscription->second.islands[island];
    of.shown.reset();
    if (of.waiting) {
        delay_until(at, subscription_id, island, of);
    } else {
        of.not_before = at;
        offer(subscription_id, island, std::move(newest));
    }
    sender_.send_snapshots_later();
}

void SnapshotQueue::acknowledge(const v1::AcknowledgeSnapshot& acknowledged) {
    const auto subscription = subscriptions.find(acknowledged.subscription_id());
    if (subscription == subscriptions.end()) {
        return; // the client has unsubscribed in the meantime
    }
    const auto island = subscription->second.islands.find(acknowledged.island());
    if (island == subscription->second.islands.end()) {
        return;
    }
    auto& unacknowledged = island->second.unacknowledged;
    unacknowledged.erase(unacknowledged.begin(), std::ranges::upper_bound(unacknowledged, acknowledged.sequence()));
    if (island->second.waiting && island->second.turn == 0) {
        line_up(acknowledged.subscription_id(), acknowledged.island(), island->second);
    }
    sender_.send_snapshots_later();
}

void SnapshotQueue::line_up(std::uint32_t subscription_id, std::uint32_t index, Island& island) {
    island.turn = ++last_turn_;
    turns_.push_back({subscription_id, index, island.turn});
}

void SnapshotQueue::delay_until(Clock::time_point at, std::uint32_t subscription_id, std::uint32_t index,
                                Island& island) {
    if (island.turn == 0 || postponed_.erase({island.not_before, island.turn}) > 0) {
        line_up(subscription_id, index, island);
    }
    island.not_before = at;
}

const OutgoingFrame* SnapshotQueue::next() {
    const auto now = clock_.now();
    while (!postponed_.empty() && postponed_.begin()->first.first <= now) {
        turns_.push_back(postponed_.begin()->second);
        postponed_.erase(postponed_.begin());
    }
    // Each turn is examined once. If its snapshot cannot be sent yet, the turn is moved to another list or deleted.
    while (!turns_.empty()) {
        const Turn turn = turns_.front();
        turns_.pop_front();
        const auto found = subscriptions.find(turn.subscription_id);
        if (found == subscriptions.end()) {
            continue; // the client has unsubscribed
        }
        SnapshotSubscription& subscription = found->second;
        const auto of = subscription.islands.find(turn.island);
        if (of == subscription.islands.end() || of->second.turn != turn.number) {
            continue;
        }
        Island& island = of->second;
        if (subscription.unacknowledged_max && island.unacknowledged.size() >= *subscription.unacknowledged_max) {
            island.turn = 0; // no turn until an acknowledgement arrives
            continue;
        }
        if (!take(turn.subscription_id, subscription, island)) {
            postponed_.emplace(std::pair{island.not_before, turn.number}, turn);
            continue;
        }
        island.turn = 0;
        if (outgoing_.body_bytes() > frame_bytes_max_) {
            drop_outgoing(subscription, island);
            continue;
        }
        if (island.waiting) {
            line_up(turn.subscription_id, turn.island, island);
        }
        return &outgoing_;
    }
    retry_at_ = postponed_.empty() ? Clock::time_point::max() : postponed_.begin()->first.first;
    return nullptr;
}

void SnapshotQueue::drop_outgoing(SnapshotSubscription& subscription, Island& island) {
    count_dropped(subscription, 1);
    if (subscription.unacknowledged_max) {
        island.unacknowledged.pop_back();
    }
    island.waiting = {};
    island.shown.reset();
    island.sent.reset(); // the client does not receive this snapshot, so it cannot be the base of the next one
}

bool SnapshotQueue::take(std::uint32_t subscription_id, SnapshotSubscription& subscription, Island& island) {
    if (island.not_before != Clock::time_point{} && clock_.now() < island.not_before) {
        return false;
    }
    outgoing_.snapshot = island.waiting;
    set_tail(subscription_id, subscription.dropped_count);
    StreamedSnapshot& snapshot = *island.waiting;
    const auto& view = subscription.view;
    const codec::TileRange seen = view && view->has_region() ? codec::tiles_of(view->region(), snapshot.layout())
                                                             : codec::tiles_of(snapshot.layout());
    const v1::Detail wanted = view ? view->detail() : v1::DETAIL_FULL;
    const auto add_parts = [&](v1::Detail detail) {
        outgoing_.parts.clear();
        island.sent.add_parts(snapshot, seen, detail, subscription.compression, outgoing_.parts);
    };
    v1::Detail detail = wanted;
    if (subscription.bandwidth) {
        const auto now = clock_.now();
        const auto cost = [&](v1::Detail tried) {
            add_parts(tried);
            return codec::header_bytes + outgoing_.body_bytes();
        };
        const Bandwidth::Choice choice = island.shown ? subscription.bandwidth->refine(now, *island.shown, cost)
                                                      : subscription.bandwidth->choose(now, cost);
        island.not_before = choice.again;
        if (!choice.detail) {
            return false;
        }
        detail = *choice.detail;
    } else {
        add_parts(detail);
    }
    island.sent.sent(snapshot, seen, detail);
    if (subscription.unacknowledged_max) {
        await_acknowledgement(island, snapshot.sequence());
    }
    if (detail == wanted) {
        island.shown.reset();
        island.waiting = {}; // outgoing_ keeps the snapshot alive
    } else {
        island.shown = detail;
    }
    return true;
}

void SnapshotQueue::await_acknowledgement(Island& island, std::uint64_t sequence) {
    const std::size_t before = bytes_of(island.unacknowledged);
    island.unacknowledged.push_back(sequence);
    unacknowledged_bytes_ += bytes_of(island.unacknowledged) - before;
}

void SnapshotQueue::set_tail(std::uint32_t subscription_id, std::uint64_t dropped_count) {
    using google::protobuf::internal::WireFormatLite;
    std::uint8_t* end = WireFormatLite::WriteUInt32ToArray(v1::SnapshotFrame::kSubscriptionIdFieldNumber,
                                                           subscription_id, outgoing_.tail.data());
    if (dropped_count > 0) {
        end = WireFormatLite::WriteUInt64ToArray(v1::SnapshotFrame::kDroppedCountFieldNumber, dropped_count, end);
    }
    outgoing_.tail_bytes = static_cast<std::size_t>(end - outgoing_.tail.data());
}

void SnapshotQueue::clear() {
    stopped_ = true;
    for (auto& [id, subscription] : subscriptions) {
        subscription.islands.clear();
    }
    turns_.clear();
    postponed_.clear();
    unacknowledged_bytes_ = 0;
}

} // namespace evod::streaming
