// Physics panel: plots energy, momentum, overlaps and speeds of the bodies of an island over time, and rates whether
// the tick is short enough for them. A demonstration steps a motion with a known exact solution, with a tick of any
// length. A table compares five tick lengths for a body with constant acceleration.
//
// Owner        Panels.
// Threads      none; used on the drawing thread.
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
    /// Requests the motion of the bodies with GetMotion a few times per second.
    void poll(Context& context);
    void build_motion();
    void build_demo();
    void build_constant_acceleration() const;
    void set_curves(const TimeStepDemo& demo);

    std::uint64_t place_number_ = 0; // the place (world and island) that history_ describes
    Poll poll_{std::chrono::milliseconds{250}};
    MotionHistory history_;

    // Settings and results of the demonstration.
    bool spring_ = true;
    float rate_per_s_ = 2; // ω of the spring, or c of damped motion
    float tick_ms_ = 100;
    std::vector<TimeStepDemo::Row> rows_;
    struct Curve {
        const char* name;
        Colour colour;
        std::vector<double> x_px, energy; // by row; energy is relative to its initial value
    };
    std::vector<double> t_s_;   // time of each row
    std::vector<Curve> curves_; // in drawing order
};

} // namespace evod::viewer
