#include "client/viewer/world/island_data.h"

#include <utility>

namespace evod::viewer {

void IslandData::update(ViewedWorld& world, Needs needs, Clock::time_point now) {
    if (place_ != world.feed.place_number()) {
        forget();
        place_ = world.feed.place_number();
    }
    const auto& snapshot = world.feed.view().latest();
    if (!snapshot) {
        return;
    }
    if (snapshot != snapshot_) {
        take_snapshot(world.feed, snapshot);
    }
    keep_selection(world);
    if (const auto id = world.feed.selected(); id && (!selected_ || selected_->id() != *id || selected_->ended())) {
        selected_.emplace(*id, generation_);
        organism_poll_.reset();
        organism_tick_ = ~std::uint64_t{0};
    }
    if (const Population* complete = population_poll_.complete(); complete != nullptr && selected_) {
        selected_->add(*complete);
    }
    request_population(world, needs, now);
    request_organism(world, now);
}

// ---- snapshots -------------------------------------------------------------------------------------------------

void IslandData::forget() {
    IslandData fresh;
    fresh.kept_ = std::move(kept_);
    if (fresh.kept_) {
        fresh.kept_->out_of_sight = true;
    }
    *this = std::move(fresh);
}

void IslandData::take_snapshot(WorldFeed& feed, const std::shared_ptr<const codec::ReceivedSnapshot>& snapshot) {
    const auto& about = snapshot->about;
    if (run_id_ != about.run_id()) {
        if (!run_id_.empty()) { // the world was reset
            feed.select(std::nullopt);
            forget();
            kept_.reset();
        }
        place_ = feed.place_number();
        run_id_ = about.run_id();
    }
    snapshot_ = snapshot;
    generation_ = about.generation();
    tick_ = about.tick();
    if (!selected_) {
        return;
    }
    selected_->add_generation(generation_);
    if (selected_->ended() && feed.selected() == selected_->id()) {
        feed.select(std::nullopt); // the id now belongs to another organism
        if (kept_) {
            kept_->out_of_sight = true;
        }
    }
}

/// Remembers the selection, or restores it when its generation is on the screen again.
void IslandData::keep_selection(ViewedWorld& world) {
    if (const auto selected = world.feed.selected()) {
        kept_ = Kept{.run_id = run_id_,
                     .island = world.feed.island(),
                     .organism = *selected,
                     .generation = generation_,
                     .followed = followed_.has_value()};
    } else if (kept_ && !kept_->out_of_sight) { // the user cleared the selection
        kept_.reset();
    } else if (kept_ && kept_->run_id == run_id_ && kept_->island == world.feed.island() &&
               kept_->generation == generation_ && world.replay.target() == nullptr) {
        kept_->out_of_sight = false;
        world.feed.select(kept_->organism);
        if (kept_->followed) {
            followed_ = kept_->organism;
        }
    }
}

void IslandData::toggle_following(const WorldFeed& feed) {
    followed_ = followed_ ? std::nullopt : feed.selected();
}

// ---- requests --------------------------------------------------------------------------------------------------

void IslandData::request_population(ViewedWorld& world, Needs needs, Clock::time_point now) {
    const std::size_t gene_count = world.feed.gene_names().size();
    const bool ranges_missing = selected_ && !selected_->ended() && selected_->ranges().empty();
    const bool complete = // organisms may have been placed since the population was requested
        population() != nullptr && population()->size() >= snapshot_->about.live().organism_count();
    const bool wanted = (needs.genes || needs.forces || ranges_missing) && !population_poll_.is_unsupported() &&
                        gene_count > 0 && (!complete || (needs.forces && population_tick_ != tick_));
    const PopulationPoll::Of of{world.feed.world(), run_id_, world.feed.island(), gene_count};
    if (population_poll_.update(world, of, wanted, now)) {
        population_tick_ = tick_;
    }
}

void IslandData::request_organism(ViewedWorld& world, Clock::time_point now) {
    const bool alive = selected_ && !selected_->ended() && !selected_->dead();
    if (!organism_poll_.due(world, now) || !alive || organism_tick_ == tick_) {
        return;
    }
    organism_tick_ = tick_;
    evod::v1::Request request;
    request.mutable_get_organism()->set_world(world.feed.world());
    request.mutable_get_organism()->set_island(world.feed.island());
    request.mutable_get_organism()->set_organism(selected_->id());
    organism_poll_.send(world, std::move(request), now, [this](const evod::v1::Response* response) {
        if (response != nullptr && selected_) {
            selected_->add(response->organism());
        }
    });
}

} // namespace evod::viewer
