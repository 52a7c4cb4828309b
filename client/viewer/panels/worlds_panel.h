// WorldsPanel: lists the worlds of the server and their states. A click shows a world, or another island of the viewed
// world.
//
// Owner        Panels.
// Threads      none; used on the drawing thread.
#pragma once

#include "client/viewer/panels/panel.h"
#include "client/viewer/world/poll.h"

#include <chrono>
#include <cstdint>
#include <string>
#include <vector>

namespace evod::viewer {

class WorldsPanel : public Panel {
  public:
    std::string_view title() const override { return "Worlds"; }
    void build(Context& context) override;

  private:
    using Clock = core::SnapshotInterpolator::Clock;

    // Interval between requests, short enough for the user to see the tick numbers rise.
    static constexpr std::chrono::seconds poll_interval{1};

    void poll(ViewedWorld& world, Clock::time_point now);
    void process_events(const ViewedWorld& world);
    void refresh();
    void build_worlds(ViewedWorld& world);
    void build_islands(ViewedWorld& world);

    std::vector<evod::v1::WorldInfo> worlds_;
    std::vector<evod::v1::DamagedWorld> damaged_;
    evod::v1::Statistics statistics_; // statistics of the viewed world
    std::uint64_t place_number_ = 0;  // the place that statistics_ describes
    Poll list_poll_{poll_interval};
    Poll statistics_poll_{poll_interval};
};

} // namespace evod::viewer
