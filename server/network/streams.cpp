#include "server/network/streams.h"

#include "proto/codec/snapshot_codec.h"
#include "server/protocol/actors.h"
#include "server/protocol/events.h"
#include "server/protocol/worlds.h"
#include "server/simulation/world_name.h"
#include "server/streaming/quantise.h"

#include <algorithm>
#include <utility>
#include <vector>

namespace evod::network {
namespace {

/// After so many steps other clients have their turn: 1 to 5 ms for small islands. An island takes one step, and one
/// for each viewer that it is handed to.
constexpr std::size_t steps_at_once = 128;

/// All of a picture's frame but what is in it, and its sequence.
v1::SnapshotFrame about_of(const runtime::Snapshot& snapshot, const runtime::IslandSnapshot& island) {
    v1::SnapshotFrame frame;
    frame.set_world(snapshot.world);
    frame.set_run_id(to_bytes(snapshot.run_id));
    frame.set_island(island.island);
    frame.set_island_count(snapshot.island_count);
    frame.set_width_px(island.width_px);
    frame.set_height_px(island.height_px);
    frame.set_tick(snapshot.moment.tick);
    frame.set_generation(snapshot.moment.generation);
    frame.set_generation_tick(snapshot.moment.generation_tick);
    frame.set_simulated_s(snapshot.moment.simulated_s);
    frame.set_state(protocol::to_proto(snapshot.state));
    *frame.mutable_speed() = protocol::to_proto(snapshot.speed);
    frame.set_state_hash(base::to_bytes(snapshot.hash));
    frame.set_item_radius_px(snapshot.item_radius_px);
    simulation::LiveStatistics live = island.live;
    live.health_mean = simulation::mean_health(island.organisms.health, island.organisms.alive_count);
    *frame.mutable_live() = protocol::to_proto(live, island.island);
    frame.set_ticks_per_s(snapshot.ticks_per_s);
    frame.set_slowed(snapshot.slowed);
    return frame;
}

} // namespace

std::uint32_t Streams::subscribe(Session& session, SnapshotSubscription subscription) {
    const std::uint32_t id = session.next_subscription_id();
    // One that joins others is sent the newest that they were; another one is made for who is the first.
    bool joins = false;
    each_newest(subscription, [&](std::uint32_t, const SnapshotSubscription::Waiting&) { joins = true; });
    if (!joins) {
        subscription.newcomer = ++newcomers_;
        if (subscription.codec == v1::CODEC_DELTA) {
            groups_[group_of(subscription)].next_picture = {};
        }
    }
    session.snapshots.emplace(id, std::move(subscription));
    update_demand();
    if (joins) {
        send_keyframes(session, id);
    }
    return id;
}

std::uint32_t Streams::subscribe(Session& session, EventSubscription subscription) {
    const std::uint32_t id = session.next_subscription_id();
    session.events.emplace(id, std::move(subscription));
    update_demand();
    return id;
}

bool Streams::unsubscribe(Session& session, std::uint32_t subscription_id) {
    const std::size_t found = session.snapshots.erase(subscription_id) + session.events.erase(subscription_id);
    update_demand();
    return found > 0;
}

bool Streams::send_keyframes(Session& session, std::uint32_t subscription_id) {
    const auto found = session.snapshots.find(subscription_id);
    if (found == session.snapshots.end()) {
        return false;
    }
    each_newest(found->second, [&](std::uint32_t island, SnapshotSubscription::Waiting newest) {
        session.keyframe(subscription_id, island, std::move(newest));
    });
    return true;
}

void Streams::set_view(Session& session, std::uint32_t subscription_id, const v1::View& view) {
    SnapshotSubscription& subscription = session.snapshots.at(subscription_id);
    subscription.set_view(view);
    each_newest(subscription, [&](std::uint32_t island, SnapshotSubscription::Waiting newest) {
        session.show_again(subscription_id, island, std::move(newest));
    });
}

void Streams::forget(const Session& session) {
    if (!session.snapshots.empty() || !session.events.empty()) {
        update_demand();
    }
}

void Streams::forget_world(const std::string& world) {
    for (auto& [name, group] : groups_) {
        if (name.world == world) {
            group.forget_pictures();
        }
    }
    for (const auto& [number, session] : sessions_) {
        for (auto& [id, subscription] : session->snapshots) {
            if (subscription.world == world) {
                subscription.islands.clear();
            }
        }
    }
    std::erase_if(in_progress_, [&](const InProgress& of) { return of.picture.snapshot->world == world; });
}

template <class Do>
void Streams::each_newest(const SnapshotSubscription& subscription, const Do& what) const {
    const auto group = groups_.find(group_of(subscription));
    if (group == groups_.end() || subscription.codec != v1::CODEC_DELTA) {
        return;
    }
    const auto wanted = [&](std::uint32_t island) { return !subscription.island || *subscription.island == island; };
    for (const auto& [island, chain] : group->second.chains) {
        if (wanted(island)) {
            what(island,
                 SnapshotSubscription::Waiting{.sequence = chain.latest()->sequence(), .chained = chain.latest()});
        }
    }
    for (const auto& [island, tiled] : group->second.tiled) {
        if (wanted(island)) {
            what(island, SnapshotSubscription::Waiting{.sequence = tiled->sequence(), .tiled = tiled});
        }
    }
}

Streams::GroupName Streams::group_of(const SnapshotSubscription& subscription) {
    return {subscription.world, subscription.rate_hz, subscription.view.has_value()};
}

void Streams::update_demand() {
    runtime::Watches watches;
    bool events = false;
    std::map<GroupName, Group> groups; // those that still have somebody
    for (const auto& [number, session] : sessions_) {
        events = events || !session->events.empty();
        for (const auto& [id, subscription] : session->snapshots) {
            runtime::Watch& watch = watches[subscription.world];
            watch.rate_hz = std::max(watch.rate_hz, subscription.rate_hz);
            watch.newcomers = std::max(watch.newcomers, subscription.newcomer);
            if (subscription.island) {
                watch.islands.push_back(*subscription.island);
            } else {
                watch.all_islands = true;
            }
            if (subscription.codec != v1::CODEC_DELTA) {
                continue;
            }
            if (auto group = groups_.extract(group_of(subscription))) {
                groups.insert(std::move(group));
            }
        }
    }
    groups_ = std::move(groups);
    for (auto& [world, watch] : watches) {
        std::sort(watch.islands.begin(), watch.islands.end());
        watch.islands.erase(std::unique(watch.islands.begin(), watch.islands.end()), watch.islands.end());
    }
    demand_.want_events(events);
    demand_.set(std::move(watches));
    mailbox_.wake();
}

namespace {

runtime::Clock::duration between_pictures(double rate_hz) {
    return std::chrono::duration_cast<runtime::Clock::duration>(std::chrono::duration<double>{1 / rate_hz});
}

/// When those who want so many pictures a second are to be shown the next.
class Pace {
  public:
    Pace(double rate_hz, runtime::Clock::time_point& next) : between_{between_pictures(rate_hz)}, next_{next} {}

