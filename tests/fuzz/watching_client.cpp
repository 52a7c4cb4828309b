#include "tests/fuzz/watching_client.h"

#include "server/access/authorization.h"
#include "server/network/limits.h"
#include "server/protocol/request_rules.h"
#include "tests/fuzz/valid_snapshot.h"
#include "tests/fuzz/watched_server.h"

#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <iterator>

namespace evod::fuzz {
namespace {

/// Whether the simulation answers the request; it answers in order of arrival.
bool goes_to_the_simulation(const v1::Request& request) {
    switch (protocol::kind_of(request)) {
    case v1::REQUEST_KIND_COMMAND:
        return true;
    case v1::REQUEST_KIND_QUERY:
        return !request.has_describe() && !request.has_get_metrics() && !request.has_get_breeding();
    case v1::REQUEST_KIND_SUBSCRIPTION:
        return request.has_subscribe_snapshots() || request.has_subscribe_events();
    default:
        return false;
    }
}

bool is_valid(const v1::Hello& hello) {
    return hello.protocol_version() == 1 && hello.client_name().size() <= 64 && hello.client_version().size() <= 64 &&
           admit(hello.token());
}

} // namespace

WatchingClient::WatchingClient(int descriptor, Answers& answers, bool refused)
    : descriptor_{descriptor}, answers_{answers}, all_heard_{clock().now()} {
    if (refused) {
        refused_since_ = clock().now();
    }
}

WatchingClient::~WatchingClient() {
    ::close(descriptor_);
}

// ---- sending ---------------------------------------------------------------------------------------------------

void WatchingClient::send(std::size_t count) {
    count = std::min(count, unsent_.size());
    if (count == 0 || finished_ || closed_) {
        return;
    }
    const ssize_t sent = ::send(descriptor_, unsent_.data(), count, MSG_DONTWAIT | MSG_NOSIGNAL);
    if (sent <= 0) {
        return; // the socket is full, or the other end is closed
    }
    said(std::as_bytes(std::span{unsent_}.first(static_cast<std::size_t>(sent))));
    unsent_.erase(0, static_cast<std::size_t>(sent));
}

void WatchingClient::finish() {
    ::shutdown(descriptor_, SHUT_WR);
    finished_ = true;
}

void WatchingClient::said(std::span<const std::byte> bytes) {
    said_.feed(bytes);
    while (!refused()) {
        const auto frame = said_.next();
        if (!frame) {
            refused_since_ = clock().now();
        } else if (*frame) {
            said(**frame);
        } else {
            return;
        }
    }
}

void WatchingClient::said(const codec::Frame& frame) {
    const auto message = codec::parse_body<v1::ClientMessage>(frame.body);
    if (!greeted_) {
        greeted_ = message && message->has_hello() && is_valid(message->hello());
        if (!greeted_) {
            refused_since_ = clock().now();
        } else {
            const access::AuthenticatedUser user = *admit(message->hello().token());
            role_ = user.role;
            user_ = user.name;
            said_.set_limits(codec::server_limits);
        }
        return;
    }
    if (!message || message->kind_case() == v1::ClientMessage::kHello ||
        message->kind_case() == v1::ClientMessage::KIND_NOT_SET) {
        return owed(0, {});
    }
    if (message->has_acknowledge_snapshot()) {
        const v1::AcknowledgeSnapshot& acknowledged = message->acknowledge_snapshot();
        const auto watch = subscriptions_.find(acknowledged.subscription_id());
        if (watch == subscriptions_.end()) {
            return;
        }
        Island& island = watch->second.islands[acknowledged.island()];
        island.acknowledged_up_to = std::max<std::uint64_t>(island.acknowledged_up_to, acknowledged.sequence());
        island.unacknowledged.erase(island.unacknowledged.begin(),
                                    island.unacknowledged.upper_bound(acknowledged.sequence()));
        return;
    }
    const v1::Request& request = message->request();
    if (protocol::kind_of(request) == v1::REQUEST_KIND_COMMAND) {
        ++answers_.times_sent[{user_, request.client_key(), request.request_id()}];
    }
    owed(request.request_id(), {.request = request, .place = ++place_});
}

void WatchingClient::owed(std::uint64_t request_id, Asked asked) {
    ids_are_mixed_ = ids_are_mixed_ || outstanding_.contains(request_id);
    outstanding_.emplace(request_id, std::move(asked));
}

// ---- receiving -------------------------------------------------------------------------------------------------

bool WatchingClient::hear(std::size_t count) {
    static std::array<std::byte, 65536>
        bytes; // static, because the sanitizer would initialise it on the stack in every call
    if (closed_ || count == 0) {
        return false;
    }
    const ssize_t heard_bytes = ::recv(descriptor_, bytes.data(), std::min(count, bytes.size()), MSG_DONTWAIT);
    if (heard_bytes < 0 && (errno == EAGAIN || errno == EWOULDBLOCK)) {
        all_heard_ = clock().now();
        return false;
    }
    // The server waits less long for a client whose session is ending.
    const bool may_be_ending = refused() || !greeted_ || said_.buffered_bytes() > 0;
    const auto patience = may_be_ending ? network::farewell_timeout : network::stalled_timeout;
    const auto now = clock().now();
    const bool long_refused =
        refused() && now - *refused_since_ >= network::farewell_timeout; // whatever it has received
    may_have_stalled_ = may_have_stalled_ || long_refused || now - all_heard_ >= patience;
    if (heard_bytes <= 0) {
        closed_ = true;
        return false;
    }
    heard_.feed(std::span{bytes}.first(static_cast<std::size_t>(heard_bytes)));
    for (;;) {
        const auto frame = heard_.next();
        require(frame.has_value());
        if (!*frame) {
            return true;
        }
        heard(**frame);
    }
}

void WatchingClient::heard(const codec::Frame& frame) {
    require(!end_announced_);
    if (frame.channel == codec::Channel::Stream) {
        auto snapshot = codec::parse_body<v1::SnapshotFrame>(frame.body);
        require(welcomed_ && snapshot);
        return heard(*std::move(snapshot));
    }
    const auto message = codec::parse_body<v1::ServerMessage>(frame.body);
    require(message.has_value());
    switch (message->kind_case()) {
    case v1::ServerMessage::kWelcome:
        require(greeted_ && !std::exchange(welcomed_, true));
        return;
    case v1::ServerMessage::kResponse:
        return heard(message->response());
    case v1::ServerMessage::kEvent:
        require(welcomed_);
        return heard(message->event());
    case v1::ServerMessage::kGoodbye:
        require(!message->goodbye().status().message().empty());
        end_announced_ = true;
        return;
    case v1::ServerMessage::KIND_NOT_SET:
        require(false);
    }
}

void WatchingClient::heard(const v1::Response& response) {
    const std::uint64_t id = response.request_id();
    require(v1::Code_IsValid(response.status().code()));
    require(response.status().code() == v1::CODE_UNSPECIFIED || !response.status().message().empty());
    const auto found = outstanding_.find(id);
    if (found == outstanding_.end() || !welcomed_) {
        require(welcomed_ && id == 0 && response.has_status()); // for an unreadable message
        return;
    }
    const Asked asked = std::move(found->second);
    outstanding_.erase(found);
    if (response.status().code() != v1::CODE_UNSPECIFIED) {
        require(response.answer_case() == v1::Response::ANSWER_NOT_SET && !response.has_applied_tick());
    } else if (!ids_are_mixed_) {
        granted(asked, response);
    }
}

void WatchingClient::granted(const Asked& asked, const v1::Response& response) {
    const v1::Request& request = asked.request;
    require(role_ >= access::role_needed(*protocol::rules_of(request), false));
    bool once = true;
    if (protocol::kind_of(request) == v1::REQUEST_KIND_COMMAND) {
        require(response.has_applied_tick());
        const Answers::Command command{user_, request.client_key(), request.request_id()};
        const std::string answer = response.SerializeAsString();
        const auto [first, is_first] = answers_.first.try_emplace(command, answer);
        once = answers_.times_sent.at(command) == 1;
        require(is_first || (!once && first->second == answer));
    }
    if (goes_to_the_simulation(request) && once) {
        require(asked.place > last_place_answered_);
        last_place_answered_ = asked.place;
    }
    const std::uint32_t subscription = response.subscription().subscription_id();
    if (request.has_subscribe_snapshots()) {
        require(
            subscriptions_.emplace(subscription, Subscription{.asked = request.subscribe_snapshots(), .islands = {}})
                .second);
    }
    if (request.has_subscribe_events()) {
        require(event_subscriptions_.insert(subscription).second);
    }
    if (request.has_unsubscribe()) {
        require(subscriptions_.erase(request.unsubscribe().subscription_id()) +
                    event_subscriptions_.erase(request.unsubscribe().subscription_id()) ==
                1);
    }
}

void WatchingClient::heard(const v1::Event& event) {
    if (event.has_server_going_away()) {
        end_announced_ = true;
    } else {
        require(ids_are_mixed_ || !event_subscriptions_.empty());
    }
}

void WatchingClient::heard(v1::SnapshotFrame frame) {
    const auto found = subscriptions_.find(frame.subscription_id());
    if (found == subscriptions_.end()) {
        return require(ids_are_mixed_);
    }
    Subscription& watch = found->second;
    require(!watch.asked.has_island() || watch.asked.island() == frame.island());
    require(frame.sequence() != 0);
    Island& island = watch.islands[frame.island()];
    // A snapshot is repeated only as a requested keyframe or after a change of the view.
    const std::uint64_t before = std::exchange(island.sequence, frame.sequence());
    require(frame.sequence() > before ||
            (frame.sequence() == before && (codec::is_keyframe(frame) || watch.asked.has_view())));
    if (watch.asked.has_unacknowledged_max() && frame.sequence() > island.acknowledged_up_to) {
        island.unacknowledged.insert(frame.sequence());
        require(island.unacknowledged.size() <= watch.asked.unacknowledged_max());
    }
    const auto snapshot = island.decoder.decode(std::move(frame));
    require(snapshot.has_value());
    require_valid(*snapshot);
}

std::optional<v1::AcknowledgeSnapshot> WatchingClient::newest_snapshot(std::size_t wanted) const {
    const auto watch = subscriptions_.find(subscription(wanted));
    if (watch == subscriptions_.end() || watch->second.islands.empty()) {
        return std::nullopt;
    }
    const auto& [island, of] =
        *std::next(watch->second.islands.begin(), static_cast<std::ptrdiff_t>(wanted % watch->second.islands.size()));
    v1::AcknowledgeSnapshot acknowledgement;
    acknowledgement.set_subscription_id(watch->first);
    acknowledgement.set_island(island);
    acknowledgement.set_sequence(of.sequence);
    return acknowledgement;
}

std::uint32_t WatchingClient::subscription(std::size_t wanted) const {
    if (subscriptions_.empty()) {
        return event_subscriptions_.empty() ? 0 : *event_subscriptions_.begin();
    }
    return std::next(subscriptions_.begin(), static_cast<std::ptrdiff_t>(wanted % subscriptions_.size()))->first;
}

} // namespace evod::fuzz
