#include "client/core/subscriptions.h"

#include "client/core/session_requests.h"

#include <algorithm>
#include <utility>

namespace evod::core {

namespace {

std::string hexadecimal(std::string_view bytes) {
    std::string digits;
    digits.reserve(2 * bytes.size());
    for (const char byte : bytes) {
        digits += "0123456789abcdef"[static_cast<unsigned char>(byte) >> 4];
        digits += "0123456789abcdef"[byte & 15];
    }
    return digits;
}

std::string acknowledgement_of(const evod::v1::SnapshotFrame& frame) {
    evod::v1::ClientMessage message;
    auto& acknowledged = *message.mutable_acknowledge_snapshot();
    acknowledged.set_subscription_id(frame.subscription_id());
    acknowledged.set_island(frame.island());
    acknowledged.set_sequence(frame.sequence());
    return codec::encode_frame(codec::Channel::Control, message);
}

} // namespace

void Subscriptions::add(SubscriptionHandle handle, evod::v1::Request request) {
    Subscription& subscription = subscriptions_[handle];
    subscription.request = std::move(request);
    subscription.ended = requests_.has_ended(replay_in(subscription.request));
    if (!subscription.ended) {
        this->request(handle, false);
    } else if (in_session_) {
        refuse_ended(handle);
    }
}

void Subscriptions::set_view(SubscriptionHandle handle, evod::v1::View view) {
    const auto entry = subscriptions_.find(handle);
    if (entry != subscriptions_.end() && entry->second.request.has_subscribe_snapshots()) {
        entry->second.wanted_view = std::move(view);
        send_view(handle, entry->second);
    }
}

void Subscriptions::remove(SubscriptionHandle handle) {
    const auto removed = subscriptions_.extract(handle);
    answers_.erase(handle);
    snapshots_.erase(handle);
    if (removed && removed.mapped().server_id) {
        unsubscribe_from(*removed.mapped().server_id);
    }
}

void Subscriptions::begin_session() {
    for (const auto& [handle, subscription] : subscriptions_) {
        if (subscription.ended) {
            refuse_ended(handle);
        } else if (!requests_.has_request_for(handle)) {
            request(handle, true);
        }
    }
    in_session_ = true;
}

void Subscriptions::end_session() {
    answers_.clear();
    for (auto& [handle, subscription] : subscriptions_) {
        subscription.ended = subscription.ended || (in_session_ && !replay_in(subscription.request).empty());
        if (subscription.sent_view && !subscription.wanted_view) {
            subscription.wanted_view = std::move(subscription.sent_view); // whether the server accepts it is not known
        }
        subscription.sent_view.reset();
        subscription.server_id.reset();
        subscription.islands.clear();
    }
    in_session_ = false;
}

void Subscriptions::take_answer(SubscriptionHandle handle, evod::v1::Response response) {
    const std::uint32_t server_id = response.subscription().subscription_id();
    const auto entry = subscriptions_.find(handle);
    if (entry == subscriptions_.end()) {
        unsubscribe_from(server_id);
        return;
    }
    if (accepted(response)) {
        entry->second.server_id = server_id;
        send_view(handle, entry->second);
    }
    answers_[handle] = std::move(response);
}

void Subscriptions::take_view_answer(SubscriptionHandle handle, const evod::v1::Response& response) {
    const auto entry = subscriptions_.find(handle);
    if (entry == subscriptions_.end() || !entry->second.sent_view) {
        return; // the program has unsubscribed since
    }
    if (accepted(response)) {
        *entry->second.request.mutable_subscribe_snapshots()->mutable_view() = *std::move(entry->second.sent_view);
    }
    entry->second.sent_view.reset();
    send_view(handle, entry->second);
}

std::string Subscriptions::take_snapshot(evod::v1::SnapshotFrame frame, ConnectionStatus& status) {
    const std::uint32_t server_id = frame.subscription_id(), island = frame.island();
    const auto found =
        std::ranges::find_if(subscriptions_, [&](const auto& entry) { return entry.second.server_id == server_id; });
    if (found == subscriptions_.end()) {
        return {}; // the program has unsubscribed since
    }
    // Servers without acknowledgements do not number their snapshots.
    const bool acknowledged =
        found->second.request.subscribe_snapshots().has_unacknowledged_max() && frame.sequence() > 0;
    std::string acknowledgement = acknowledged ? acknowledgement_of(frame) : "";
    IslandStream& stream = found->second.islands[island];
    const bool is_delta = frame.codec() == evod::v1::CODEC_DELTA;
    if (is_delta && !codec::is_keyframe(frame) && stream.decoder.needs_keyframe() && stream.keyframe_requests > 0) {
        return acknowledgement; // the server sent this delta before the requested keyframe
    }
    if (auto decoded = stream.decoder.decode(std::move(frame))) {
        stream.keyframe_requests = 0;
        // Converts the values to the format in WorldInfo and Event, so that they can be compared.
        decoded->about.set_run_id(hexadecimal(decoded->about.run_id()));
        decoded->about.set_state_hash(hexadecimal(decoded->about.state_hash()));
        snapshots_[found->first][island] = std::make_shared<const codec::ReceivedSnapshot>(*std::move(decoded));
    } else {
        ++status.damaged_snapshot_count;
        status.last_damage = decoded.error().what;
        // If keyframes are damaged too, requesting more of them does not help.
        if (is_delta && stream.keyframe_requests < keyframe_requests_max) {
            ++stream.keyframe_requests;
            ++status.keyframe_request_count;
            evod::v1::Request request;
            request.mutable_request_keyframe()->set_subscription_id(server_id);
            requests_.add(std::move(request), {.first = true});
        }
    }
    return acknowledgement;
}

void Subscriptions::request(SubscriptionHandle handle, bool first) {
    requests_.add(subscriptions_[handle].request, {.subscription = handle, .first = first});
}

void Subscriptions::send_view(SubscriptionHandle handle, Subscription& subscription) {
    if (subscription.wanted_view && !subscription.sent_view && subscription.server_id) {
        subscription.sent_view = std::exchange(subscription.wanted_view, std::nullopt);
        evod::v1::Request request;
        request.mutable_set_view()->set_subscription_id(*subscription.server_id);
        *request.mutable_set_view()->mutable_view() = *subscription.sent_view;
        requests_.add(std::move(request), {.subscription = handle, .first = true});
    }
}

void Subscriptions::refuse_ended(SubscriptionHandle handle) {
    *answers_[handle].mutable_status() = replay_has_ended(replay_in(subscriptions_[handle].request));
}

void Subscriptions::unsubscribe_from(std::uint32_t server_id) {
    if (server_id > 0) {
        evod::v1::Request request;
        request.mutable_unsubscribe()->set_subscription_id(server_id);
        requests_.add(std::move(request), {});
    }
}

} // namespace evod::core
