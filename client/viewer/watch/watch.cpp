#include "client/viewer/watch/watch.h"

#include "client/core/actor.h"
#include "client/viewer/watch/readout.h"

#include <algorithm>
#include <atomic>
#include <utility>

namespace evod::viewer {
namespace {

// A moment of the past may have to be simulated again from far before it.
constexpr std::chrono::minutes journey_max{10};
constexpr std::chrono::seconds ask_how_far{1}; // the past grows while its world lives on

core::Options as_evoview(core::Options options) {
    options.client_name = "evoview";
    options.client_version = EVOD_VERSION;
    return options;
}

std::uint64_t next_place_number() {
    static std::atomic<std::uint64_t> numbers{0};
    return ++numbers;
}

} // namespace

Watch::Watch(Wanted wanted)
    : wanted_{std::move(wanted)}, connection_{as_evoview(wanted_.connection)}, place_number_{next_place_number()} {
    events_ = connection_.subscribe(evod::v1::SubscribeEvents{}); // of all worlds: one that is missing may be made
    subscribe();
    if (wanted_.past_generation) {
        evod::v1::RunMoment at;
        at.set_generation(*wanted_.past_generation);
        open_replay(at);
    }
}

void Watch::subscribe() {
    evod::v1::SubscribeSnapshots subscription;
    subscription.set_world(wanted_.world);
    if (!wanted_.all_islands) {
        subscription.set_island(wanted_.island);
    }
    subscription.set_rate_hz(wanted_.rate_hz);
    if (pictures_view_) {
        *subscription.mutable_view() = *pictures_view_;
    }
    pictures_ = connection_.subscribe(subscription);
}

/// Once a second of everything, as densities, beside a view; and nothing without one.
void Watch::subscribe_overview() {
    if (overview_) {
        connection_.unsubscribe(*std::exchange(overview_, std::nullopt));
        overview_picture_ = nullptr;
    }
    if (pictures_view_) {
        evod::v1::SubscribeSnapshots subscription;
        subscription.set_world(wanted_.world);
        subscription.set_island(wanted_.island);
        subscription.set_rate_hz(1);
        subscription.mutable_view()->set_detail(evod::v1::DETAIL_DENSITY);
        overview_ = connection_.subscribe(subscription);
    }
}

void Watch::look_at(std::string world, std::uint32_t island) {
    if (world != wanted_.world) {
        if (world != present_) {
            forked_.clear();
        }
        control_.forget();
        gene_names_.clear();
        last_generation_.clear();
        unanswered_.clear(); // what they would tell is of the other world
        replay_.reset();
        seeks_.forget();
        past_refusal_.reset();
        if (present_) {
            connection_.unsubscribe(past_events_);
            close_replay(wanted_.world);
            present_.reset();
        }
    }
    wanted_.world = std::move(world);
    wanted_.island = island;
    place_number_ = next_place_number();
    selected_.reset();
    pictures_view_.reset();
    subscribe_overview();
    views_.clear();
    connection_.unsubscribe(pictures_);
    subscribe();
    ask_state();
}

void Watch::set_view(std::optional<evod::v1::View> view) {
    const bool had_one = pictures_view_.has_value();
    pictures_view_ = std::move(view);
    if (had_one && pictures_view_) {
        connection_.set_view(pictures_, *pictures_view_);
    } else if (had_one || pictures_view_) { // a subscription has views for as long as it lives, or none
        connection_.unsubscribe(pictures_);
        subscribe();
        subscribe_overview();
    }
}

void Watch::turn_islands(int by) {
    if (const codec::DecodedSnapshot* shown = picture()) {
        const auto count = std::max<std::int64_t>(shown->about.island_count(), 1);
        const std::int64_t island = (std::int64_t{wanted_.island} + by + count) % count;
        choose_island(static_cast<std::uint32_t>(island));
    } else { // one that the world may not have
        choose_island(0);
    }
}

void Watch::choose_island(std::uint32_t island) {
    if (island == wanted_.island) {
        return;
    }
    if (wanted_.all_islands) {
        wanted_.island = island;
        place_number_ = next_place_number();
        selected_.reset();
    } else {
        look_at(wanted_.world, island);
    }
}

void Watch::show_all_islands(bool all) {
    if (all != wanted_.all_islands) {
        wanted_.all_islands = all;
        look_at(wanted_.world, wanted_.island);
    }
}

// ---- the past --------------------------------------------------------------------------------------------------

void Watch::open_replay(evod::v1::RunMoment at) {
    if (replay_ || opening_.valid()) {
        return;
    }
    past_refusal_.reset();
    evod::v1::Request request;
    request.mutable_open_replay()->set_world(wanted_.world);
    *request.mutable_open_replay()->mutable_at() = std::move(at);
    opening_of_ = wanted_.world;
    opening_ = connection_.send(std::move(request), journey_max);
}

void Watch::take_opened() {
    if (!opening_.valid() || opening_.wait_for(std::chrono::seconds{0}) != std::future_status::ready) {
        return;
    }
    const auto response = opening_.get();
    if (!response || !core::accepted(*response)) {
        notices_.push_back(response ? shown_refusal(response->status()) : response.error().what);
        if (wanted_.past_generation) {
            past_refusal_ = notices_.back();
        }
    } else if (wanted_.world != opening_of_) { // somebody looks elsewhere by now
        close_replay(response->world().name());
    } else {
        const evod::v1::WorldInfo& past = response->world();
        look_at(past.name(), wanted_.island);
        present_ = past.replay().replay_of();
        see(past);
        evod::v1::SubscribeEvents subscription;
        subscription.set_world(past.name());
        past_events_ = connection_.subscribe(subscription);
    }
    wanted_.past_generation.reset();
}

void Watch::close_replay(const std::string& world) {
    evod::v1::Request request;
    request.mutable_close_replay()->set_world(world);
    connection_.send(std::move(request)); // gone with the session at the latest, whatever the answer
}

void Watch::return_to_present() {
    if (present_) {
        look_at(*present_, wanted_.island);
    }
}

void Watch::seek(evod::v1::RunMoment to) {
    if (replay_ && is_allowed()) {
        send_seek(seeks_.ask(std::move(to)));
    }
}

void Watch::send_seek(std::optional<evod::v1::RunMoment> to) {
    if (!to) {
        return;
    }
    evod::v1::Request request;
    request.mutable_seek()->set_world(name());
    *request.mutable_seek()->mutable_to() = *std::move(to);
    auto arrived = [this](const core::Result<evod::v1::Response>& response) {
        if (!response || !core::accepted(*response)) {
            notices_.push_back(response ? shown_refusal(response->status()) : response.error().what);
        } else {
            see(response->world());
        }
        if (auto next = seeks_.answered()) {
            send_seek(std::move(next));
        } else {
            ask_state(); // the generation before is another one
        }
    };
    unanswered_.push_back({false, std::move(arrived), connection_.send(std::move(request), journey_max)});
}

void Watch::turn_generations(int by) {
    const evod::v1::RunMoment* target = seeks_.target();
    if (!replay_ || !(picture() || (target && target->has_generation()))) {
        return;
    }
    const auto from = target && target->has_generation() ? target->generation() : picture()->about.generation();
    const auto to = static_cast<std::int64_t>(from) + by;
    evod::v1::RunMoment moment;
    moment.set_generation(std::clamp(static_cast<std::uint64_t>(std::max<std::int64_t>(to, 1)),
                                     replay_->first_generation(), replay_->last_generation()));
    seek(std::move(moment));
}

void Watch::fork(const std::string& name) {
    if (!may_create()) {
        notices_.push_back("Only the role admin may make worlds");
        return;
    }
    evod::v1::Request request;
    request.mutable_fork_world()->set_world(this->name());
    request.mutable_fork_world()->set_name(name);
    ask(std::move(request), [this, name](const core::Result<evod::v1::Response>& response) {
        if (response && core::accepted(*response)) {
            forked_ = name;
            notices_.push_back("The world " + name + " begins here; B shows it beside");
        } else {
            notices_.push_back(response ? shown_refusal(response->status()) : response.error().what);
        }
    });
}

// ---- requests --------------------------------------------------------------------------------------------------

void Watch::send(std::optional<evod::v1::Request> request) {
    if (request) {
        const bool is_command = !request->has_get_statistics() && !request->has_list_worlds();
        unanswered_.push_back({is_command, {}, connection_.send(*std::move(request))});
    }
}

void Watch::ask(evod::v1::Request request, Answer handler) {
    unanswered_.push_back({false, std::move(handler), connection_.send(std::move(request))});
}

void Watch::next_world() {
    if (connected_count_ == 0) {
        next_world_wanted_ = true; // asked for once the server has answered the hello
        return;
    }
    find_next_world([this](const std::string& world) { look_at(world, 0); });
}

void Watch::find_next_world(std::function<void(const std::string& world)> found) {
    if (connected_count_ == 0) {
        notices_.emplace_back("The worlds are not known yet: there was no connection with the server so far");
        return;
    }
    evod::v1::Request request;
    request.mutable_list_worlds();
    ask(std::move(request), [this, found = std::move(found)](const core::Result<evod::v1::Response>& response) {
        if (!response) {
            notices_.push_back(response.error().what);
        } else if (!core::accepted(*response)) {
            notices_.push_back(shown_refusal(response->status()));
        } else if (const auto world = world_after_this(response->worlds())) {
            found(*world);
        }
    });
}

void Watch::ask_state() {
    evod::v1::Request request;
    request.mutable_get_statistics()->set_world(wanted_.world);
    send(std::move(request));
}

bool Watch::is_over() {
    const bool over = control_.state() == evod::v1::RUN_STATE_TERMINATED || at_the_end();
    if (over) {
        notices_.push_back(replay_ ? "This is the end of the recording; [ goes back by a generation"
                                   : "The run has ended; a reset of the world begins it again");
    }
    return over;
}

bool Watch::is_allowed() {
    if (!may_command()) {
        notices_.emplace_back(why_only_watching());
    }
    return may_command();
}

/// Sends what the wish comes to. The wish is not asked for before: what it says is taken as done.
template <class Wish>
void Watch::command(Wish wish) {
    if (is_allowed()) {
        send(wish());
    }
}

void Watch::pause_or_resume() {
    if (!is_over()) {
        command([this] { return control_.pause_or_resume(); });
    }
}

void Watch::step(std::uint64_t ticks) {
    if (!is_over()) {
        command([&] { return control_.step(ticks); });
    }
}

void Watch::run_generations(std::uint64_t generations) {
    if (!is_over()) {
        command([&] { return control_.run_generations(generations); });
    }
}

void Watch::faster() {
    command([this] { return control_.faster(); });
}

void Watch::slower() {
    command([this] { return control_.slower(); });
}

void Watch::real_time() {
    command([this] { return control_.real_time(); });
}

void Watch::max_speed() {
    command([this] { return control_.max_speed(); });
}

void Watch::at_factor(double factor) {
    command([&] { return control_.at_factor(factor); });
}

void Watch::reset(std::optional<std::uint64_t> seed) {
    command([&] { return control_.reset(seed); });
}

std::string_view Watch::why_only_watching() const {
    return may_command() ? "" : "You are connected as a viewer: read-only";
}

// ---- what comes ------------------------------------------------------------------------------------------------

bool Watch::update(core::WorldView::Clock::time_point now) {
    if (const auto status = connection_.status(); status.connected_count != connected_count_) {
        connected_count_ = status.connected_count;
        role_ = status.welcome ? status.welcome->role() : evod::v1::ROLE_UNSPECIFIED;
        storage_ = status.welcome ? status.welcome->storage() : evod::v1::Storage{};
        if (present_) {
            notices_.push_back("The connection was lost, and the look at the past with it");
            return_to_present();
        } else {
            ask_state();
        }
        if (std::exchange(next_world_wanted_, false)) {
            next_world();
        }
    }
    if (present_ && now - asked_ > ask_how_far) {
        asked_ = now;
        ask_state();
    }
    // Events tell what became of what was answered, and have to be heard after it.
    take_answers();
    take_opened();
    new_events_ = connection_.take_events();
    for (const evod::v1::Event& event : new_events_) {
        take_event(event);
    }
    if (auto overview = overview_ ? connection_.take_snapshot(*overview_, wanted_.island) : nullptr) {
        overview_picture_ = std::move(overview);
    }
    auto pictures = connection_.take_snapshots(pictures_);
    for (auto& picture : pictures) {
        if (control_.known() && picture->about.run_id() != control_.run_id()) {
            ask_state(); // another run has another generation before
            gene_names_.clear();
        }
        control_.see(picture->about);
        views_[picture->about.island()].add(std::move(picture), now);
    }
    return !pictures.empty();
}

void Watch::take_answers() {
    for (std::size_t i = 0; i < unanswered_.size();) {
        if (unanswered_[i].response.wait_for(std::chrono::seconds{0}) != std::future_status::ready) {
            ++i;
            continue;
        }
        Unanswered answered = std::move(unanswered_[i]);
        unanswered_.erase(unanswered_.begin() + static_cast<std::ptrdiff_t>(i));
        const auto response = answered.response.get();
        if (answered.handler) {
            answered.handler(response);
        } else if (answered.is_command) {
            take_command_answer(response);
        } else if (response && response->has_statistics()) {
            take_statistics(response->statistics());
        } // a refused query: what keeps the pictures away is told by refusal()
    }
}

void Watch::take_command_answer(const core::Result<evod::v1::Response>& response) {
    if (!response) {
        notices_.push_back(response.error().what);
    } else if (!core::accepted(*response)) {
        notices_.push_back(shown_refusal(response->status()));
    }
    send(control_.answered(response ? &*response : nullptr));
}

void Watch::see(const evod::v1::WorldInfo& world) {
    control_.see(world);
    gene_names_.assign(world.gene_names().begin(), world.gene_names().end());
    replay_.reset();
    if (world.has_replay()) {
        replay_ = world.replay();
    }
}

void Watch::take_statistics(const evod::v1::Statistics& statistics) {
    see(statistics.world());
    storage_ = statistics.world().storage();
    last_generation_.assign(statistics.last().begin(), statistics.last().end());
}

/// Nullopt, and a notice, if there is none.
std::optional<std::string> Watch::world_after_this(const evod::v1::WorldList& worlds) {
    const auto& list = worlds.worlds();
    if (list.empty()) {
        notices_.push_back("There is no world on this server yet: make one with evoctl create NAME");
        return std::nullopt;
    }
    const std::string shown = present_.value_or(name());
    const auto here = std::ranges::find(list, shown, &evod::v1::WorldInfo::name);
    const auto next = here == list.end() || std::next(here) == list.end() ? list.begin() : std::next(here);
    if (next == here) {
        notices_.push_back("There is only this world: make another with evoctl create NAME");
        return std::nullopt;
    }
    return next->name();
}

void Watch::take_event(const evod::v1::Event& event) {
    using Kind = evod::v1::Event::KindCase;
    if (event.kind_case() == Kind::kServerGoingAway) {
        notices_.push_back("The server is going away");
    } else if (event.kind_case() == Kind::kStorageChanged) {
        const bool was_trouble = !shown_storage(storage_).empty();
        storage_ = event.storage_changed().storage();
        if (was_trouble && shown_storage(storage_).empty()) {
            notices_.push_back("Run files can be written again");
        }
    } else if (event.kind_case() == Kind::kEventsDropped) {
        ask_state();
    } else if (event.kind_case() == Kind::kWorldDeleted && event.world() == forked_) {
        forked_.clear();
    } else if (event.kind_case() == Kind::kWorldCreated && refusal()) {
        look_at(wanted_.world, wanted_.island); // perhaps the one that was missing
    }
    if (!control_.known() || event.world() != control_.world()) {
        return;
    }
    switch (event.kind_case()) {
    case Kind::kGenerationFinished:
        last_generation_.assign(event.generation_finished().statistics().begin(),
                                event.generation_finished().statistics().end());
        break;
    case Kind::kRunControlChanged:
        see(event.run_control_changed().world());
        break;
    case Kind::kWorldReset:
        see(event.world_reset().world());
        last_generation_.clear();
        notices_.push_back("The world was reset by " + core::to_text(event.world_reset().by()));
        break;
    case Kind::kWorldDeleted:
        notices_.push_back("The world " + event.world() + " was deleted by " +
                           core::to_text(event.world_deleted().by()));
        control_.forget();
        look_at(event.world(), 0); // there may be one of this name again
        break;
    case Kind::kParametersChanged: {
        std::string names;
        for (const auto& parameter : event.parameters_changed().changed()) {
            names += (names.empty() ? "" : ", ") + parameter.name();
        }
        notices_.push_back(core::to_text(event.parameters_changed().by()) + " changed " + names);
        break;
    }
    case Kind::kChangePlanned:
    case Kind::kChangeCancelled: {
        const bool planned = event.has_change_planned();
        const auto& change = planned ? event.change_planned().change() : event.change_cancelled().change();
        std::string names;
        for (const auto& assignment : change.parameters()) {
            names += (names.empty() ? "" : ", ") + assignment.name();
        }
        notices_.push_back(core::to_text(planned ? change.by() : event.change_cancelled().by()) +
                           (planned ? " plans to change " : " cancelled the change of ") + names +
                           (change.has_tick() ? " after tick " + std::to_string(change.tick())
                                              : " from generation " + std::to_string(change.generation())));
        break;
    }
    case Kind::kChangeDropped: {
        std::string names;
        for (const auto& name : event.change_dropped().name()) {
            names += (names.empty() ? "" : ", ") + name;
        }
        notices_.push_back("What " + core::to_text(event.change_dropped().by()) + " planned for " + names +
                           " does not go with the other parameters: left out");
        break;
    }
    case Kind::kRunTerminated:
        ask_state(); // for the outcome
        break;
    default:
        break;
    }
}

// ---- what is known ---------------------------------------------------------------------------------------------

const evod::v1::GenerationStatistics* Watch::last_generation() const {
    const auto island = std::ranges::find(last_generation_, wanted_.island, &evod::v1::GenerationStatistics::island);
    return island == last_generation_.end() ? nullptr : &*island;
}

const codec::DecodedSnapshot* Watch::picture_of(std::uint32_t island) const {
    const auto view = views_.find(island);
    return view == views_.end() ? nullptr : view->second.latest().get();
}

std::string Watch::no_connection() const {
    return shown_loss(connection_status(), !wanted_.connection.token.empty());
}

std::string Watch::state_words() const {
    const bool waits = control_.state() == evod::v1::RUN_STATE_WAITING;
    return !connected()                                                  ? "no connection"
           : at_the_end()                                                ? "at the end of the recording"
           : waits && replay_ && control_.tick() >= replay_->last_tick() ? "waits for the present to go on"
                                                                         : shown_state(control_.state(), storage_);
}

bool Watch::at_the_end() const {
    const bool stands =
        control_.state() == evod::v1::RUN_STATE_WAITING || control_.state() == evod::v1::RUN_STATE_PAUSED;
    return replay_ && replay_->replay_of().empty() && stands && control_.tick() >= replay_->last_tick();
}

std::uint32_t Watch::island_count() const {
    for (const auto& [island, view] : views_) {
        if (view.latest()) {
            return std::max(view.latest()->about.island_count(), 1u);
        }
    }
    return 1;
}

std::optional<std::string> Watch::refusal() const {
    if (past_refusal_) {
        return past_refusal_;
    }
    const auto answer = connection_.subscription_answer(pictures_);
    if (!answer || core::accepted(*answer)) {
        return std::nullopt;
    }
    return shown_refusal(answer->status());
}

} // namespace evod::viewer
