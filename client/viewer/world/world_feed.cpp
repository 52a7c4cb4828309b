#include "client/viewer/world/world_feed.h"

#include "client/viewer/world/status_text.h"

#include <algorithm>
#include <atomic>
#include <utility>

namespace evod::viewer {

namespace {

std::uint64_t next_place_number() {
    static std::atomic<std::uint64_t> numbers{0};
    return ++numbers;
}

} // namespace

WorldFeed::WorldFeed(ServerConnection& server, const WantedWorld& wanted)
    : server_{server}
    , world_{wanted.world}
    , servers_choice_{wanted.world.empty()}
    , island_{wanted.island}
    , rate_hz_{wanted.rate_hz}
    , all_islands_{wanted.all_islands}
    , place_number_{next_place_number()} {
    // Subscribe to the events of all worlds, because a world that does not exist yet may be created later.
    event_subscription_ = server_.connection().subscribe(evod::v1::SubscribeEvents{});
    subscribe();
}

void WorldFeed::subscribe() {
    evod::v1::SubscribeSnapshots subscription;
    subscription.set_world(world_);
    if (!all_islands_) {
        subscription.set_island(island_);
    }
    subscription.set_rate_hz(rate_hz_);
    if (streamed_view_) {
        *subscription.mutable_view() = *streamed_view_;
    }
    snapshot_subscription_ = server_.connection().subscribe(subscription);
}

/// If a view is set, subscribes to densities of the whole island, once a second. Otherwise ends that subscription.
void WorldFeed::subscribe_overview() {
    if (overview_subscription_) {
        server_.connection().unsubscribe(*std::exchange(overview_subscription_, std::nullopt));
        overview_snapshot_ = nullptr;
    }
    if (streamed_view_) {
        evod::v1::SubscribeSnapshots subscription;
        subscription.set_world(world_);
        subscription.set_island(island_);
        subscription.set_rate_hz(1);
        subscription.mutable_view()->set_detail(evod::v1::DETAIL_DENSITY);
        overview_subscription_ = server_.connection().subscribe(subscription);
    }
}

// ---- what is shown ---------------------------------------------------------------------------------------------

void WorldFeed::begin_place() {
    place_number_ = next_place_number();
    selected_.reset();
}

void WorldFeed::forget_genes() {
    gene_names_.clear();
    gene_groups_.clear();
}

void WorldFeed::show(std::string world, std::uint32_t island) {
    if (world != world_) {
        control_.forget();
        forget_genes();
        last_generation_.clear();
        server_.drop_answers(); // answers about the old world are obsolete
        replay_.reset();
    }
    world_ = std::move(world);
    servers_choice_ = world_.empty();
    island_ = island;
    begin_place();
    streamed_view_.reset();
    subscribe_overview();
    views_.clear();
    rankings_.clear();
    server_.connection().unsubscribe(snapshot_subscription_);
    subscribe();
    request_statistics();
}

void WorldFeed::set_view(std::optional<evod::v1::View> view) {
    const bool had_view = streamed_view_.has_value();
    streamed_view_ = std::move(view);
    if (had_view && streamed_view_) {
        server_.connection().set_view(snapshot_subscription_, *streamed_view_);
    } else if (had_view || streamed_view_) { // a subscription cannot gain or lose its view, so it must be replaced
        server_.connection().unsubscribe(snapshot_subscription_);
        subscribe();
        subscribe_overview();
    }
}

void WorldFeed::choose_island(std::uint32_t island) {
    if (island == island_) {
        return;
    }
    if (all_islands_) {
        island_ = island;
        begin_place();
    } else {
        show(world_, island);
    }
}

void WorldFeed::cycle_island(int by) {
    if (const codec::ReceivedSnapshot* shown = snapshot()) {
        const auto count = std::max<std::int64_t>(shown->about.island_count(), 1);
        choose_island(static_cast<std::uint32_t>((std::int64_t{island_} + by + count) % count));
    } else { // perhaps the world does not have the chosen island
        choose_island(0);
    }
}

void WorldFeed::show_all_islands(bool all) {
    if (all != all_islands_) {
        all_islands_ = all;
        show(world_, island_);
    }
}

// ---- what arrives ----------------------------------------------------------------------------------------------

void WorldFeed::request_statistics(const std::string& world) {
    evod::v1::Request request;
    request.mutable_get_statistics()->set_world(world);
    server_.send(std::move(request), [this](const core::Result<evod::v1::Response>& response) {
        if (response && response->has_statistics()) {
            const evod::v1::Statistics& statistics = response->statistics();
            take_info(statistics.world());
            storage_ = statistics.world().storage();
            last_generation_.assign(statistics.last().begin(), statistics.last().end());
        } // refused requests need no notice: refusal() explains why there are no snapshots
    });
}

void WorldFeed::take_info(const evod::v1::WorldInfo& world) {
    control_.update(world);
    gene_names_.assign(world.gene_names().begin(), world.gene_names().end());
    gene_groups_.clear();
    for (int i = 0; i < world.gene_groups_size(); ++i) {
        gene_groups_.push_back(world.gene_groups(i));
    }
    replay_.reset();
    if (world.has_replay()) {
        replay_ = world.replay();
    }
}

void WorldFeed::take_events() {
    events_ = server_.connection().take_events();
}

void WorldFeed::apply(const evod::v1::Event& event) {
    if (event.has_storage_changed() && (event.world().empty() || event.world() == world_)) {
        const bool had_problem = !storage_text(storage_).empty();
        storage_ = event.storage_changed().storage();
        if (had_problem && storage_text(storage_).empty()) {
            server_.notice("Run files can be written again");
        }
    } else if (event.has_events_dropped()) {
        request_statistics();
    }
    if (!control_.known() || event.world() != control_.world()) {
        return;
    }
    switch (event.kind_case()) {
    case evod::v1::Event::kGenerationFinished:
        last_generation_.assign(event.generation_finished().statistics().begin(),
                                event.generation_finished().statistics().end());
        break;
    case evod::v1::Event::kFitnessAwaited:
        control_.update(event.fitness_awaited());
        break;
    case evod::v1::Event::kFitnessSet: {
        evod::v1::AwaitedFitness awaited;
        awaited.set_generation(event.fitness_set().generation());
        *awaited.mutable_islands() = event.fitness_set().awaited_islands();
        control_.update(std::move(awaited));
        break;
    }
    case evod::v1::Event::kRunControlChanged:
        take_info(event.run_control_changed().world());
        break;
    case evod::v1::Event::kWorldReset:
        take_info(event.world_reset().world());
        last_generation_.clear();
        break;
    case evod::v1::Event::kRunTerminated:
        request_statistics(); // to receive the outcome of the run
        break;
    default:
        break;
    }
}

bool WorldFeed::take_snapshots(Clock::time_point now) {
    core::Connection& connection = server_.connection();
    if (auto overview = overview_subscription_ ? connection.take_snapshot(*overview_subscription_, island_) : nullptr) {
        overview_snapshot_ = std::move(overview);
    }
    auto snapshots = connection.take_snapshots(snapshot_subscription_);
    for (auto& snapshot : snapshots) {
        if (control_.known() && snapshot->about.run_id() != control_.run_id()) {
            request_statistics(); // another run has another last generation and other genes
            forget_genes();
        }
        if (servers_choice_) { // later requests must name it, because there may then be other worlds
            world_ = snapshot->about.world();
        }
        control_.update(snapshot->about);
        views_[snapshot->about.island()].add(std::move(snapshot), now);
    }
    return !snapshots.empty();
}

// ---- what is known ---------------------------------------------------------------------------------------------

const codec::ReceivedSnapshot* WorldFeed::snapshot_of(std::uint32_t island) const {
    const auto view = views_.find(island);
    return view == views_.end() ? nullptr : view->second.latest().get();
}

std::uint32_t WorldFeed::island_count() const {
    for (const auto& [island, view] : views_) {
        if (view.latest()) {
            return std::max(view.latest()->about.island_count(), 1u);
        }
    }
    return 1;
}

const evod::v1::GenerationStatistics* WorldFeed::last_generation() const {
    const auto island = std::ranges::find(last_generation_, island_, &evod::v1::GenerationStatistics::island);
    return island == last_generation_.end() ? nullptr : &*island;
}

std::optional<std::string> WorldFeed::refusal() const {
    const auto answer = server_.connection().subscription_answer(snapshot_subscription_);
    return !answer || core::accepted(*answer) ? std::nullopt : std::optional{refusal_text(answer->status())};
}

} // namespace evod::viewer
