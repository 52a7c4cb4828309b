// FitnessHistory: the best and the mean fitness of all finished generations of the viewed run, of all islands together.
//
// Earlier generations are requested page by page. Events add each generation that ends. If generations may have been
// missed (dropped events, a broken connection), they are requested again. A replay of a live world shows the
// generations of the live world.
//
// Owner        the summary in the sidebar.
// Threads      none; used by the thread that draws.
#pragma once

#include "client/viewer/world/poll.h"

#include <chrono>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace evod::viewer {

class FitnessHistory {
  public:
    struct Generation {
        std::uint64_t number = 0;
        double best = 0; // the greatest of all islands
        double mean = 0; // of all organisms
    };

    /// Requests what is missing, and reads the events of the last update. Call it once per frame.
    void update(ViewedWorld& world, Poll::Clock::time_point now);

    /// Returns the generations, in increasing order. The server may no longer keep some of them.
    const std::vector<Generation>& generations() const { return generations_; }
    /// Returns whether every generation that is known to have ended was received or is no longer kept.
    bool complete() const { return !run_id_.empty() && !stale_ && !next_page_; }

  private:
    // Interval between requests, because a world may finish more generations per second than a user can see.
    static constexpr std::chrono::milliseconds poll_interval{100};

    void follow(const ViewedWorld& world);
    void take(const evod::v1::History& page);
    template <class Statistics>
    void add(const Statistics& statistics);
    std::uint64_t last() const { return generations_.empty() ? 0 : generations_.back().number; }

    std::string world_, run_id_;
    std::uint64_t place_ = 0, connected_count_ = 0;
    std::vector<Generation> generations_;
    Poll poll_{poll_interval};
    bool stale_ = true;                      // generations may be missing
    std::uint64_t complete_until_ = 0;       // up to this generation, none is missing
    std::uint64_t ended_ = 0;                // the last generation that is known to have ended
    std::uint64_t ended_when_requested_ = 0; // value of ended_ when the first page was requested
    std::optional<std::uint64_t> next_page_; // the generation at which the next page begins
};

} // namespace evod::viewer
