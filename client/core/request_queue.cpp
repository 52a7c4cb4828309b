#include "client/core/request_queue.h"

#include <algorithm>
#include <utility>

namespace evod::core {

void RequestQueue::add(evod::v1::Request request, Pending pending) {
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

std::optional<SubscriptionHandle> RequestQueue::answer(const evod::v1::Response& response) {
    const bool was_sent = in_flight_.erase(response.request_id()) > 0;
    const auto entry = pending_.find(response.request_id());
    if (!was_sent || entry == pending_.end()) {
        return std::nullopt;
    }
    const auto subscription = entry->second.subscription;
    finish(entry, response);
    return subscription;
}

void RequestQueue::expire(TimePoint now, const std::string& why) {
    for (auto entry = pending_.begin(); entry != pending_.end();) {
        if (entry->second.deadline > now) {
            ++entry;
            continue;
        }
        const std::string timeout_ms = std::to_string(entry->second.timeout.count());
        entry = finish(entry, Error{Error::Kind::Timeout, "no reply within " + timeout_ms + " ms" + why});
    }
}

void RequestQueue::end_session(const Error& error, bool another) {
    for (auto entry = pending_.begin(); entry != pending_.end();) {
        const bool waits = entry->second.subscription && !in_flight_.contains(entry->first);
        const bool remains = another && (entry->second.handler || waits);
        entry = remains ? std::next(entry) : finish(entry, error);
    }
    in_flight_.clear();
    if (!another) {
        ended_ = error;
    }
}

std::string RequestQueue::take_frames() {
    std::string frames;
    const std::size_t most = limits_.requests_in_flight_max() > 0 ? limits_.requests_in_flight_max() : 64;
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

RequestQueue::Entries::iterator RequestQueue::finish(Entries::iterator entry, Result<evod::v1::Response> result) {
    if (entry->second.handler) {
        outcomes_.push_back({std::move(entry->second.handler), std::move(result)});
    }
    return pending_.erase(entry);
}

} // namespace evod::core
