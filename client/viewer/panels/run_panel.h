// RunPanel: runs, pauses, steps and resets the viewed world.
//
// Owner        Panels.
// Threads      none; used on the drawing thread.
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
    void build(Context& context) override;

  private:
    void build_state(const ViewedWorld& world);
    void build_run(ViewedWorld& world, float scale);
    void build_reset(ViewedWorld& world, float scale);

    using Field = std::array<char, 24>;
    Field ticks_{"60"}, generations_{"10"};
    Field seed_{};        // empty: keep the seed
    std::string problem_; // problem with the last input: "ticks: …"
};

} // namespace evod::viewer
