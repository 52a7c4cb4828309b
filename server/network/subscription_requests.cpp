#include "server/network/subscription_requests.h"

#include "server/network/messages.h"
#include "server/protocol/refusals.h"

#include <algorithm>
#include <string>
#include <utility>

namespace evod::network {
namespace {

base::Refusal no_such_subscription(const char* field, std::uint32_t subscription_id) {
    return {.code = base::RefusalCode::NotFound,
            .message = "this session has no such subscription",
            .violations = {{field, "one of this session's", std::to_string(subscription_id)}},
            .reason = base::Reason::SubscriptionNotFound};
}

void set_view(Session& session, const v1::Request& request, Streams& streams) {
    const std::uint64_t id = request.request_id();
    const std::uint32_t subscription_id = request.set_view().subscription_id();
    const auto found = session.snapshots.subscriptions.find(subscription_id);
    if (found == session.snapshots.subscriptions.end()) {
        return session.answer(
            protocol::refusing(id, no_such_subscription("set_view.subscription_id", subscription_id)));
    }
    if (!found->second.view) {
        return session.answer(protocol::refusing(
            id,
            refusal(
                base::RefusalCode::FailedPrecondition,
                "the subscription was created without a view: subscribe with SubscribeSnapshots.view, then change it",
                base::Reason::NoView)));
    }
    v1::Response response = response_to(id);
    response.mutable_subscription()->set_subscription_id(subscription_id);
    response.mutable_subscription()->set_rate_hz(found->second.rate_hz);
    session.answer(encode_response(std::move(response))); // the answer must precede the first snapshot of the new view
    return streams.set_view(session, subscription_id, request.set_view().view());
}

std::optional<base::Refusal> begin_snapshots(Session& session, const v1::SubscribeSnapshots& request,
                                             const protocol::FoundWorld& world, Streams& streams,
                                             LimitCounters& limit_counters, v1::Response& response) {
    const double rate_hz = std::clamp(request.rate_hz(), snapshot_rate_hz_min, snapshot_rate_hz_max);
    if (rate_hz < request.rate_hz()) {
        limit_counters.met(Limit::SnapshotRate);
    }
    auto subscription = streaming::to_subscription(request, world.name, world.island_count, rate_hz);
    std::size_t watched = subscription.island_count;
    for (const auto& [number, other] : session.snapshots.subscriptions) {
        watched += other.island_count;
    }
    if (watched > watched_islands_max) {
        limit_counters.met(Limit::WatchedIslands);
        return base::limit_refusal("the subscriptions of this session would come to more than " +
                                       std::to_string(watched_islands_max) +
                                       " islands: subscribe to single islands, or unsubscribe first",
                                   base::Reason::SubscriptionsMax, "watched_islands_max",
                                   watched - subscription.island_count, watched_islands_max);
    }
    response.mutable_subscription()->set_rate_hz(rate_hz);
    response.mutable_subscription()->set_subscription_id(streams.subscribe(session, std::move(subscription)));
    return std::nullopt;
}

} // namespace

bool change_subscription(Session& session, const v1::Request& request, Streams& streams) {
    const std::uint64_t id = request.request_id();
    if (request.has_unsubscribe()) {
        const std::uint32_t subscription_id = request.unsubscribe().subscription_id();
        session.answer(
            streams.unsubscribe(session, subscription_id)
                ? response_to(id)
                : protocol::refusing(id, no_such_subscription("unsubscribe.subscription_id", subscription_id)));
    } else if (request.has_request_keyframe()) {
        const std::uint32_t subscription_id = request.request_keyframe().subscription_id();
        session.answer(
            streams.send_keyframes(session, subscription_id)
                ? response_to(id)
                : protocol::refusing(id, no_such_subscription("request_keyframe.subscription_id", subscription_id)));
    } else if (request.has_set_view()) {
        set_view(session, request, streams);
    } else {
        return false;
    }
    return true;
}

std::optional<base::Refusal> begin_subscription(Session& session, const v1::Request& request,
                                                const protocol::FoundWorld& world, Streams& streams,
                                                LimitCounters& limit_counters, v1::Response& response) {
    if (session.snapshots.subscriptions.size() + session.events.size() >= subscriptions_max) {
        limit_counters.met(Limit::Subscriptions);
        return base::limit_refusal("this session already has " + std::to_string(subscriptions_max) +
                                       " subscriptions: unsubscribe from one first",
                                   base::Reason::SubscriptionsMax, "subscriptions_max",
                                   session.snapshots.subscriptions.size() + session.events.size(), subscriptions_max);
    }
    if (request.has_subscribe_snapshots()) {
        return begin_snapshots(session, request.subscribe_snapshots(), world, streams, limit_counters, response);
    }
    EventSubscription subscription;
    if (request.subscribe_events().has_world()) {
        subscription.world = world.name;
    }
    response.mutable_subscription()->set_subscription_id(streams.subscribe(session, std::move(subscription)));
    return std::nullopt;
}

} // namespace evod::network
