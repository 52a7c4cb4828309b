#include "client/core/subscriptions.h"

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
    subscriptions_[handle].request = std::move(request);
    this->request(handle, false);
}

void Subscriptions::set_view(SubscriptionHandle handle, evod::v1::View view) {
    const auto entry = subscriptions_.find(handle);
    if (entry != subscriptions_.end() && entry->second.request.has_subscribe_snapshots()) {
        *entry->second.request.mutable_subscribe_snapshots()->mutable_view() = std::move(view);
        entry->second.view_changed = true;
        send_view(entry->second);
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
        if (!requests_.has_request_for(handle)) {
            request(handle, true);
        }
    }
}

void Subscriptions::end_session() {
    answers_.clear();
    for (auto& [handle, subscription] : subscriptions_) {
        subscription.server_id.reset();
        subscription.islands.clear();
    }
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
        send_view(entry->second);
    }
    answers_[handle] = std::move(response);
}

std::string Subscriptions::take_snapshot(evod::v1::SnapshotFrame frame, ConnectionStatus& status) {
    const std::uint32_t server_id = frame.subscription_id(), island = frame.island();
    const auto known =
        std::ranges::find_if(subscriptions_, [&](const auto& entry) { return entry.second.server_id == server_id; });
    if (known == subscriptions_.end()) {
        return {}; // the program has unsubscribed since
    }
    // Servers without acknowledgements do not number their snapshots.
    const bool acknowledged =
        known->second.request.subscribe_snapshots().has_unacknowledged_max() && frame.sequence() > 0;
    std::string acknowledgement = acknowledged ? acknowledgement_of(frame) : "";
    IslandStream& stream = known->second.islands[island];
    const bool is_delta = frame.codec() == evod::v1::CODEC_DELTA;
    if (is_delta && !codec::is_keyframe(frame) && stream.decoder.needs_keyframe() && stream.keyframe_requests > 0) {
        return acknowledgement; // the server sent this delta before the requested keyframe
    }
    if (auto decoded = stream.decoder.decode(std::move(frame))) {
        stream.keyframe_requests = 0;
        // Converts the values to the format in WorldInfo and Event, so that they can be compared.
        decoded->about.set_run_id(hexadecimal(decoded->about.run_id()));
        decoded->about.set_state_hash(hexadecimal(decoded->about.state_hash()));
        snapshots_[known->first][island] = std::make_shared<const codec::ReceivedSnapshot>(*std::move(decoded));
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
    Subscription& subscription = subscriptions_[handle];
    subscription.view_changed = false;
    requests_.add(subscription.request, {.subscription = handle, .first = first});
}

void Subscriptions::send_view(Subscription& subscription) {
    if (subscription.view_changed && subscription.server_id) {
        subscription.view_changed = false;
        evod::v1::Request request;
        request.mutable_set_view()->set_subscription_id(*subscription.server_id);
        *request.mutable_set_view()->mutable_view() = subscription.request.subscribe_snapshots().view();
        requests_.add(std::move(request), {.first = true});
    }
}

void Subscriptions::unsubscribe_from(std::uint32_t server_id) {
    if (server_id > 0) {
        evod::v1::Request request;
        request.mutable_unsubscribe()->set_subscription_id(server_id);
        requests_.add(std::move(request), {});
    }
}

} // namespace evod::core
