#include "server/network/replay_places.h"

#include <algorithm>
#include <utility>

namespace evod::network {

base::Result<std::optional<ReplayPlaces::Place>> ReplayPlaces::take(Place place) {
    const auto refuse = [](std::string message, std::size_t held, std::size_t allowed) {
        return base::limit_refusal(std::move(message), base::Reason::ReplaysMax, "replays_max", held, allowed);
    };
    std::optional<Place> lost;
    switch (quota_.ask(place.account)) {
    case base::Quota::Verdict::Free:
        break;
    case base::Quota::Verdict::UserFull:
        return refuse("this user, or this address without a token, has " + std::to_string(quota_.share()) +
                          " replays open already: close one first",
                      quota_.held(place.account), quota_.share());
    case base::Quota::Verdict::PoolFull:
        return refuse("all clients together have " + std::to_string(quota_.total()) +
                          " replays open already: try again when one of them is closed",
                      quota_.held(), quota_.total());
    case base::Quota::Verdict::FromLargest:
        lost = give_back(std::ranges::find(places_, quota_.largest(), &Place::account));
        break;
    }
    quota_.take(place.account);
    places_.push_back(std::move(place));
    return lost;
}

bool ReplayPlaces::open(std::uint64_t session, std::uint64_t request_id, const std::string& name) {
    const auto place = find(session, request_id);
    if (place == places_.end()) {
        return false;
    }
    place->name = name;
    return true;
}

void ReplayPlaces::give_back(std::uint64_t session, std::uint64_t request_id) {
    if (const auto place = find(session, request_id); place != places_.end()) {
        give_back(place);
    }
}

void ReplayPlaces::close(const std::string& name) {
    if (const auto place = std::ranges::find(places_, name, &Place::name); place != places_.end()) {
        give_back(place);
    }
}

void ReplayPlaces::forget(std::uint64_t session) {
    for (auto place = places_.begin(); place != places_.end();) {
        const auto next = std::next(place);
        if (place->session == session) {
            give_back(place);
        }
        place = next;
    }
}

ReplayPlaces::Places::iterator ReplayPlaces::find(std::uint64_t session, std::uint64_t request_id) {
    return std::ranges::find_if(places_, [&](const Place& place) {
        return place.session == session && place.request_id == request_id && place.name.empty();
    });
}

ReplayPlaces::Place ReplayPlaces::give_back(Places::iterator place) {
    quota_.give_back(place->account);
    Place given = std::move(*place);
    places_.erase(place);
    return given;
}

} // namespace evod::network
