#include "client/viewer/panels/physics/motion_history.h"

#include "client/viewer/text/numbers.h"

namespace evod::viewer {
namespace {

// Movement per tick as a share of the body's radius. Above close_share the panel warns and advises values that bring
// the movement down to advised_share. If two approaching bodies each move a whole radius per tick, they may pass
// through each other undetected. The first generation of a world with default parameters reaches 0.2; later ones may
// exceed 1.
constexpr double close_share = 0.75, advised_share = 0.5;

/// Recommends parameter values with which the fastest body moves advised_share of its radius per tick.
std::string advice(const evod::v1::Motion& motion) {
    const double share = motion.fastest_step_share();
    if (share <= advised_share) { // only an earlier speed was too high
        return "Halve tick_s, to " + print("%.3g", motion.tick_s() / 2) + ", or lower max_speed_px_s.";
    }
    return "Set tick_s to " + print("%.3g", motion.tick_s() * advised_share / share) +
           " or less, or max_speed_px_s to " + print("%.3g", motion.fastest_px_s() * advised_share / share) + ".";
}

} // namespace

void MotionHistory::add(const evod::v1::Motion& motion) {
    if (!motions_.empty() && motion.tick() < motions_.back().tick()) {
        motions_.clear();
    }
    if (!motions_.empty() && motion.tick() == motions_.back().tick()) {
        motions_.back() = motion;
        return;
    }
    motions_.push_back(motion);
    if (motions_.size() > kept) {
        motions_.pop_front();
    }
}

TickVerdict judge_tick(const evod::v1::Motion& motion) {
    const std::string fastest =
        "the fastest body moves " + print("%.2g", motion.fastest_step_share()) + " of its radius per tick";
    if (motion.fastest_step_share() >= 1 || motion.too_fast_count() > 0) {
        std::string sentence = "The tick is too long: " + fastest;
        if (motion.too_fast_count() > 0) {
            sentence += ", and " + with_separators(motion.too_fast_count()) +
                        (motion.too_fast_count() == 1 ? " move" : " moves") +
                        " in this generation exceeded the radius of the body";
        }
        return {TickVerdict::Level::TooLong,
                sentence + ". Bodies may pass through each other undetected. " + advice(motion)};
    }
    if (motion.fastest_step_share() >= close_share) {
        return {TickVerdict::Level::Close, "The tick is nearly too long: " + fastest + ". " + advice(motion)};
    }
    return {TickVerdict::Level::Good, "The tick is short enough: " + fastest + "."};
}

} // namespace evod::viewer
