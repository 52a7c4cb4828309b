#include "client/viewer/scene/sight.h"

#include "client/viewer/watch/readout.h"

#include <algorithm>
#include <utility>

namespace evod::viewer {

namespace {

constexpr std::chrono::milliseconds poll{250};     // of what changes all the time
constexpr std::chrono::seconds after_refusal{2};   // until it is asked again
constexpr std::chrono::seconds given_up_after{15}; // longer than any answer takes
constexpr double dots_radius_pixels = 2;           // smaller than this, nobody's own size is seen

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

bool Sight::Question::due(Clock::time_point now) const {
    return pending ? now - asked > given_up_after : now >= next;
}

void Sight::Question::ask(Clock::time_point now) {
    pending = true;
    asked = now;
}

void Sight::Question::answered(Clock::duration until_next) {
    pending = false;
    next = Clock::now() + until_next;
}

/// `handler` hears the answer, unless another place is looked at by then.
void Sight::ask(Watch& watch, evod::v1::Request request, Question& question, Watch::Answer handler) {
    question.ask(Clock::now());
    watch.ask(std::move(request), [here = std::weak_ptr{here_}, handler = std::move(handler)](const auto& response) {
        if (!here.expired()) {
            handler(response);
        }
    });
}

void Sight::ask_names(Watch& watch) {
    evod::v1::Request request;
    request.mutable_get_statistics()->set_world(watch.world());
    ask(watch, std::move(request), names_, [this](const link::Result<evod::v1::Response>& response) {
        names_.answered(after_refusal);
        if (response && response->statistics().world().run_id() == place_.run_id) {
            const auto& names = response->statistics().world().gene_names();
            gene_names_.assign(names.begin(), names.end());
        }
    });
}

void Sight::ask_page(Watch& watch) {
    evod::v1::Request request;
    request.mutable_get_population()->set_world(watch.world());
    request.mutable_get_population()->set_island(watch.island());
    request.mutable_get_population()->set_first_organism(coming_.next());
    watch.ask(std::move(request),
              [this, &watch, here = std::weak_ptr{here_}](const link::Result<evod::v1::Response>& response) {
                  if (!here.expired()) {
                      take_page(watch, response);
                  }
              });
}

void Sight::take_page(Watch& watch, const link::Result<evod::v1::Response>& response) {
    if (!response || !response->has_population()) {
        refused_ = response && response->status().code() == evod::v1::CODE_UNIMPLEMENTED;
        trouble_ = !response  ? response.error().what
                   : refused_ ? "This server does not tell of genes, lineages and forces; a newer one does"
                              : shown_refusal(response->status());
        return pages_.answered(after_refusal);
    }
    const evod::v1::Population& page = response->population();
    if (coming_.next() > 0 && page.generation() != coming_.generation()) { // it ended in between
        coming_ = Population{gene_names_.size()};
        return ask_page(watch);
    }
    if (const auto wrong = coming_.add(page)) {
        trouble_ = "The server's answer cannot be read: " + *wrong;
        return pages_.answered(after_refusal);
    }
    if (!coming_.whole()) {
        return ask_page(watch);
    }
    trouble_.clear();
    population_ = std::move(coming_);
    family_colours_.see(*population_);
    if (story_) {
        story_->take(*population_);
    }
    // A large one takes its time, of which most is left to pictures.
    pages_.answered(std::max<Clock::duration>(poll, 4 * (Clock::now() - pages_.asked)));
}

void Sight::ask_organism(Watch& watch) {
    organism_tick_ = tick_;
    evod::v1::Request request;
    request.mutable_get_organism()->set_world(watch.world());
    request.mutable_get_organism()->set_island(watch.island());
    request.mutable_get_organism()->set_organism(story_->id());
    ask(watch, std::move(request), organism_, [this](const link::Result<evod::v1::Response>& response) {
        organism_.answered(poll);
        if (response && response->has_organism() && story_) {
            story_->take(response->organism());
        }
    });
}

bool Sight::needs_population() const {
    const bool current_needed =
        shown.colour_by == ColourBy::Gene || shown.colour_by == ColourBy::Lineage || shown.radii || shown.forces ||
        (story_ && (story_->waits_for_children() || (!story_->ended() && story_->ranges().empty())));
    if (!current_needed || refused_ || gene_names_.empty()) {
        return false;
    }
    return !population_ || !current() || (shown.forces && population_tick_ != tick_);
}

// ---- what is seen ----------------------------------------------------------------------------------------------

void Sight::see(Watch& watch, const std::shared_ptr<const wire::Picture>& picture) {
    const auto& about = picture->about;
    if (const Place place{about.run_id(), about.island()}; place != place_) {
        if (!place_.run_id.empty()) {
            watch.select(std::nullopt);
            watch.set_view(std::nullopt);
        }
        Sight fresh;
        fresh.shown = shown;
        *this = std::move(fresh);
        place_ = place;
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
    const auto& picture = watch.view().latest();
    if (!picture) {
        return;
    }
    if (picture != seen_) {
        see(watch, picture);
    }
    if (const auto selected = watch.selected(); selected && (!story_ || story_->id() != *selected || story_->ended())) {
        story_.emplace(*selected, generation_);
        story_->see(*picture);
        organism_ = {};
        organism_tick_ = ~std::uint64_t{0};
    }
    if (story_ && population_) {
        story_->take(*population_);
    }
    if (gene_names_.empty() && names_.due(now)) {
        ask_names(watch);
    }
    if (needs_population() && pages_.due(now)) {
        population_tick_ = tick_;
        pages_.ask(Clock::now());
        coming_ = Population{gene_names_.size()};
        ask_page(watch);
    }
    if (story_ && !story_->ended() && !story_->dead() && organism_tick_ != tick_ && organism_.due(now)) {
        ask_organism(watch);
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
