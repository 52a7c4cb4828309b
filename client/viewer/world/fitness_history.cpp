#include "client/viewer/world/fitness_history.h"

#include <algorithm>

namespace evod::viewer {

void FitnessHistory::follow(const ViewedWorld& world) {
    const RunControl& control = world.feed.control();
    const bool of_live_world = world.replay.info() != nullptr && !world.replay.info()->replay_of().empty();
    const std::string& name = of_live_world ? world.replay.info()->replay_of() : control.world();
    if (name != world_ || control.run_id() != run_id_) {
        *this = FitnessHistory{};
        world_ = name;
        run_id_ = control.run_id();
    }
    const std::uint64_t connected_count = world.server.status().connected_count;
    if (world.feed.place_number() != place_ || connected_count != connected_count_) { // a pending answer is dropped
        place_ = world.feed.place_number();
        connected_count_ = connected_count;
        next_page_.reset();
        stale_ = true;
    }
    for (const evod::v1::Event& event : world.feed.events()) {
        if (event.has_events_dropped()) {
            stale_ = true;
        } else if (event.has_generation_finished() && event.world() == world_ && event.run_id() == run_id_) {
            add(event.generation_finished().statistics());
            if (!stale_ && last() == complete_until_ + 1) {
                complete_until_ = last();
            }
            ended_ = std::max(ended_, last());
        }
    }
    const codec::ReceivedSnapshot* snapshot = world.feed.snapshot();
    if (snapshot != nullptr && snapshot->about.run_id() == run_id_ && snapshot->about.generation() > 0) {
        ended_ = std::max(ended_, snapshot->about.generation() - 1);
    }
    stale_ = stale_ || (ended_ > complete_until_ && !next_page_ && !poll_.pending());
}

void FitnessHistory::update(ViewedWorld& world, Poll::Clock::time_point now) {
    if (!world.feed.control().known()) {
        return;
    }
    follow(world);
    // If a request is due while one is pending, the answer to it has timed out.
    if (!poll_.due(world, now) || (!stale_ && !next_page_ && !poll_.pending())) {
        return;
    }
    if (!next_page_) {
        next_page_ = complete_until_ + 1;
        ended_when_requested_ = std::max(ended_, last());
        stale_ = false;
    }
    evod::v1::Request request;
    request.mutable_get_history()->set_world(world_);
    request.mutable_get_history()->set_first_generation(*next_page_);
    poll_.send(world, std::move(request), now, [this](const evod::v1::Response* response) {
        if (response != nullptr) {
            take(response->history());
        } else {
            next_page_.reset();
            stale_ = true;
        }
    });
}

void FitnessHistory::take(const evod::v1::History& page) {
    add(page.generations());
    if (page.has_next_generation() && page.next_generation() > next_page_.value_or(0)) {
        next_page_ = page.next_generation();
        return;
    }
    next_page_.reset();
    // The server no longer keeps a generation that had ended and is missing from the answers.
    const std::uint64_t last_received = page.generations().empty() ? 0 : page.generations().rbegin()->generation();
    complete_until_ = std::max({complete_until_, ended_when_requested_, last_received});
}

/// Adds the statistics of generations. The islands of a generation are consecutive.
template <class Statistics>
void FitnessHistory::add(const Statistics& statistics) {
    for (auto island = statistics.begin(); island != statistics.end();) {
        Generation added{.number = island->generation(), .best = island->fitness_best()};
        double sum = 0, count = 0;
        for (; island != statistics.end() && island->generation() == added.number; ++island) {
            added.best = std::max(added.best, island->fitness_best());
            sum += island->fitness_mean() * island->organism_count();
            count += island->organism_count();
        }
        added.mean = count > 0 ? sum / count : 0;
        const auto place = std::ranges::lower_bound(generations_, added.number, {}, &Generation::number);
        if (place != generations_.end() && place->number == added.number) {
            *place = added;
        } else {
            generations_.insert(place, added);
        }
    }
}

} // namespace evod::viewer
