#include "client/viewer/world/replay_control.h"

#include "client/viewer/world/world_names.h"

#include <algorithm>
#include <chrono>
#include <utility>
#include <vector>

namespace evod::viewer {

namespace {

// A seek may take long, because the server may have to simulate from a checkpoint far before the requested tick.
constexpr std::chrono::minutes seek_timeout{10};
// Interval between requests for the tick range of a replay, which grows while the live world runs.
constexpr std::chrono::seconds range_interval{1};

} // namespace

ReplayControl::ReplayControl(ServerConnection& server, WorldFeed& feed, const WantedWorld& wanted)
    : server_{server}, feed_{feed}, opening_at_start_{wanted.replay_generation.has_value()} {
    if (wanted.replay_generation) {
        evod::v1::RunMoment at;
        at.set_generation(*wanted.replay_generation);
        open(at);
    }
}

// ---- opening and closing ---------------------------------------------------------------------------------------

void ReplayControl::open(evod::v1::RunMoment at) {
    if (info() != nullptr || opening()) {
        return;
    }
    open_refusal_.reset();
    evod::v1::Request request;
    request.mutable_open_replay()->set_world(feed_.world());
    *request.mutable_open_replay()->mutable_at() = std::move(at);
    opening_of_ = feed_.world();
    opening_ = server_.connection().send(std::move(request), seek_timeout);
}

void ReplayControl::take_opened() {
    if (!opening() || opening_.wait_for(std::chrono::seconds{0}) != std::future_status::ready) {
        return;
    }
    const auto response = opening_.get();
    const bool at_start = std::exchange(opening_at_start_, false);
    if (!server_.report_if_refused(response)) {
        if (at_start) {
            open_refusal_ = refusal_of(response);
        }
    } else if (!opening_of_.empty() && feed_.world() != opening_of_) { // another world is now shown
        close(response->world().name());
    } else {
        const evod::v1::WorldInfo& world = response->world();
        show(world.name());
        present_ = world.replay().replay_of();
        feed_.take_info(world);
        evod::v1::SubscribeEvents subscription;
        subscription.set_world(world.name());
        own_events_ = server_.connection().subscribe(subscription);
    }
}

void ReplayControl::close(const std::string& world) {
    evod::v1::Request request;
    request.mutable_close_replay()->set_world(world);
    // The answer is not needed: the server closes the replay at the end of the session anyway.
    server_.connection().send(std::move(request));
}

void ReplayControl::leave() {
    seeks_.clear();
    open_refusal_.reset();
    if (present_) {
        server_.connection().unsubscribe(own_events_);
        close(feed_.world());
        present_.reset();
    }
}

void ReplayControl::show(std::string world) {
    leave();
    feed_.show(std::move(world), feed_.island());
}

void ReplayControl::return_to_present() {
    if (present_) {
        show(std::string{*present_});
    }
}

void ReplayControl::update(WorldFeed::Clock::time_point now) {
    take_opened();
    if (present_ && now - range_requested_ > range_interval) {
        range_requested_ = now;
        feed_.request_statistics();
    }
}

bool ReplayControl::at_end() const {
    const RunControl& control = feed_.control();
    const bool stopped =
        control.state() == evod::v1::RUN_STATE_WAITING || control.state() == evod::v1::RUN_STATE_PAUSED;
    return info() != nullptr && info()->replay_of().empty() && stopped && control.tick() >= info()->last_tick();
}

// ---- seeking ---------------------------------------------------------------------------------------------------

void ReplayControl::seek(evod::v1::RunMoment to) {
    if (info() == nullptr) {
        return;
    }
    if (server_.read_only() && !is_own()) {
        server_.notice(std::string{read_only_text});
    } else {
        send_seek(seeks_.add(std::move(to)));
    }
}

void ReplayControl::send_seek(std::optional<evod::v1::RunMoment> to) {
    if (!to) {
        return;
    }
    evod::v1::Request request;
    request.mutable_seek()->set_world(feed_.name());
    *request.mutable_seek()->mutable_to() = *std::move(to);
    const auto take_answer = [this](const core::Result<evod::v1::Response>& response) {
        if (server_.report_if_refused(response)) {
            feed_.take_info(response->world());
        }
        if (auto next = seeks_.answered()) {
            send_seek(std::move(next));
        } else {
            feed_.request_statistics(); // the last generation before the shown tick has changed
        }
    };
    server_.send(std::move(request), take_answer, seek_timeout);
}

void ReplayControl::seek_generations(int by) {
    const bool sought_generation = target() != nullptr && target()->has_generation();
    if (info() == nullptr || (feed_.snapshot() == nullptr && !sought_generation)) {
        return;
    }
    const std::uint64_t from = sought_generation ? target()->generation() : feed_.snapshot()->about.generation();
    const std::int64_t to = std::max<std::int64_t>(static_cast<std::int64_t>(from) + by, 1);
    evod::v1::RunMoment moment;
    moment.set_generation(
        std::clamp(static_cast<std::uint64_t>(to), info()->first_generation(), info()->last_generation()));
    seek(std::move(moment));
}

// ---- forking ---------------------------------------------------------------------------------------------------

void ReplayControl::fork() {
    if (!server_.may_create()) {
        server_.notice(std::string{no_creation_text});
        return;
    }
    evod::v1::Request request;
    request.mutable_list_worlds(); // for a name that no world has
    server_.send(std::move(request), [this](const core::Result<evod::v1::Response>& response) {
        if (server_.report_if_refused(response)) {
            std::vector<std::string> used;
            for (const evod::v1::WorldInfo& world : response->worlds().worlds()) {
                used.push_back(world.name());
            }
            for (const evod::v1::DamagedWorld& world : response->worlds().damaged()) {
                used.push_back(world.name());
            }
            send_fork(unused_name(present_.value_or(feed_.name()), used));
        }
    });
}

void ReplayControl::send_fork(const std::string& name) {
    evod::v1::Request request;
    request.mutable_fork_world()->set_world(feed_.name());
    request.mutable_fork_world()->set_name(name);
    server_.send(std::move(request), [this, name](const core::Result<evod::v1::Response>& response) {
        if (server_.report_if_refused(response)) {
            new_fork_ = name;
            server_.notice("Forked the world " + name + " from this moment");
        }
    });
}

} // namespace evod::viewer
