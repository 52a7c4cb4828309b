#include "server/network/streams.h"

#include "proto/wire/snapshot_codec.h"
#include "server/protocol/worlds.h"
#include "server/simulation/world_name.h"

#include <algorithm>
#include <bit>
#include <numeric>
#include <utility>
#include <vector>

namespace evod::network {
namespace {

/// The items that are there, with their ids.
struct PresentItems {
    std::vector<std::uint32_t> id;
    std::vector<std::int32_t> x, y;
};

wire::ItemColumns columns_of(const runtime::ItemsSnapshot& items, PresentItems& present) {
    const std::size_t count = items.x.size();
    if (items.due_tick.empty()) {
        present.id.resize(count);
        std::iota(present.id.begin(), present.id.end(), 0u);
        return {present.id, items.x, items.y};
    }
    present.id.resize(count);
    present.x.resize(count);
    present.y.resize(count);
    std::size_t kept = 0;
    for (std::size_t i = 0; i < count; ++i) { // without a branch: which items are away is unpredictable
        present.id[kept] = static_cast<std::uint32_t>(i);
        present.x[kept] = items.x[i];
        present.y[kept] = items.y[i];
        kept += items.due_tick[i] == 0;
    }
    present.id.resize(kept);
    present.x.resize(kept);
    present.y.resize(kept);
    return {present.id, present.x, present.y};
}

wire::BoxColumns columns_of(const runtime::BoxesSnapshot& boxes, std::size_t begin, std::size_t end) {
    const auto part = [=](const auto& column) { return std::span{column}.subspan(begin, end - begin); };
    return {part(boxes.x), part(boxes.y), part(boxes.half_width_px), part(boxes.half_height_px)};
}

} // namespace

v1::SnapshotFrame picture_frame(const runtime::Snapshot& snapshot, const runtime::IslandSnapshot& island) {
    v1::SnapshotFrame frame;
    frame.set_world(snapshot.world);
    frame.set_run_id(to_text(snapshot.run_id));
    frame.set_island(island.island);
    frame.set_island_count(snapshot.island_count);
    frame.set_tick(snapshot.moment.tick);
    frame.set_generation(snapshot.moment.generation);
    frame.set_generation_tick(snapshot.moment.generation_tick);
    frame.set_simulated_s(snapshot.moment.simulated_s);
    frame.set_state(protocol::to_proto(snapshot.state));
    *frame.mutable_speed() = protocol::to_proto(snapshot.speed);
    frame.set_state_hash(base::to_text(snapshot.hash));
    frame.set_item_radius_px(snapshot.item_radius_px);
    *frame.mutable_live() = protocol::to_proto(island.live, island.island);
    frame.set_ticks_per_s(snapshot.ticks_per_s);
    frame.set_slowed(snapshot.slowed);

    static thread_local PresentItems food, poison; // working memory, kept warm
    const std::size_t crates = island.crate_count, boxes = island.boxes.x.size();
    wire::encode({.width_px = island.width_px,
                  .height_px = island.height_px,
                  .position_fraction_bits = std::countr_zero(static_cast<unsigned>(physics::units_per_px)),
                  .organisms = {island.organisms.id, island.organisms.x, island.organisms.y, island.organisms.radius_px,
                                island.organisms.health},
                  .food = columns_of(island.food, food),
                  .poison = columns_of(island.poison, poison),
                  .crates = columns_of(island.boxes, 0, crates),
                  .obstacles = columns_of(island.boxes, crates, boxes)},
                 frame);
    return frame;
}

std::uint32_t Streams::subscribe(Session& session, SnapshotSubscription subscription) {
    const std::uint32_t id = session.next_subscription_id();
    subscription.newcomer = ++newcomers_;
    if (subscription.codec == v1::CODEC_DELTA)
        groups_[group_of(subscription)].next_picture = {}; // its first picture comes at once, to the whole group
    session.snapshots.emplace(id, std::move(subscription));
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
    const std::size_t found = session.snapshots.erase(subscription_id) + session.events.erase(subscription_id);
    update_demand();
    return found > 0;
}

bool Streams::send_keyframes(Session& session, std::uint32_t subscription_id) {
    const auto found = session.snapshots.find(subscription_id);
    if (found == session.snapshots.end())
        return false;
    const SnapshotSubscription& subscription = found->second;
    if (const auto group = groups_.find(group_of(subscription));
        group != groups_.end() && subscription.codec == v1::CODEC_DELTA)
        for (const auto& [island, chain] : group->second.chains)
            if (chain.latest() && (!subscription.island || *subscription.island == island))
                session.keyframe(subscription_id, island, chain.latest());
    return true;
}

Streams::GroupName Streams::group_of(const SnapshotSubscription& subscription) {
    return {subscription.world, subscription.rate_hz};
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
    EncodedIslands(const runtime::Snapshot& snapshot, std::uint64_t& sequence)
        : snapshot_{snapshot}, sequence_{sequence}, islands_(snapshot.islands.size()) {}

    const v1::SnapshotFrame& frame(std::size_t i) {
        Island& island = islands_[i];
        if (!island.frame) {
            island.frame = picture_frame(snapshot_, snapshot_.islands[i]);
            island.frame->set_sequence(++sequence_);
        }
        return *island.frame;
    }
    const SharedBytes& columns(std::size_t i) {
        Island& island = islands_[i];
        if (!island.columns)
            island.columns = std::make_shared<const std::string>(frame(i).SerializeAsString());
        return island.columns;
    }
    const std::shared_ptr<const wire::Scene>& scene(std::size_t i) {
        Island& island = islands_[i];
        if (!island.scene)
            island.scene = std::make_shared<const wire::Scene>(wire::scene_of(frame(i)));
        return island.scene;
    }

  private:
    struct Island {
        std::optional<v1::SnapshotFrame> frame;
        SharedBytes columns;
        std::shared_ptr<const wire::Scene> scene;
    };
    const runtime::Snapshot& snapshot_;
    std::uint64_t& sequence_;
    std::vector<Island> islands_;
};

} // namespace

