// PopulationPoll: requests the organisms of an island page by page until the whole population of one generation is here.
//
// If the generation ends between two pages, the poll waits and starts again from the first page. Without the wait a large
// population of a fast world would be requested without pause, at the cost of the snapshots' bandwidth.
//
// Owner        the panel or IslandView that shows the population.
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

    /// Which island's population to request.
    struct Of {
        std::string world, run_id;
        std::uint32_t island = 0;
        std::size_t gene_count = 0;
        friend bool operator==(const Of&, const Of&) = default;
    };

    /// interval  at least, from a complete population until the next is requested.
    explicit PopulationPoll(Clock::duration interval) : interval_{interval} {}

    /// Requests the next page of a population that is incomplete, or the first page of another if `wanted`, once the
    /// interval is over. With another `of` than before everything known is forgotten.
    ///
    /// returns  whether the first page was requested.
    bool update(ViewedWorld& world, const Of& of, bool wanted, Clock::time_point now);

    /// The last complete population; null before the first.
    const Population* complete() const { return complete_ ? &*complete_ : nullptr; }
    /// How many complete populations have arrived.
    std::uint64_t complete_count() const { return complete_count_; }
    /// Why the population is not known, as a sentence; empty if it is known or on its way.
    std::string problem() const;
    /// Whether the server does not support the request.
    bool is_unsupported() const { return poll_.is_unsupported(); }

  private:
    void take(const evod::v1::Population& page);
    void restart() { incomplete_ = Population{of_.gene_count}; }

    Clock::duration interval_;
    Of of_;
    Poll poll_;
    Population incomplete_;
    std::optional<Population> complete_;
    std::uint64_t complete_count_ = 0;
    Clock::time_point restarted_{};
    std::string unreadable_; // what is wrong with the last page
};

} // namespace evod::viewer
