// WorldsPanel: the worlds of the server and how each is doing; a click looks at one, or at another of its islands.
//
// Threads      none; used by the thread that draws.
#pragma once

#include "client/viewer/panels/panel.h"

#include <optional>
#include <vector>

namespace evod::viewer {

class WorldsPanel : public Panel {
  public:
    std::string_view title() const override { return "Worlds"; }
    Size first_size() const override { return {460, 420}; }
    void build(Context& context) override;

  private:
    using Clock = link::WorldView::Clock;

    void ask(Watch& watch, Clock::time_point now);
    void hear(Watch& watch);
    void build_worlds(Watch& watch);
    void build_islands(Watch& watch);

    std::vector<evod::v1::WorldInfo> worlds_;
    evod::v1::Statistics statistics_; // of the world that is looked at
    std::string world_;               // that it was of
    std::string problem_;
    unsigned unanswered_count_ = 0;
    bool stale_ = true;
    Clock::time_point asked_{};
};

} // namespace evod::viewer
