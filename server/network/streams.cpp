#include "server/network/streams.h"

#include "proto/wire/snapshot_codec.h"
#include "server/network/scene.h"
#include "server/protocol/events.h"
#include "server/protocol/worlds.h"
#include "server/simulation/world_name.h"

#include <algorithm>
#include <utility>
#include <vector>

namespace evod::network {
namespace {

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
        if (subscription.codec == v1::CODEC_DELTA)
            groups_[group_of(subscription)].next_picture = {};
    }
    session.snapshots.emplace(id, std::move(subscription));
    update_demand();
    if (joins)
        send_keyframes(session, id);
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
    if (found == session.snapshots.end())
        return false;
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
    if (!session.snapshots.empty() || !session.events.empty())
        update_demand();
}

void Streams::forget_world(const std::string& world) {
    for (auto& [name, group] : groups_)
        if (name.world == world)
            group.forget_pictures();
    for (const auto& [number, session] : sessions_)
        for (auto& [id, subscription] : session->snapshots)
            if (subscription.world == world)
                subscription.islands.clear();
}

template <class Do>
void Streams::each_newest(const SnapshotSubscription& subscription, const Do& what) const {
    const auto group = groups_.find(group_of(subscription));
    if (group == groups_.end() || subscription.codec != v1::CODEC_DELTA)
        return;
    const auto wanted = [&](std::uint32_t island) { return !subscription.island || *subscription.island == island; };
    for (const auto& [island, chain] : group->second.chains)
        if (wanted(island))
            what(island, SnapshotSubscription::Waiting{.sequence = chain.latest()->sequence(),
                                                       .columns = nullptr,
                                                       .chained = chain.latest(),
                                                       .tiled = nullptr});
    for (const auto& [island, tiled] : group->second.tiled)
        if (wanted(island))
            what(island, SnapshotSubscription::Waiting{
                             .sequence = tiled->sequence(), .columns = nullptr, .chained = nullptr, .tiled = tiled});
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
            if (subscription.island)
                watch.islands.push_back(*subscription.island);
            else
                watch.all_islands = true;
            if (subscription.codec != v1::CODEC_DELTA)
                continue;
            if (auto group = groups_.extract(group_of(subscription)))
                groups.insert(std::move(group));
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

/// When those who want so many pictures a second are to be shown the next.
class Pace {
  public:
    Pace(double rate_hz, runtime::Clock::time_point& next)
        : between_{std::chrono::duration_cast<runtime::Clock::duration>(std::chrono::duration<double>{1 / rate_hz})}
        , next_{next} {}

    runtime::Clock::duration between() const { return between_; }

    /// Whether this picture is for them; then the next is due a while later.
    bool takes(const runtime::Outbox::Picture& picture, runtime::Clock::time_point now) {
        // A tenth early rather than a whole picture late.
        if (!picture.after_change && now + between_ / 10 < next_)
            return false;
        next_ += between_;
        if (picture.after_change || next_ <= now)
            next_ = now + between_;
        return true;
    }

  private:
    runtime::Clock::duration between_;
    runtime::Clock::time_point& next_;
};

/// A snapshot's islands in the forms that several viewers share, each made when it is first wanted.
class EncodedIslands {
  public:
    EncodedIslands(const runtime::Snapshot& snapshot, std::uint64_t& sequence, wire::Compressor& compressor)
        : snapshot_{snapshot}, sequence_{sequence}, compressor_{compressor}, islands_(snapshot.islands.size()) {}

    const std::shared_ptr<const v1::SnapshotFrame>& about(std::size_t i) {
        Island& island = islands_[i];
        if (!island.about) {
            v1::SnapshotFrame about = about_of(snapshot_, snapshot_.islands[i]);
            about.set_sequence(++sequence_);
            wire::describe(*scene(i), about);
            island.about = std::make_shared<const v1::SnapshotFrame>(std::move(about));
        }
        return island.about;
    }
    const SharedBytes& columns(std::size_t i) {
        Island& island = islands_[i];
        if (!island.columns) {
            v1::SnapshotFrame frame = *about(i);
            wire::encode(*scene(i), frame);
            island.columns = std::make_shared<const std::string>(frame.SerializeAsString());
        }
        return island.columns;
    }
    const std::shared_ptr<const wire::Scene>& scene(std::size_t i) {
        Island& island = islands_[i];
        if (!island.scene)
            island.scene = std::make_shared<const wire::Scene>(scene_of(snapshot_.islands[i]));
        return island.scene;
    }
    const std::shared_ptr<IslandTiles>& tiles(std::size_t i) {
        Island& island = islands_[i];
        if (!island.tiles)
            island.tiles = std::make_shared<IslandTiles>(*about(i), scene(i), compressor_);
        return island.tiles;
    }

  private:
    struct Island {
        std::shared_ptr<const v1::SnapshotFrame> about;
        SharedBytes columns;
        std::shared_ptr<const wire::Scene> scene;
        std::shared_ptr<IslandTiles> tiles;
    };
    const runtime::Snapshot& snapshot_;
    std::uint64_t& sequence_;
    wire::Compressor& compressor_;
    std::vector<Island> islands_;
};

} // namespace

