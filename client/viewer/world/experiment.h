// Experiment: the sentences of the server about what the organisms of the viewed world try to do.
//
// Owner        the summary in the sidebar.
// Threads      none; used by the thread that draws.
#pragma once

#include "client/viewer/world/poll.h"

#include <chrono>
#include <cstdint>
#include <string>

namespace evod::viewer {

class Experiment {
  public:
    /// Requests the parameters when another run is viewed or they have changed. Call it once per frame.
    void update(ViewedWorld& world, Poll::Clock::time_point now);

    /// Returns the sentences; empty until the parameters have arrived.
    const std::string& text() const { return text_; }
    /// Whether the organisms live on an island. Otherwise only their genes matter, and islands are empty.
    bool has_bodies() const { return has_bodies_; }

  private:
    static constexpr std::chrono::seconds poll_interval{1}; // a fast world finishes many generations per second

    Poll poll_{poll_interval};
    std::string world_, run_id_;
    std::uint64_t connected_count_ = 0;
    bool stale_ = true;
    std::string text_;
    bool has_bodies_ = true;
};

} // namespace evod::viewer
