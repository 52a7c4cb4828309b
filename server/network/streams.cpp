#include "server/network/streams.h"

#include "server/protocol/actors.h"
#include "server/protocol/events.h"
#include "server/simulation/world_name.h"

#include <algorithm>
#include <utility>

namespace evod::network {

std::uint32_t Streams::subscribe(Session& session, streaming::SnapshotSubscription subscription) {
    const std::uint32_t id = session.next_subscription_id();
    session.charge(subscription.island_count);
    snapshots_.subscribe(session.number(), session.snapshots, id, std::move(subscription));
    session.count_subscriptions();
    update_demand();
    return id;
}

std::uint32_t Streams::subscribe(Session& session, EventSubscription subscription) {
    const std::uint32_t id = session.next_subscription_id();
    session.events.emplace(id, std::move(subscription));
    update_demand();
    return id;
}

bool Streams::unsubscribe(Session& session, std::uint32_t subscription_id) {
    const bool found = snapshots_.unsubscribe(session.number(), session.snapshots, subscription_id) ||
                       session.events.erase(subscription_id) > 0;
    if (found) {
        session.count_subscriptions();
        update_demand();
    }
    return found;
}

bool Streams::send_keyframes(Session& session, std::uint32_t subscription_id) {
    const auto sent = snapshots_.send_keyframes(session.snapshots, subscription_id);
    session.charge(sent.value_or(0));
    session.count_subscriptions();
    return sent.has_value();
}

void Streams::set_view(Session& session, std::uint32_t subscription_id, const v1::View& view) {
    session.charge(snapshots_.set_view(session.snapshots, subscription_id, view));
    session.count_subscriptions();
}

void Streams::forget(const Session& session) {
    snapshots_.forget(session.number());
    if (!session.snapshots.subscriptions.empty() || !session.events.empty()) {
        update_demand();
    }
}

void Streams::forget_world(const std::string& world) {
    snapshots_.forget_world(world);
}

void Streams::update_demand() {
    simulations_.set_demand(snapshots_.demand(), std::ranges::any_of(sessions_, [](const auto& item) {
                                return !item.second->events.empty();
                            }));
}

void Streams::deliver(runtime::Outbox::Taken taken) {
    for (const auto& [user, count] : taken.dropped_events) {
        for (const auto& [number, session] : sessions_) {
            if (!session->events.empty() && (user.empty() || session->account() == user)) {
                session->count_dropped_events(count);
            }
        }
    }
    snapshots_.deliver(std::move(taken.snapshots));
}

void Streams::publish(v1::Event event) {
    const std::string world = event.world();
    SharedBytes frame, for_viewers;
    for (const auto& [number, session] : sessions_) {
        // A subscription to all worlds does not include replays. A session receives events of a replay only if its
        // subscription names that replay.
        const bool wanted = std::any_of(session->events.begin(), session->events.end(), [&](const auto& item) {
            return item.second.world ? world.empty() || *item.second.world == world
                                     : simulation::is_world_name(world) || world.empty();
        });
        // A subscription to snapshots ends with these events, although the session may have no subscription to events.
        const bool ends_snapshots = (event.has_world_damaged() || event.has_world_deleted()) &&
                                    std::ranges::any_of(session->snapshots.subscriptions,
                                                        [&](const auto& item) { return item.second.world == world; });
        if (!wanted && !ends_snapshots) {
            continue;
        }
        const bool is_viewer = session->user().role < access::Role::Controller;
        SharedBytes& form = is_viewer ? for_viewers : frame;
        if (!form) {
            v1::Event message = event;
            if (is_viewer) {
                protocol::keep_users_only(message);
            }
            form = encode_event(std::move(message));
        }
        session->event(form);
    }
}

decltype(runtime::LoopOutputs::events) Streams::outlet(runtime::Outbox& outbox) {
    return [this, &outbox](const simulation::Laboratory& laboratory, const std::vector<simulation::Event>& events,
                           const runtime::LoopOutputs::UserOf& user_of) {
        if (!simulations_.events_wanted()) {
            return;
        }
        for (const simulation::Event& event : events) {
            outbox.event(protocol::to_proto(event, laboratory), user_of(event.world));
        }
    };
}

void Streams::announce_end() {
    v1::Event event;
    event.mutable_server_going_away();
    const SharedBytes frame = encode_event(std::move(event));
    for (const auto& [number, session] : sessions_) {
        if (session->greeted()) {
            session->event(frame);
        }
    }
}

void Streams::end_sessions() {
    for (const auto& [number, session] : sessions_) {
        session->finish();
    }
}

} // namespace evod::network
