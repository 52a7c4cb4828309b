// RunPanel: runs, pauses, steps and resets the world that is looked at, and says how fast it goes.
//
// Threads      none; used by the thread that draws.
#pragma once

#include "client/viewer/panels/panel.h"

#include <array>
#include <cstdint>
#include <optional>
#include <string>

namespace evod::viewer {

class RunPanel : public Panel {
  public:
    std::string_view title() const override { return "Run"; }
    Size first_size() const override { return {400, 280}; }
    void build(Context& context) override;

  private:
    void build_state(const Watch& watch);
    void build_run(Watch& watch, float scale);
    void build_speed(Watch& watch);
    void build_reset(Watch& watch, float scale);

    int generations_ = 10;
    int ticks_ = 60;
    std::optional<double> factor_; // while the slider is held
    std::array<char, 24> seed_{};  // empty: the same again
    std::string problem_;
};

} // namespace evod::viewer
