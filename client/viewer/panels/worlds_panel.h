// WorldsPanel: the worlds of the server and how each is doing; a click looks at one, or at another of its islands.
//
// Threads      none; used by the thread that draws.
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

    // Ticks rise all the time; nobody reads them faster.
    static constexpr std::chrono::seconds ask_again{1};

    void ask(ViewedWorld& world, Clock::time_point now);
    void hear(const ViewedWorld& world);
    void poll_interval();
    void build_worlds(ViewedWorld& world);
    void build_islands(ViewedWorld& world);

    std::vector<evod::v1::WorldInfo> worlds_;
    evod::v1::Statistics statistics_; // of the place that is looked at
    std::uint64_t place_number_ = 0;  // that they are of
    Poll list_poll_{ask_again};
    Poll statistics_poll_{ask_again};
};

} // namespace evod::viewer
