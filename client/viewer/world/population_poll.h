// PopulationPoll: requests the organisms of an island page by page until the whole population of one generation has
// been received.
//
// If the generation ends or an organism is placed between two pages, the poll waits and then starts again with the
// first page. Without this wait, a large population of a fast world would be requested continuously and use the
// bandwidth of the snapshots.
//
// Owner        IslandData.
// Threads      none; used by the thread that draws.
#pragma once

#include "client/viewer/world/poll.h"
#include "client/viewer/world/population.h"

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>

namespace evod::viewer {

class PopulationPoll {
  public:
    using Clock = Poll::Clock;

    /// Identifies the island whose population is requested.
    struct Of {
        std::string world, run_id;
        std::uint32_t island = 0;
        std::size_t gene_count = 0;
        friend bool operator==(const Of&, const Of&) = default;
    };

    /// interval  least time from a complete population until the next one is requested.
    explicit PopulationPoll(Clock::duration interval) : interval_{interval} {}

    /// Sends a request when one is due: for the next page of an incomplete population or, if `wanted`, for the first
    /// page of another population. If `of` has changed, clears all data first.
    ///
    /// returns  whether the first page was requested.
    bool update(ViewedWorld& world, const Of& of, bool wanted, Clock::time_point now);

    /// Returns the last complete population; null until one has been received.
    const Population* complete() const { return complete_ ? &*complete_ : nullptr; }
    /// Returns why the population is unknown, as a sentence. Empty if it is known or has been requested.
    std::string problem() const;
    /// Returns whether the server does not support GetPopulation.
    bool is_unsupported() const { return poll_.is_unsupported(); }

  private:
    void take(const evod::v1::Population& page);
    void restart() { incomplete_ = Population{of_.gene_count}; }

    Clock::duration interval_;
    Of of_;
    Poll poll_;
    Population incomplete_;
    std::optional<Population> complete_;
    Clock::time_point restarted_{};
    std::string unreadable_; // what is wrong with the last page; empty: nothing
};

} // namespace evod::viewer
