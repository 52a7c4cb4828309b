// Subscription requests: begin, change and end the subscriptions of a session, and answer the requests for this.
//
// Threads      the network thread.
#pragma once

#include "server/network/session.h"
#include "server/network/streams.h"
#include "server/protocol/queries.h"

#include <optional>

namespace evod::network {

/// Answers a request that ends or changes a subscription. Returns false, and does not answer, if the request begins a
/// subscription: the simulation thread must then find the world.
bool change_subscription(Session& session, const v1::Request& request, Streams& streams);

/// Begins the subscription that was requested, and completes the response. Returns nullopt, or the refusal.
std::optional<base::Refusal> begin_subscription(Session& session, const v1::Request& request,
                                                const protocol::FoundWorld& world, Streams& streams,
                                                LimitCounters& limit_counters, v1::Response& response);

} // namespace evod::network
