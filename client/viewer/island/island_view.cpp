#include "client/viewer/island/island_view.h"

#include <algorithm>

namespace evod::viewer {

namespace {

constexpr double dots_radius_pixels = 2; // organisms smaller than this are streamed as dots
constexpr double follow_zoom_factor = 2; // of a camera that shows the whole island, when it begins to follow

} // namespace

ViewOptions default_options(Look look) {
    const bool vivid = look.skin == Skin::Vivid;
    return {.look = look, .trails = vivid, .flashes = vivid, .radii = vivid ? Which::Pointed : Which::None};
}

const std::vector<std::string>& IslandView::gene_names() const {
    static const std::vector<std::string> unknown;
    return feed_ != nullptr ? feed_->gene_names() : unknown;
}

void IslandView::add(const Camera& camera, const std::shared_ptr<const codec::ReceivedSnapshot>& snapshot) {
    if (snapshot == added_) {
        return;
    }
    added_ = snapshot;
    trails_.add(snapshot);
    if (options.flashes && shows_traces(camera, *snapshot)) {
        flashes_.add(snapshot);
    } else {
        flashes_.clear();
    }
}

// ---- what is drawn ---------------------------------------------------------------------------------------------

IslandData::Needs IslandView::needs(bool points_at) const {
    const SelectedOrganism* selected = data_ != nullptr ? data_->selected_organism() : nullptr;
    const bool any_pointed = points_at || (selected != nullptr && !selected->ended());
    const auto drawn = [&](Which which) { return which == Which::All || (which == Which::Pointed && any_pointed); };
    return {.genes = options.colour_by == ColourBy::Gene || drawn(options.radii), .forces = drawn(options.forces)};
}

bool IslandView::shows_density(const Camera& camera, const codec::ReceivedSnapshot& snapshot) const {
    const evod::v1::SnapshotFrame& island = snapshot.about;
    const std::size_t streamed = snapshot.entities->organisms.x.size();
    const double count =
        std::max({double(island.organism_count()), double(island.live().organism_count()), double(streamed)});
    return options.density && options.colour_by == ColourBy::Nothing && too_small_to_see(camera) &&
           too_many_for_dots(camera, island, count);
}

evod::v1::Detail IslandView::detail(const Camera& camera, const codec::ReceivedSnapshot& snapshot) const {
    const bool details_of_all = (options.radii == Which::All || options.forces == Which::All) && shows_details(camera);
    const bool selects = feed_ != nullptr && feed_->selected();
    const bool no_single_organism_matters = options.colour_by == ColourBy::Nothing && !details_of_all && !selects;
    const bool small = typical_radius_px * camera.zoom() < dots_radius_pixels;
    return shows_density(camera, snapshot)       ? evod::v1::DETAIL_DENSITY
           : small && no_single_organism_matters ? evod::v1::DETAIL_DOTS
                                                 : evod::v1::DETAIL_FULL;
}

/// The number of genes in the cycle of colourings: those of the body, which come first. Weights of a brain are too
/// many.
std::size_t IslandView::cycled_genes() const {
    const std::size_t body = feed_ != nullptr ? genes_of(feed_->gene_groups(), evod::v1::GENE_GROUP_BODY).count : 0;
    return body > 0 ? std::min(body, gene_names().size()) : gene_names().size();
}

void IslandView::next_colouring() {
    switch (options.colour_by) {
    case ColourBy::Nothing:
        options.colour_by = gene_names().empty() ? ColourBy::Health : ColourBy::Gene;
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

void IslandView::follow(IslandData& data, const core::SnapshotInterpolator& island, Camera& camera, double blend) {
    const SelectedOrganism* selected = data.selected_organism();
    const auto organism = data.followed();
    if (!organism || feed_ == nullptr || !island.latest()) {
        if (followed_ && (selected == nullptr || selected->ended())) { // another island or moment is shown
            camera.fit();
        }
        followed_.reset();
        return;
    }
    if (followed_ && followed_->organism != *organism) {
        followed_.reset();
    }
    const auto index = island.latest()->entities->organisms.index_of(*organism);
    const bool gone = selected == nullptr || selected->ended() || (selected->dead() && !index);
    const bool moved = followed_ && camera.zoom() == followed_->zoom && camera.centre() != followed_->centre;
    const bool fitted = followed_ && camera.fitted();
    if (gone || moved || fitted || feed_->selected() != organism) {
        data.stop_following();
        followed_.reset();
        if (gone) {
            camera.fit();
        }
        return;
    }
    if (camera.fitted()) {
        camera.zoom_at(camera.viewport().centre(), follow_zoom_factor);
    }
    if (index) {
        const auto [x, y] = island.organisms_at(blend)[*index];
        camera.look_at({x, y});
    }
    followed_ = Followed{.organism = *organism, .centre = camera.centre(), .zoom = camera.zoom()};
}

} // namespace evod::viewer
