// WorldsPanel: the worlds of the server with their state. A click shows a world, or another island of it.
//
// Owner        Panels.
// Threads      none; used on the drawing thread.
#pragma once

#include "client/viewer/panels/panel.h"
#include "client/viewer/world/poll.h"

#include <chrono>
#include <cstdint>
#include <vector>

namespace evod::viewer {

class WorldsPanel : public Panel {
  public:
    std::string_view title() const override { return "Worlds"; }
    Size first_size() const override { return {460, 420}; }
    void build(Context& context) override;

  private:
    using Clock = core::WorldView::Clock;

    // Fast enough for a user to read the rising ticks.
    static constexpr std::chrono::seconds poll_interval{1};

    void poll(ViewedWorld& world, Clock::time_point now);
    void process_events(const ViewedWorld& world);
    void refresh();
    void build_worlds(ViewedWorld& world);
    void build_islands(ViewedWorld& world);

    std::vector<evod::v1::WorldInfo> worlds_;
    evod::v1::Statistics statistics_; // of the world and island shown
    std::uint64_t place_number_ = 0;  // of the place that statistics_ describes
    Poll list_poll_{poll_interval};
    Poll statistics_poll_{poll_interval};
};

} // namespace evod::viewer
