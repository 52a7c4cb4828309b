// Replay places: the replays that sessions have open or are opening. Each of them uses the quota of its session's
// account.
//
// Owner        the dispatcher, on the network thread.
// Full         if no place is free, the account with the most replays loses its oldest one to an account that has
//              clearly fewer (base::Quota).
#pragma once

#include "server/base/quota.h"
#include "server/base/result.h"

#include <cstddef>
#include <cstdint>
#include <list>
#include <optional>
#include <string>

namespace evod::network {

class ReplayPlaces {
  public:
    explicit ReplayPlaces(std::size_t replays_max) : quota_{replays_max} {}

    struct Place {
        std::uint64_t session = 0;    // number of the session
        std::uint64_t request_id = 0; // of the request that opens the replay
        std::string account = {};     // of the session
        std::string name = {};        // of the replay; empty: it is being opened
    };
    /// Takes a place for a replay that will be opened. Returns the place that another account has lost for it; nullopt:
    /// none.
    base::Result<std::optional<Place>> take(Place place);
    /// Notes that the replay of a request is open. Returns false if it has lost its place in the meantime.
    bool open(std::uint64_t session, std::uint64_t request_id, const std::string& name);
    /// Gives back the place of a request that was refused. It may have lost it.
    void give_back(std::uint64_t session, std::uint64_t request_id);
    /// Gives back the place of a replay that was closed.
    void close(const std::string& name);
    /// Gives back all places of a session that has ended.
    void forget(std::uint64_t session);

    const base::Quota& quota() const { return quota_; }

  private:
    using Places = std::list<Place>;
    Places::iterator find(std::uint64_t session, std::uint64_t request_id);
    Place give_back(Places::iterator place);

    base::Quota quota_;
    Places places_; // the oldest first
};

} // namespace evod::network
