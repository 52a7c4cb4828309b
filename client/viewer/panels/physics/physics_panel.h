// Physics panel: energy, momentum, overlaps and speeds of the bodies on the island over time, whether the tick is short
// enough for them, and a motion with a known exact solution, stepped with a tick of any length.
//
// Threads      none; used by the thread that draws.
#pragma once

#include "client/viewer/panels/panel.h"
#include "client/viewer/panels/physics/motion_history.h"
#include "client/viewer/panels/physics/time_step_demo.h"
#include "client/viewer/world/poll.h"

#include <vector>

namespace evod::viewer {

class PhysicsPanel : public Panel {
  public:
    std::string_view title() const override { return "Physics"; }
    void build(Context& context) override;

  private:
    /// Asks how the bodies move, a few times a second.
    void ask(Context& context);
    void build_motion();
    void build_demo();
    void take_curves(const TimeStepDemo& demo);

    std::uint64_t place_number_ = 0; // that the history is of
    Poll poll_{std::chrono::milliseconds{250}};
    MotionHistory history_;

    // The demonstration, as it was last worked out.
    bool spring_ = true;
    float rate_per_s_ = 2; // ω of the spring, c of damped motion
    float tick_ms_ = 100;
    std::vector<TimeStepDemo::Row> rows_;
    struct Curve {
        const char* name;
        Colour colour;
        std::vector<double> x_px, energy; // by row; energy as a share of that at the start
    };
    std::vector<double> t_s_;   // by row
    std::vector<Curve> curves_; // the first at the back
};

} // namespace evod::viewer
