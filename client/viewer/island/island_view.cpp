#include "client/viewer/island/island_view.h"

#include <algorithm>
#include <utility>

namespace evod::viewer {

namespace {

constexpr double dots_radius_pixels = 2; // organisms smaller than this are streamed as dots

} // namespace

ViewOptions default_options(Look look) {
    const bool vivid = look.skin == Skin::Vivid;
    return {.look = look, .trails = vivid, .flashes = vivid, .radii = vivid ? Which::Pointed : Which::None};
}

// ---- the region ------------------------------------------------------------------------------------------------

std::optional<evod::v1::View> StreamedRegion::update(const Camera& camera, evod::v1::Detail detail,
                                                     Clock::time_point now) {
    const Rectangle visible = camera.visible();
    const bool covered = region_ && region_->contains({visible.left, visible.top}) &&
                         region_->contains({visible.left + visible.width, visible.top + visible.height});
    const bool is_far_too_large = region_ && region_->width > 6 * visible.width;
    if ((covered && !is_far_too_large && detail == detail_) || (region_ && now - changed_ < interval)) {
        return std::nullopt;
    }
    region_ = {visible.left - visible.width / 2, visible.top - visible.height / 2, 2 * visible.width,
               2 * visible.height};
    detail_ = detail;
    changed_ = now;
    evod::v1::View view;
    view.mutable_region()->set_left_px(region_->left);
    view.mutable_region()->set_top_px(region_->top);
    view.mutable_region()->set_width_px(region_->width);
    view.mutable_region()->set_height_px(region_->height);
    view.set_detail(detail);
    return view;
}

void IslandView::update_stream(ViewedWorld& world, const Camera& camera, Clock::time_point now) {
    if (world.feed.all_islands()) { // a view would restrict the snapshots of all islands
        region_.forget();
        return;
    }
    const auto& about = snapshot_->about;
    in_part_ = in_part_ || std::max(about.organism_count(), about.live().organism_count()) >= streamed_in_part_min;
    if (!in_part_) {
        return;
    }
    const bool details_of_all = (options.radii == Which::All || options.forces == Which::All) && shows_details(camera);
    const bool no_single_organism_matters =
        options.colour_by == ColourBy::Nothing && !details_of_all && !world.feed.selected();
    const bool small = typical_radius_px * camera.zoom() < dots_radius_pixels;
    const auto detail = shows_density(camera, *snapshot_)     ? evod::v1::DETAIL_DENSITY
                        : small && no_single_organism_matters ? evod::v1::DETAIL_DOTS
                                                              : evod::v1::DETAIL_FULL;
    if (auto view = region_.update(camera, detail, now)) {
        world.feed.set_view(std::move(view));
    }
}

bool IslandView::shows_density(const Camera& camera, const codec::ReceivedSnapshot& snapshot) const {
    const evod::v1::SnapshotFrame& island = snapshot.about;
    const std::size_t streamed = snapshot.entities->organisms.x.size();
    const double count =
        std::max({double(island.organism_count()), double(island.live().organism_count()), double(streamed)});
    return options.density && options.colour_by == ColourBy::Nothing && too_small_to_see(camera) &&
           too_many_for_dots(camera, island, count);
}

// ---- requests --------------------------------------------------------------------------------------------------

PopulationPoll::Of IslandView::population_of(const ViewedWorld& world) const {
    return {world.feed.world(), shown_.run_id, world.feed.island(), gene_names_.size()};
}

bool IslandView::needs_population(bool points_at) const {
    const bool any_pointed = points_at || (selected_organism_ && !selected_organism_->ended());
    const auto drawn = [&](Which which) { return which == Which::All || (which == Which::Pointed && any_pointed); };
    const bool forces = drawn(options.forces);
    const bool current_needed =
        options.colour_by == ColourBy::Gene || drawn(options.radii) || forces ||
        (selected_organism_ && !selected_organism_->ended() && selected_organism_->ranges().empty());
    if (!current_needed || population_poll_.is_unsupported() || gene_names_.empty()) {
        return false;
    }
    const bool complete = // organisms may have been placed since the population was requested
        population() != nullptr && population()->size() >= snapshot_->about.live().organism_count();
    return !complete || (forces && population_tick_ != tick_);
}

void IslandView::take_population() {
    const Population* complete = population_poll_.complete();
    if (complete != nullptr && selected_organism_) {
        selected_organism_->add(*complete);
    }
}

void IslandView::request_organism(ViewedWorld& world, Clock::time_point now) {
    organism_tick_ = tick_;
    evod::v1::Request request;
    request.mutable_get_organism()->set_world(world.feed.world());
    request.mutable_get_organism()->set_island(world.feed.island());
    request.mutable_get_organism()->set_organism(selected_organism_->id());
    organism_poll_.send(world, std::move(request), now, [this](const evod::v1::Response* response) {
        if (response != nullptr && selected_organism_) {
            selected_organism_->add(response->organism());
        }
    });
}

// ---- the selection in other generations --------------------------------------------------------------------------

/// Remembers the selection, or restores it when its generation is on the screen again.
void IslandView::keep_selection(ViewedWorld& world) {
    if (const auto selected = world.feed.selected()) {
        kept_ = Kept{.run_id = shown_.run_id,
                     .island = world.feed.island(),
                     .organism = *selected,
                     .generation = generation_,
                     .followed = followed_.has_value()};
    } else if (kept_ && !kept_->out_of_sight) { // the user cleared the selection
        kept_.reset();
    } else if (kept_ && kept_->run_id == shown_.run_id && kept_->island == world.feed.island() &&
               kept_->generation == generation_ && world.replay.target() == nullptr) {
        kept_->out_of_sight = false;
        world.feed.select(kept_->organism);
        if (kept_->followed) {
            followed_ = Followed{.id = kept_->organism};
        }
    }
}

// ---- snapshots -------------------------------------------------------------------------------------------------

void IslandView::forget() {
    IslandView fresh;
    fresh.options = options;
    fresh.kept_ = std::move(kept_);
    if (fresh.kept_) {
        fresh.kept_->out_of_sight = true;
    }
    *this = std::move(fresh);
}

void IslandView::take_snapshot(ViewedWorld& world, const std::shared_ptr<const codec::ReceivedSnapshot>& snapshot,
                               const Camera& camera) {
    const auto& about = snapshot->about;
    if (shown_.run_id != about.run_id()) {
        if (!shown_.run_id.empty()) { // the world was reset
            world.feed.select(std::nullopt);
            world.feed.set_view(std::nullopt);
            forget();
            kept_.reset();
        }
        shown_ = {world.feed.place_number(), about.run_id()};
    }
    snapshot_ = snapshot;
    generation_ = about.generation();
    tick_ = about.tick();
    if (selected_organism_) {
        selected_organism_->add_generation(generation_);
        if (selected_organism_->ended() && world.feed.selected() == selected_organism_->id()) {
            world.feed.select(std::nullopt); // the id now belongs to another organism
            if (kept_) {
                kept_->out_of_sight = true;
            }
        }
    }
    trails_.add(snapshot);
    if (options.flashes && shows_traces(camera, *snapshot)) {
        flashes_.add(snapshot);
    } else {
        flashes_.clear();
    }
}

void IslandView::update(ViewedWorld& world, const Camera& camera, Clock::time_point now, bool points_at) {
    if (shown_.number != world.feed.place_number()) {
        forget();
        shown_.number = world.feed.place_number();
    }
    const auto& snapshot = world.feed.view().latest();
    if (!snapshot) {
        return;
    }
    if (snapshot != snapshot_) {
        take_snapshot(world, snapshot, camera);
    }
    if (gene_names_ != world.feed.gene_names()) {
        gene_names_ = world.feed.gene_names();
        gene_groups_ = world.feed.gene_groups();
    }
    keep_selection(world);
    if (const auto selected = world.feed.selected();
        selected && (!selected_organism_ || selected_organism_->id() != *selected || selected_organism_->ended())) {
        selected_organism_.emplace(*selected, generation_);
        organism_poll_.reset();
        organism_tick_ = ~std::uint64_t{0};
    }
    take_population();
    const bool population_wanted = needs_population(points_at);
    if (population_poll_.update(world, population_of(world), population_wanted, now)) {
        population_tick_ = tick_;
    }
    const bool alive = selected_organism_ && !selected_organism_->ended() && !selected_organism_->dead();
    if (organism_poll_.due(world, now) && alive && organism_tick_ != tick_) {
        request_organism(world, now);
    }
    update_stream(world, camera, now);
}

/// The number of genes in the cycle of colourings: those of the body, which come first. Weights of a brain are too
/// many.
std::size_t IslandView::cycled_genes() const {
    const std::size_t body = genes_of(gene_groups_, evod::v1::GENE_GROUP_BODY).count;
    return body > 0 ? std::min(body, gene_names_.size()) : gene_names_.size();
}

void IslandView::next_colouring() {
    switch (options.colour_by) {
    case ColourBy::Nothing:
        options.colour_by = gene_names_.empty() ? ColourBy::Health : ColourBy::Gene;
        options.gene = 0;
        break;
    case ColourBy::Gene:
        if (++options.gene >= cycled_genes()) {
            options.gene = 0;
            options.colour_by = ColourBy::Health;
        }
        break;
    case ColourBy::Health:
        options.colour_by = ColourBy::Nothing;
        break;
    }
}

// ---- following -------------------------------------------------------------------------------------------------

void IslandView::toggle_following(ViewedWorld& world) {
    if (followed_) {
        followed_.reset();
    } else if (world.feed.selected()) {
        followed_ = Followed{.id = *world.feed.selected()};
    }
}

void IslandView::follow(ViewedWorld& world, Camera& camera, double blend) {
    if (!followed_) {
        return;
    }
    const bool moved = followed_->centre && camera.zoom() == followed_->zoom && camera.centre() != *followed_->centre;
    if (world.feed.selected() != followed_->id || moved || (followed_->centre && camera.fitted())) {
        followed_.reset();
        return;
    }
    if (const auto index = world.feed.snapshot()->entities->organisms.index_of(followed_->id)) {
        const auto [x, y] = world.feed.view().organisms_at(blend)[*index];
        camera.look_at({x, y});
    }
    followed_->centre = camera.centre();
    followed_->zoom = camera.zoom();
}

} // namespace evod::viewer