void Streams::show(const runtime::Outbox::Picture& picture, runtime::Clock::time_point now) {
    const runtime::Snapshot& snapshot = *picture.snapshot;
    EncodedIslands encoded{snapshot, sequence_, compressor_};
    struct Shown {
        double rate_hz;
        bool in_tiles;
        Group* group;
        runtime::Clock::duration between;
        std::vector<SnapshotSubscription::Waiting> islands; // what they come to with it
    };
    std::vector<Shown> shown; // the groups that are shown this picture
    for (auto& [name, group] : groups_) {
        if (name.world != snapshot.world)
            continue;
        Pace pace{name.rate_hz, group.next_picture};
        if (pace.takes(picture, now))
            shown.push_back({name.rate_hz, name.in_tiles, &group, pace.between(), {}});
    }
    for (Shown& of_group : shown) {
        of_group.islands.resize(snapshot.islands.size());
        if (std::exchange(of_group.group->run_id, snapshot.run_id) != snapshot.run_id)
            of_group.group->forget_pictures(); // a run before, which may have had more islands
    }
    for (const auto& [number, session] : sessions_) {
        bool has_some = false;
        for (auto& [id, subscription] : session->snapshots) {
            if (subscription.world != snapshot.world)
                continue;
            const bool in_group = subscription.codec == v1::CODEC_DELTA;
            const auto of_group = std::ranges::find_if(shown, [&wanted = subscription](const Shown& of) {
                return of.rate_hz == wanted.rate_hz && of.in_tiles == wanted.view.has_value();
            });
            if (in_group ? of_group == shown.end()
                         : !Pace{subscription.rate_hz, subscription.next_picture}.takes(picture, now))
                continue;
            session->count_dropped_pictures(subscription, picture.replaced_count);
            subscription.islands.erase(subscription.islands.lower_bound(snapshot.island_count), subscription.islands.end());
            for (std::size_t i = 0; i < snapshot.islands.size(); ++i) {
                const std::uint32_t island = snapshot.islands[i].island;
                if (subscription.island && *subscription.island != island)
                    continue;
                SnapshotSubscription::Waiting of_viewer;
                SnapshotSubscription::Waiting& waiting = in_group ? of_group->islands[i] : of_viewer;
                if (waiting) {
                    // Made for another of the group.
                } else if (!in_group) {
                    waiting.columns = encoded.columns(i);
                } else if (subscription.view) {
                    TiledPicturePtr& tiled = of_group->group->tiled[island];
                    tiled = waiting.tiled =
                        std::make_shared<TiledPicture>(encoded.tiles(i), tiled, now, of_group->between);
                } else {
                    waiting.chained = of_group->group->chains[island].add(encoded.about(i), encoded.scene(i),
                                                                          compressor_, now, of_group->between);
                }
                waiting.sequence = encoded.about(i)->sequence();
                session->picture(id, island, waiting);
                has_some = true;
            }
        }
        if (has_some)
            session->send_waiting();
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
        if (!wanted)
            continue;
        const bool views = session->visitor().role < access::Role::Controller;
        SharedBytes& form = views ? of_viewers : frame;
        if (!form) {
            v1::Event told = event;
            if (views)
                protocol::keep_users_only(told);
            form = encode_event(std::move(told));
        }
        session->event(form);
    }
}

std::function<void(const simulation::Laboratory&, std::vector<simulation::Event>)>
Streams::outlet(runtime::Outbox& outbox) {
    return [this, &outbox](const simulation::Laboratory& laboratory, const std::vector<simulation::Event>& events) {
        if (!demand_.events_wanted())
            return;
        for (const simulation::Event& event : events)
            outbox.event([this, told = protocol::to_proto(event, laboratory)]() mutable { tell(std::move(told)); });
    };
}

void Streams::deliver(runtime::Outbox::Taken taken, runtime::Clock::time_point now) {
    for (runtime::Delivery& delivery : taken.deliveries)
        std::exchange(delivery, nullptr)(); // what it held is not needed beside what it has made of it
    if (taken.dropped_events > 0)
        for (const auto& [number, session] : sessions_)
            if (!session->events.empty())
                session->count_dropped_events(taken.dropped_events);
    for (const auto& picture : taken.pictures)
        show(picture, now);
}

void Streams::announce_end() {
    v1::Event event;
    event.mutable_server_going_away();
    const SharedBytes frame = encode_event(std::move(event));
    for (const auto& [number, session] : sessions_)
        if (session->greeted())
            session->event(frame);
}

void Streams::end_sessions() {
    for (const auto& [number, session] : sessions_)
        session->finish();
}

} // namespace evod::network