    /// Whether this picture is for them; then the next is due a while later.
    bool takes(const runtime::Outbox::Picture& picture, runtime::Clock::time_point now) {
        // A tenth early rather than a whole picture late.
        if (!picture.after_change && now + between_ / 10 < next_) {
            return false;
        }
        next_ += between_;
        if (picture.after_change || next_ <= now) {
            next_ = now + between_;
        }
        return true;
    }

  private:
    runtime::Clock::duration between_;
    runtime::Clock::time_point& next_;
};

} // namespace

/// An island of a snapshot in the forms that several viewers share, each made when it is first wanted.
class EncodedIsland {
  public:
    EncodedIsland(const runtime::Snapshot& snapshot, const runtime::IslandSnapshot& island, std::uint64_t& sequence,
                  codec::Compressor& compressor)
        : snapshot_{snapshot}, island_{island}, sequence_{sequence}, compressor_{compressor} {}

    std::uint32_t number() const { return island_.island; }
    const std::shared_ptr<const v1::SnapshotFrame>& about() {
        if (!about_) {
            v1::SnapshotFrame about = about_of(snapshot_, island_);
            about.set_sequence(++sequence_);
            codec::describe(*scene(), about);
            about_ = std::make_shared<const v1::SnapshotFrame>(std::move(about));
        }
        return about_;
    }
    const SharedBytes& columns() {
        if (!columns_) {
            v1::SnapshotFrame frame = *about();
            codec::encode(*scene(), frame);
            columns_ = std::make_shared<const std::string>(frame.SerializeAsString());
        }
        return columns_;
    }
    const std::shared_ptr<const codec::QuantisedSnapshot>& scene() {
        if (!scene_) {
            scene_ = std::make_shared<const codec::QuantisedSnapshot>(streaming::quantise(island_));
        }
        return scene_;
    }
    const std::shared_ptr<streaming::IslandTiles>& tiles() {
        if (!tiles_) {
            tiles_ = std::make_shared<streaming::IslandTiles>(*about(), scene(), compressor_);
        }
        return tiles_;
    }

