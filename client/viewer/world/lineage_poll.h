// LineagePoll: keeps a Lineage up to date with the server.
//
// It exports the lineage table of the run part by part: at first the newest generations, also those before evoview
// connected; then each generation that begins. Replays of the same run use the same data.
//
// Owner        IslandView.
// Threads      none; used by the thread that draws.
#pragma once

#include "client/viewer/world/lineage.h"
#include "client/viewer/world/poll.h"

#include <chrono>
#include <cstdint>
#include <string>

namespace evod::viewer {

class LineagePoll {
  public:
    using Clock = Poll::Clock;
    static constexpr std::uint64_t generations_max = 1'000; // requested at first

    /// Sends a request when one is due. Clears all data if another run is shown. Call it once per frame.
    ///
    /// wanted  whether a new export may begin. An export that has begun is read to its end. If the server stores no
    ///         runs, nothing is sent again until `wanted` has been false.
    void update(ViewedWorld& world, bool wanted, Clock::time_point now);

    const Lineage& lineage() const { return lineage_; }
    /// Returns why the lineage is unknown, as a sentence; empty if it is known or has been requested.
    const std::string& problem() const { return poll_.problem().empty() ? unreadable_ : poll_.problem(); }

  private:
    static constexpr std::chrono::milliseconds interval{250};

    void begin(ViewedWorld& world, std::uint64_t newest, Clock::time_point now);
    void take(const evod::v1::ExportPart& part);

    Lineage lineage_;
    Poll poll_{interval};
    std::string run_id_;
    std::uint64_t place_ = 0;        // place of the last request (WorldFeed::place_number)
    std::uint64_t export_id_ = 0;    // the export whose next part is wanted; 0: none
    std::uint64_t known_before_ = 0; // the lineage's version when the export began
    Clock::time_point begun_{};
    std::string unreadable_; // what is wrong with the last table; empty: nothing
};

} // namespace evod::viewer
