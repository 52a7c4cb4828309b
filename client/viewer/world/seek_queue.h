// SeekQueue: decides when each seek of a replay is sent. Only one seek runs at a time; of the waiting seeks, only
// the newest is kept.
//
// Owner        ReplayControl.
// Threads      none; used by the thread that draws.
#pragma once

#include "evod/v1/commands.pb.h"

#include <optional>

namespace evod::viewer {

class SeekQueue {
  public:
    /// Adds a seek. Returns the seek to send now; nullopt while another is running. A newer seek replaces a waiting
    /// seek.
    std::optional<evod::v1::RunMoment> add(evod::v1::RunMoment to);
    /// Ends the running seek. Call when its answer has arrived or will never arrive. Returns the seek to send next.
    std::optional<evod::v1::RunMoment> answered();
    void clear() { *this = SeekQueue{}; }

    /// Returns the target of the newest seek; null if no seek is running.
    const evod::v1::RunMoment* target() const;

  private:
    std::optional<evod::v1::RunMoment> under_way_, next_;
};

} // namespace evod::viewer
