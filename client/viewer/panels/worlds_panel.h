// WorldsPanel: the worlds of the server and how each is doing; a click looks at one, or at another of its islands.
//
// Threads      none; used by the thread that draws.
#pragma once

#include "client/viewer/panels/panel.h"
#include "client/viewer/watch/inquiry.h"

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

    void ask(Watch& watch, Clock::time_point now);
    void hear(const Watch& watch);
    void look_again();
    void build_worlds(Watch& watch);
    void build_islands(Watch& watch);

    std::vector<evod::v1::WorldInfo> worlds_;
    evod::v1::Statistics statistics_; // of the place that is looked at
    std::uint64_t place_number_ = 0;  // that they are of
    Inquiry list_inquiry_{ask_again};
    Inquiry statistics_inquiry_{ask_again};
};

} // namespace evod::viewer
