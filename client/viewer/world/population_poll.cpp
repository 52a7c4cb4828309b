#include "client/viewer/world/population_poll.h"

#include <algorithm>
#include <utility>

namespace evod::viewer {

bool PopulationPoll::update(ViewedWorld& world, const Of& of, bool wanted, Clock::time_point now) {
    if (of != of_) {
        of_ = of;
        poll_.reset();
        complete_.reset();
        unreadable_.clear();
        restart();
    }
    if (!poll_.due(world, now)) {
        return false;
    }
    if (poll_.pending()) { // the request has timed out
        restart();
    }
    const bool first_page = incomplete_.next() == 0;
    if (first_page && !wanted) {
        return false;
    }
    if (first_page) {
        restarted_ = Clock::now();
    }
    evod::v1::Request request;
    request.mutable_get_population()->set_world(of_.world);
    request.mutable_get_population()->set_island(of_.island);
    request.mutable_get_population()->set_first_organism(incomplete_.next());
    poll_.send(world, std::move(request), now, [this](const evod::v1::Response* response) {
        if (response != nullptr) {
            take(response->population());
        } else {
            restart();
        }
    });
    return first_page;
}

void PopulationPoll::take(const evod::v1::Population& page) {
    const bool ended = incomplete_.is_outdated_by(page);
    const auto wrong = ended ? std::nullopt : incomplete_.add(page);
    unreadable_ = wrong ? "The server's answer is invalid: " + *wrong : "";
    if (wrong) {
        restart();
        return poll_.wait(Poll::after_refusal);
    }
    if (!ended && !incomplete_.complete()) {
        return poll_.make_due(); // request the next page at once
    }
    if (!ended) {
        complete_ = std::move(incomplete_);
    }
    restart();
    poll_.wait(std::max<Clock::duration>(interval_, 4 * (Clock::now() - restarted_)));
}

std::string PopulationPoll::problem() const {
    return poll_.is_unsupported()    ? "This server sends no genes and forces; a newer version does"
           : poll_.problem().empty() ? unreadable_
                                     : poll_.problem();
}

} // namespace evod::viewer