void Streams::show(const runtime::Outbox::Picture& picture, runtime::Clock::time_point now) {
    const runtime::Snapshot& snapshot = *picture.snapshot;
    EncodedIslands encoded{snapshot, sequence_};
    // The groups that are shown this picture, and what of each island its chain comes to with it.
    std::map<const Group*, std::vector<ChainPicturePtr>> shown;
    for (auto& [name, group] : groups_)
        if (name.first == snapshot.world && Pace{name.second, group.next_picture}.takes(picture, now))
            shown[&group].resize(snapshot.islands.size());
    for (const auto& [number, session] : sessions_) {
        for (auto& [id, subscription] : session->snapshots) {
            if (subscription.world != snapshot.world)
                continue;
            Pace pace{subscription.rate_hz, subscription.next_picture};
            const bool chained = subscription.codec == v1::CODEC_DELTA;
            Group* const group = chained ? &groups_.at(group_of(subscription)) : nullptr;
            if (chained ? !shown.contains(group) : !pace.takes(picture, now))
                continue;
            session->count_dropped_pictures(subscription, picture.replaced_count);
            for (std::size_t i = 0; i < snapshot.islands.size(); ++i) {
                const std::uint32_t island = snapshot.islands[i].island;
                if (subscription.island && *subscription.island != island)
                    continue;
                SnapshotSubscription::Waiting waiting;
                waiting.sequence = encoded.frame(i).sequence();
                if (chained) {
                    ChainPicturePtr& link = shown[group][i];
                    if (!link)
                        link = group->chains[island].add(encoded.frame(i), encoded.scene(i), compressor_, now,
                                                         pace.between());
                    waiting.chained = link;
                } else {
                    waiting.columns = encoded.columns(i);
                }
                session->picture(id, island, std::move(waiting));
            }
        }
    }
}

void Streams::tell(v1::Event event) {
    const std::string world = event.world();
    SharedBytes frame;
    for (const auto& [number, session] : sessions_) {
        // "All worlds" are those that live: a look at the past is of interest to whoever names it.
        const bool wanted = std::any_of(session->events.begin(), session->events.end(), [&](const auto& item) {
            return item.second.world ? world.empty() || *item.second.world == world
                                     : simulation::is_world_name(world) || world.empty();
        });
        if (!wanted)
            continue;
        if (!frame)
            frame = encode_event(std::move(event));
        session->event(frame);
    }
}

void Streams::count_dropped_events(std::uint64_t count) {
    for (const auto& [number, session] : sessions_)
        if (!session->events.empty())
            session->count_dropped_events(count);
}

} // namespace evod::network
