#include "client/viewer/scene/sight.h"

#include <algorithm>
#include <utility>

namespace evod::viewer {

namespace {

constexpr double dots_radius_pixels = 2; // smaller than this, nobody's own size is seen

} // namespace

// ---- the region ------------------------------------------------------------------------------------------------

std::optional<evod::v1::View> StreamedRegion::update(const Camera& camera, evod::v1::Detail detail,
                                                     Clock::time_point now) {
    const Rectangle seen = camera.visible();
    const bool covered = streamed_ && streamed_->contains({seen.left, seen.top}) &&
                         streamed_->contains({seen.left + seen.width, seen.top + seen.height});
    const bool far_too_much = streamed_ && streamed_->width > 6 * seen.width;
    if ((covered && !far_too_much && detail == detail_) || (streamed_ && now - asked_ < between)) {
        return std::nullopt;
    }
    streamed_ = {seen.left - seen.width / 2, seen.top - seen.height / 2, 2 * seen.width, 2 * seen.height};
    detail_ = detail;
    asked_ = now;
    evod::v1::View view;
    view.mutable_region()->set_left_px(streamed_->left);
    view.mutable_region()->set_top_px(streamed_->top);
    view.mutable_region()->set_width_px(streamed_->width);
    view.mutable_region()->set_height_px(streamed_->height);
    view.set_detail(detail);
    return view;
}

void Sight::stream(Watch& watch, const Camera& camera, Clock::time_point now) {
    if (watch.all_islands()) { // a view would be of all of them
        region_.forget();
        return;
    }
    const auto& about = seen_->about;
    in_part_ = in_part_ || std::max(about.organism_count(), about.live().organism_count()) >= streamed_in_part_min;
    if (!in_part_) {
        return;
    }
    const bool nobody_is_meant =
        shown.colour_by == ColourBy::Nothing && !shown.radii && !shown.forces && !shown.trails && !watch.selected();
    const bool small = ordinary_radius_px * camera.zoom() < dots_radius_pixels;
    const auto detail = shows_density(camera)      ? evod::v1::DETAIL_DENSITY
                        : small && nobody_is_meant ? evod::v1::DETAIL_DOTS
                                                   : evod::v1::DETAIL_FULL;
    if (auto view = region_.update(camera, detail, now)) {
        watch.set_view(std::move(view));
    }
}

// ---- questions -------------------------------------------------------------------------------------------------

PopulationInquiry::Of Sight::population_of(const Watch& watch) const {
    return {watch.world(), place_.run_id, watch.island(), gene_names_.size()};
}

bool Sight::needs_population() const {
    const bool current_needed =
        shown.colour_by == ColourBy::Gene || shown.colour_by == ColourBy::Lineage || shown.radii || shown.forces ||
        (story_ && (story_->waits_for_children() || (!story_->ended() && story_->ranges().empty())));
    if (!current_needed || population_.is_unknown() || gene_names_.empty()) {
        return false;
    }
    return population() == nullptr || (shown.forces && population_tick_ != tick_);
}

void Sight::take_population() {
    const Population* whole = population_.whole();
    if (whole == nullptr) {
        return;
    }
    if (taken_count_ != population_.whole_count()) {
        taken_count_ = population_.whole_count();
        family_colours_.see(*whole);
    }
    if (story_) {
        story_->take(*whole);
    }
}

void Sight::ask_organism(Watch& watch, Clock::time_point now) {
    organism_tick_ = tick_;
    evod::v1::Request request;
    request.mutable_get_organism()->set_world(watch.world());
    request.mutable_get_organism()->set_island(watch.island());
    request.mutable_get_organism()->set_organism(story_->id());
    organism_.ask(watch, std::move(request), now, [this](const evod::v1::Response* response) {
        if (response != nullptr && story_) {
            story_->take(response->organism());
        }
    });
}

// ---- what is seen ----------------------------------------------------------------------------------------------

void Sight::forget() {
    Sight fresh;
    fresh.shown = shown;
    *this = std::move(fresh);
}

void Sight::see(Watch& watch, const std::shared_ptr<const codec::DecodedSnapshot>& picture) {
    const auto& about = picture->about;
    if (place_.run_id != about.run_id()) {
        if (!place_.run_id.empty()) { // it was reset
            watch.select(std::nullopt);
            watch.set_view(std::nullopt);
            forget();
        }
        place_ = {watch.place_number(), about.run_id()};
    }
    seen_ = picture;
    generation_ = about.generation();
    tick_ = about.tick();
    if (story_) {
        story_->see(*picture);
        if (story_->ended() && watch.selected() == story_->id()) {
            watch.select(std::nullopt); // that id is another organism now
        }
    }
    trails_.see(picture);
}

void Sight::update(Watch& watch, const Camera& camera, Clock::time_point now) {
    if (place_.number != watch.place_number()) {
        forget();
        place_.number = watch.place_number();
    }
    const auto& picture = watch.view().latest();
    if (!picture) {
        return;
    }
    if (picture != seen_) {
        see(watch, picture);
    }
    if (gene_names_ != watch.gene_names()) {
        gene_names_ = watch.gene_names();
    }
    if (const auto selected = watch.selected(); selected && (!story_ || story_->id() != *selected || story_->ended())) {
        story_.emplace(*selected, generation_);
        story_->see(*picture);
        organism_.forget();
        organism_tick_ = ~std::uint64_t{0};
    }
    take_population();
    if (population_.update(watch, population_of(watch), needs_population(), now)) {
        population_tick_ = tick_;
    }
    const bool alive = story_ && !story_->ended() && !story_->dead();
    if (organism_.due(watch, now) && alive && organism_tick_ != tick_) {
        ask_organism(watch, now);
    }
    stream(watch, camera, now);
}

void Sight::next_colouring() {
    switch (shown.colour_by) {
    case ColourBy::Nothing:
        shown.colour_by = gene_names_.empty() ? ColourBy::Health : ColourBy::Gene;
        shown.gene = 0;
        break;
    case ColourBy::Gene:
        if (++shown.gene >= gene_names_.size()) {
            shown.gene = 0;
            shown.colour_by = ColourBy::Health;
        }
        break;
    case ColourBy::Health:
        shown.colour_by = ColourBy::Lineage;
        break;
    case ColourBy::Lineage:
        shown.colour_by = ColourBy::Nothing;
        break;
    }
}

// ---- following -------------------------------------------------------------------------------------------------

void Sight::toggle_following(Watch& watch) {
    if (followed_) {
        followed_.reset();
    } else if (watch.selected()) {
        followed_ = Followed{.id = *watch.selected()};
    }
}

void Sight::follow(Watch& watch, Camera& camera, double blend) {
    if (!followed_) {
        return;
    }
    const bool moved = followed_->centre && camera.zoom() == followed_->zoom && camera.centre() != *followed_->centre;
    if (watch.selected() != followed_->id || moved || (followed_->centre && camera.fitted())) {
        followed_.reset();
        return;
    }
    const auto& ids = watch.picture()->organisms.id;
    const auto place = std::ranges::lower_bound(ids, followed_->id);
    if (place != ids.end() && *place == followed_->id) {
        const auto index = static_cast<std::size_t>(place - ids.begin());
        const auto& at = watch.view().organisms_at(blend);
        camera.look_at({at.x_px[index], at.y_px[index]});
    }
    followed_->centre = camera.centre();
    followed_->zoom = camera.zoom();
}

} // namespace evod::viewer
