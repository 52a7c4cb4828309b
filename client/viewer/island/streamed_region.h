// StreamedRegion: chooses the region and the level of detail in which a large island is streamed.
//
// The region is twice as wide and high as the visible part, so that a small pan stays inside it. It changes at most
// once per `interval`.
//
// Owner        WorldView.
// Threads      none; used by the thread that draws.
#pragma once

#include "client/core/snapshot_interpolator.h"
#include "client/viewer/drawing/camera.h"
#include "evod/v1/session.pb.h"

#include <chrono>
#include <cstdint>
#include <optional>

namespace evod::viewer {

class StreamedRegion {
  public:
    using Clock = core::SnapshotInterpolator::Clock;
    static constexpr std::chrono::milliseconds interval{200};
    /// Islands with at least this many organisms per generation are streamed in part. Smaller islands are streamed
    /// whole.
    static constexpr std::uint32_t organisms_min = 5'000;

    /// Returns the view to request now; nullopt if the view returned last is still suitable.
    std::optional<evod::v1::View> update(const Camera& camera, evod::v1::Detail detail, Clock::time_point now);

  private:
    std::optional<Rectangle> region_;
    evod::v1::Detail detail_ = evod::v1::DETAIL_UNSPECIFIED;
    Clock::time_point changed_{};
};

} // namespace evod::viewer
