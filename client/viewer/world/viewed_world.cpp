#include "client/viewer/world/viewed_world.h"

#include "client/core/page_link.h"
#include "client/viewer/world/status_text.h"

#include <algorithm>
#include <iterator>
#include <utility>

namespace evod::viewer {

namespace {

/// Whether the window shows a notice about the event. All other events are visible in the panels.
bool needs_notice(const evod::v1::Event& event) {
    return event.has_server_going_away() || event.has_world_reset() || event.has_world_deleted() ||
           event.has_world_damaged() || event.has_parameters_changed() || event.has_change_planned() ||
           event.has_change_cancelled() || event.has_change_dropped() || event.has_placed() || event.has_removed();
}

} // namespace

ViewedWorld::ViewedWorld(const WantedWorld& wanted)
    : server{wanted.connection}, feed{server, wanted}, replay{server, feed, wanted}, commands{server, feed, replay} {}

bool ViewedWorld::update(WorldFeed::Clock::time_point now) {
    if (const auto welcome = server.take_welcome()) {
        feed.take_storage(welcome->storage());
        if (replay.is_own()) {
            server.notice("The connection was lost, and the replay was closed with it");
            replay.return_to_present();
        } else {
            feed.request_statistics();
        }
        if (std::exchange(next_world_wanted_, false)) {
            show_next_world();
        }
    }
    // Process answers before events, because an event may report something that happened after an answer.
    server.take_answers();
    replay.update(now);
    if (std::string fork = replay.take_new_fork(); !fork.empty()) {
        show(std::move(fork), feed.island());
    }
    feed.take_events();
    for (const evod::v1::Event& event : feed.events()) {
        take_event(event);
    }
    return feed.take_snapshots(now);
}

void ViewedWorld::take_event(const evod::v1::Event& event) {
    feed.apply(event);
    if (event.has_world_created() && refusal()) {
        show(feed.world(), feed.island()); // the new world may be the one that was missing
    }
    const bool of_this_world = feed.control().known() && event.world() == feed.control().world();
    if (!of_this_world && !event.has_server_going_away()) {
        return;
    }
    if (needs_notice(event)) {
        server.notice(capitalised(core::to_text(event)));
    }
    if ((event.has_world_deleted() || event.has_world_damaged()) && of_this_world) {
        feed.control().forget();
        show(event.world(),
             0); // a world with this name may be created again; for a damaged one the server sends the reason
    }
}

void ViewedWorld::show(std::string world, std::uint32_t island) {
    if (world != feed.world()) {
        replay.leave();
    }
    feed.show(std::move(world), island);
}

void ViewedWorld::show_next_world() {
    if (!server.was_connected()) {
        next_world_wanted_ = true; // the request is sent as soon as the server has answered the Hello
        return;
    }
    evod::v1::Request request;
    request.mutable_list_worlds();
    server.send(std::move(request), [this](const core::Result<evod::v1::Response>& response) {
        if (!server.report_if_refused(response)) {
            return;
        }
        if (const auto next = world_after_this(response->worlds())) {
            show(*next, 0);
        } else {
            server.notice("There is no other world; the browser page creates one");
        }
    });
}

/// The world after the viewed one in the server's list; nullopt if there is no other world.
std::optional<std::string> ViewedWorld::world_after_this(const evod::v1::WorldList& worlds) const {
    std::vector<std::string> names;
    for (const evod::v1::WorldInfo& world : worlds.worlds()) {
        names.push_back(world.name());
    }
    for (const evod::v1::DamagedWorld& world : worlds.damaged()) {
        names.push_back(world.name());
    }
    const auto here = std::ranges::find(names, replay.present().value_or(feed.name()));
    const auto next = here == names.end() || std::next(here) == names.end() ? names.begin() : std::next(here);
    return next == here || next == names.end() ? std::nullopt : std::optional{*next};
}

std::string ViewedWorld::page() const {
    return core::page_of(server.status().welcome.value_or(evod::v1::Welcome{}), server.endpoint(), server.uses_tls());
}

std::string ViewedWorld::live_link() const {
    const std::string original = replay.info() ? replay.info()->replay_of() : "";
    const std::string& name = original.empty() ? feed.name() : original;
    if (page().empty() || name.empty() || !core::fits_into_url(name)) {
        return page();
    }
    return core::link_of(page(), {.world = name});
}

std::string ViewedWorld::link() const {
    const codec::ReceivedSnapshot* snapshot = feed.snapshot();
    if (!snapshot || page().empty()) {
        return "";
    }
    const std::string original = replay.info() ? replay.info()->replay_of() : "";
    if (!core::fits_into_url(original) || !core::fits_into_url(snapshot->about.world())) {
        return "";
    }
    core::PageMoment moment{.world = original.empty() ? snapshot->about.world() : original,
                            .generation = snapshot->about.generation(),
                            .tick = snapshot->about.generation_tick(),
                            .organism = feed.selected()};
    if (feed.island_count() > 1) {
        moment.island = snapshot->about.island();
    }
    return core::link_of(page(), moment);
}

std::optional<std::string> ViewedWorld::refusal() const {
    return replay.open_refusal() ? replay.open_refusal() : feed.refusal();
}

std::string ViewedWorld::state_text() const {
    if (!server.connected()) {
        return "no connection";
    }
    if (replay.at_end()) {
        return "at the end of the replay";
    }
    const RunControl& control = feed.control();
    const bool waiting = control.state() == evod::v1::RUN_STATE_WAITING;
    if (waiting && replay.info() != nullptr && control.tick() >= replay.info()->last_tick()) {
        return "waiting for the live world";
    }
    return viewer::state_text(control.state(), feed.storage(), control.awaited_fitness() != nullptr);
}

void ViewedWorld::toggle_replay() {
    if (replay.is_own()) {
        return replay.return_to_present();
    }
    if (replay.info() != nullptr) {
        return server.notice("This world replays a run file: there is no live world");
    }
    evod::v1::RunMoment now;
    if (const codec::ReceivedSnapshot* snapshot = feed.snapshot()) {
        now.set_tick(snapshot->about.tick());
    }
    replay.open(std::move(now));
}

void ViewedWorld::show_generation(std::uint64_t generation) {
    evod::v1::RunMoment first;
    first.set_generation(generation);
    if (replay.info() != nullptr) {
        replay.seek(std::move(first));
    } else {
        replay.open(std::move(first));
    }
}

} // namespace evod::viewer
