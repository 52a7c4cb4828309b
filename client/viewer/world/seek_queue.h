// SeekQueue: which seek of a replay is sent when: one at a time, and of the waiting ones only the newest.
//
// Owner        ReplayControl.
// Threads      none; used by the thread that draws.
#pragma once

#include "evod/v1/commands.pb.h"

#include <optional>

namespace evod::viewer {

class SeekQueue {
  public:
    /// Returns the seek to send now; nullopt while another is under way. A waiting seek is replaced by a newer one.
    std::optional<evod::v1::RunMoment> add(evod::v1::RunMoment to);
    /// The seek under way was answered, or never will be. Returns the seek to send next.
    std::optional<evod::v1::RunMoment> answered();
    void clear() { *this = SeekQueue{}; }

    /// Where the newest seek goes to; null if none is under way.
    const evod::v1::RunMoment* target() const;

  private:
    std::optional<evod::v1::RunMoment> under_way_, next_;
};

} // namespace evod::viewer