  private:
    const runtime::Snapshot& snapshot_;
    const runtime::IslandSnapshot& island_;
    std::uint64_t& sequence_;
    codec::Compressor& compressor_;
    std::shared_ptr<const v1::SnapshotFrame> about_;
    SharedBytes columns_;
    std::shared_ptr<const codec::QuantisedSnapshot> scene_;
    std::shared_ptr<streaming::IslandTiles> tiles_;
};

struct Streams::Viewer {
    SessionPtr session;
    std::uint32_t subscription_id;
    const SnapshotSubscription* subscription;
    Group* group; // null: in none
    bool has_some = false;
};

void Streams::deliver(runtime::Outbox::Taken taken) {
    for (runtime::Delivery& delivery : taken.deliveries) {
        std::exchange(delivery, nullptr)(); // what it held is not needed beside what it has made of it
    }
    if (taken.dropped_events > 0) {
        for (const auto& [number, session] : sessions_) {
            if (!session->events.empty()) {
                session->count_dropped_events(taken.dropped_events);
            }
        }
    }
    for (runtime::Outbox::Picture& picture : taken.pictures) {
        const auto of = std::ranges::find_if(in_progress_, [&](const InProgress& other) {
            return other.picture.snapshot->world == picture.snapshot->world;
        });
        if (of == in_progress_.end()) {
            in_progress_.push_back({.picture = std::move(picture)});
            continue;
        }
        if (of->next) {
            picture.replaced_count += of->next->replaced_count + 1;
            picture.after_change = picture.after_change || of->next->after_change;
        }
        of->next = std::move(picture);
    }
}

bool Streams::send_some(runtime::Clock::time_point now) {
    std::size_t steps_left = steps_at_once;
    while (steps_left > 0 && !in_progress_.empty()) {
        InProgress of = std::move(in_progress_.front());
        in_progress_.pop_front();
        if (!of.begun) {
            begin(of, now);
        }
        advance(of, steps_left);
        if (of.next_island < of.picture.snapshot->islands.size()) {
            in_progress_.push_back(std::move(of));
        } else if (of.next) {
            in_progress_.push_back({.picture = std::move(*of.next)});
        }
    }
    return !in_progress_.empty();
}

void Streams::begin(InProgress& of, runtime::Clock::time_point now) {
    const runtime::Snapshot& snapshot = *of.picture.snapshot;
    of.begun = true;
    of.began = now;
    for (auto& [name, group] : groups_) {
        if (name.world != snapshot.world || !Pace{name.rate_hz, group.next_picture}.takes(of.picture, now)) {
            continue;
        }
        of.groups.insert(name);
        if (std::exchange(group.run_id, snapshot.run_id) != snapshot.run_id) {
            group.forget_pictures(); // a run before, which may have had more islands
        }
    }
    for (const auto& [number, session] : sessions_) {
        for (auto& [id, subscription] : session->snapshots) {
            if (subscription.world != snapshot.world) {
                continue;
            }
            if (subscription.codec == v1::CODEC_DELTA) {
                if (!of.groups.contains(group_of(subscription))) {
                    continue;
                }
            } else {
                if (!Pace{subscription.rate_hz, subscription.next_picture}.takes(of.picture, now)) {
                    continue;
                }
                of.subscriptions.emplace(number, id);
            }
            session->count_dropped_pictures(subscription, of.picture.replaced_count);
            subscription.islands.erase(subscription.islands.lower_bound(snapshot.island_count),
                                       subscription.islands.end());
        }
    }
}

std::vector<Streams::Viewer> Streams::viewers_of(const InProgress& of) {
    std::vector<Viewer> viewers;
    for (const auto& [number, session] : sessions_) {
        for (const auto& [id, subscription] : session->snapshots) {
            if (subscription.world != of.picture.snapshot->world) {
                continue;
            }
            if (subscription.codec != v1::CODEC_DELTA) {
                if (of.subscriptions.contains({number, id})) {
                    viewers.push_back({session, id, &subscription, nullptr});
                }
            } else if (const GroupName name = group_of(subscription); of.groups.contains(name)) {
                viewers.push_back({session, id, &subscription, &groups_.at(name)});
            }
        }
    }
    return viewers;
}

SnapshotSubscription::Waiting Streams::encode_for(const Viewer& viewer, EncodedIsland& island, const InProgress& of) {
    const SnapshotSubscription& subscription = *viewer.subscription;
    SnapshotSubscription::Waiting waiting{.sequence = island.about()->sequence()};
    const auto between = between_pictures(subscription.rate_hz);
    if (viewer.group == nullptr) {
        waiting.columns = island.columns();
    } else if (subscription.view) {
        streaming::TiledSnapshotPtr& newest = viewer.group->tiled[island.number()];
        if (!newest || newest->sequence() != waiting.sequence) { // otherwise it was made for another of the group
            newest = std::make_shared<streaming::TiledSnapshot>(island.tiles(), newest, of.began, between);
        }
        waiting.tiled = newest;
    } else {
        streaming::DeltaStream& chain = viewer.group->chains[island.number()];
        if (!chain.latest() || chain.latest()->sequence() != waiting.sequence) {
            chain.add(island.about(), island.scene(), compressor_, of.began, between);
        }
        waiting.chained = chain.latest();
    }
    return waiting;
}

void Streams::advance(InProgress& of, std::size_t& steps_left) {
    const runtime::Snapshot& snapshot = *of.picture.snapshot;
    std::vector<Viewer> viewers = viewers_of(of);
    if (viewers.empty()) {
        of.next_island = snapshot.islands.size();
    }
    for (; steps_left > 0 && of.next_island < snapshot.islands.size(); ++of.next_island) {
        EncodedIsland island{snapshot, snapshot.islands[of.next_island], sequence_, compressor_};
        std::size_t steps = 1;
        for (Viewer& viewer : viewers) {
            if (viewer.subscription->island && *viewer.subscription->island != island.number()) {
                continue;
            }
            viewer.session->picture(viewer.subscription_id, island.number(), encode_for(viewer, island, of));
            viewer.has_some = true;
            ++steps;
        }
        steps_left -= std::min(steps_left, steps);
    }
    for (const Viewer& viewer : viewers) {
        if (viewer.has_some) {
            viewer.session->send_waiting();
        }
    }
}

void Streams::tell(v1::Event event) {
    const std::string world = event.world();
    SharedBytes frame, of_viewers;
    for (const auto& [number, session] : sessions_) {
        // "All worlds" are those that live: a look at the past is of interest to whoever names it.
        const bool wanted = std::any_of(session->events.begin(), session->events.end(), [&](const auto& item) {
            return item.second.world ? world.empty() || *item.second.world == world
                                     : simulation::is_world_name(world) || world.empty();
        });
        if (!wanted) {
            continue;
        }
        const bool views = session->visitor().role < access::Role::Controller;
        SharedBytes& form = views ? of_viewers : frame;
        if (!form) {
            v1::Event told = event;
            if (views) {
                protocol::keep_users_only(told);
            }
            form = encode_event(std::move(told));
        }
        session->event(form);
    }
}

std::function<void(const simulation::Laboratory&, std::vector<simulation::Event>)>
Streams::outlet(runtime::Outbox& outbox) {
    return [this, &outbox](const simulation::Laboratory& laboratory, const std::vector<simulation::Event>& events) {
        if (!demand_.events_wanted()) {
            return;
        }
        for (const simulation::Event& event : events) {
            outbox.event([this, told = protocol::to_proto(event, laboratory)]() mutable { tell(std::move(told)); });
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
