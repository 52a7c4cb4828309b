#include "client/core/request_queue.h"

#include "client/core/session_requests.h"

#include <algorithm>
#include <utility>

namespace evod::core {

void RequestQueue::begin_session(const evod::v1::Limits& limits) {
    limits_ = limits;
    had_session_ = true;
    lost_.reset();
}

void RequestQueue::add(evod::v1::Request request, Pending pending) {
    const std::string replay = replay_in(request);
    pending.ends_with_session = ends_with_session(request);
    pending.opens_replay = request.has_open_replay();
    pending.sets_view = request.has_set_view();
    request.set_request_id(++last_id_);
    request.set_client_key(client_key_);
    evod::v1::ClientMessage message;
    *message.mutable_request() = std::move(request);
    const std::size_t length = message.ByteSizeLong();
    const std::uint32_t limit = limits_.control_frame_bytes_max() > 0 ? limits_.control_frame_bytes_max()
                                                                      : *codec::server_limits.control_bytes_max;
    const auto entry = pending_.emplace(last_id_, std::move(pending)).first;
    if (ended_) {
        finish(entry, *ended_);
    } else if (ended_replays_.contains(replay)) {
        evod::v1::Response refusal;
        refusal.set_request_id(last_id_);
        *refusal.mutable_status() = replay_has_ended(replay);
        finish(entry, std::move(refusal));
    } else if (lost_ && entry->second.ends_with_session) {
        finish(entry, *lost_);
    } else if (length > limit) {
        finish(entry, Error{Error::Kind::Usage, "the request is " + std::to_string(length) + " bytes long, allowed " +
                                                    std::to_string(limit)});
    } else {
        entry->second.frame = codec::encode_frame(codec::Channel::Control, message);
    }
}

bool RequestQueue::has_request_for(SubscriptionHandle subscription) const {
    return std::ranges::any_of(pending_, [&](const auto& entry) { return entry.second.subscription == subscription; });
}

std::optional<AnsweredSubscription> RequestQueue::answer(const evod::v1::Response& response) {
    const bool was_sent = in_flight_.erase(response.request_id()) > 0;
    if (abandoned_replays_.erase(response.request_id()) > 0 && response.has_world()) {
        evod::v1::Request close;
        close.mutable_close_replay()->set_world(response.world().name());
        add(std::move(close), {});
    }
    const auto entry = pending_.find(response.request_id());
    if (!was_sent || entry == pending_.end()) {
        return std::nullopt;
    }
    if (entry->second.opens_replay && response.has_world()) {
        own_replays_.insert(response.world().name());
        ended_replays_.erase(response.world().name());
    }
    const auto subscription = entry->second.subscription;
    const bool sets_view = entry->second.sets_view;
    finish(entry, response);
    return subscription ? std::optional{AnsweredSubscription{*subscription, sets_view}} : std::nullopt;
}

void RequestQueue::expire(TimePoint now, const std::string& why) {
    for (auto entry = pending_.begin(); entry != pending_.end();) {
        if (entry->second.deadline > now) {
            ++entry;
            continue;
        }
        if (entry->second.opens_replay && in_flight_.contains(entry->first)) {
            abandoned_replays_.insert(entry->first);
        }
        const std::string timeout_ms = std::to_string(entry->second.timeout.count());
        entry = finish(entry, Error{Error::Kind::Timeout, "no reply within " + timeout_ms + " ms" + why});
    }
}

void RequestQueue::end_session(const Error& error, bool another) {
    for (auto entry = pending_.begin(); entry != pending_.end();) {
        // Before the first session, ids can be only those that the user has given.
        const bool ends = entry->second.ends_with_session && had_session_;
        const bool waits = entry->second.subscription && !in_flight_.contains(entry->first);
        const bool remains = another && !ends && (entry->second.handler || waits);
        entry = remains ? std::next(entry) : finish(entry, error);
    }
    in_flight_.clear();
    abandoned_replays_.clear();
    ended_replays_.merge(own_replays_);
    own_replays_.clear();
    if (had_session_) {
        lost_ = error;
    }
    if (!another) {
        ended_ = error;
    }
}

void RequestQueue::give_up(const Error& error) {
    for (auto entry = pending_.begin(); entry != pending_.end();) {
        entry = entry->second.handler ? finish(entry, error) : std::next(entry);
    }
}

std::string RequestQueue::take_frames() {
    std::string frames;
    // The server counts a request until it has sent the complete answer. The answer may arrive here before the server
    // stops counting the request.
    const std::size_t allowed = limits_.requests_in_flight_max() > 0 ? limits_.requests_in_flight_max() : 32;
    const std::size_t most = std::max<std::size_t>(allowed / 2, 1);
    for (const bool first : {true, false}) {
        for (const auto& [id, pending] : pending_) {
            if (in_flight_.size() >= most) {
                return frames;
            }
            if (pending.first == first && in_flight_.insert(id).second) {
                frames += pending.frame;
            }
        }
    }
    return frames;
}

TimePoint RequestQueue::next_deadline() const {
    TimePoint next = TimePoint::max();
    for (const auto& [id, pending] : pending_) {
        next = std::min(next, pending.deadline);
    }
    return next;
}

bool RequestQueue::has_request_of_program() const {
    return std::ranges::any_of(pending_, [](const auto& entry) { return static_cast<bool>(entry.second.handler); });
}

RequestQueue::Entries::iterator RequestQueue::finish(Entries::iterator entry, Result<evod::v1::Response> result) {
    if (entry->second.handler) {
        outcomes_.push_back({std::move(entry->second.handler), std::move(result)});
    }
    return pending_.erase(entry);
}

} // namespace evod::core
