#include "client/viewer/panels/physics/motion_history.h"

#include "client/viewer/text/numbers.h"

#include <algorithm>
#include <cstdint>

namespace evod::viewer {
namespace {

// The share of bodies that move further than their radius per tick, as the average of the generation. The panel warns
// above close_share. In a world with default parameters, selection makes bodies small and fast until 0.02 of them do.
constexpr double close_share = 0.03, too_long_share = 0.1;
// The movement per tick to which the advised values reduce the fastest body, as a share of its radius.
constexpr double advised_movement = 0.5;

/// Recommends parameter values with which the fastest body moves advised_movement of its radius per tick.
std::string advice(const evod::v1::Motion& motion) {
    const double share = motion.fastest_step_share();
    if (share <= advised_movement) { // only an earlier speed was too high
        return "Halve tick_s, to " + print("%.3g", motion.tick_s() / 2) + ", or lower max_speed_px_s.";
    }
    return "Set tick_s to " + print("%.3g", motion.tick_s() * advised_movement / share) +
           " or less, or max_speed_px_s to " + print("%.3g", motion.fastest_px_s() * advised_movement / share) + ".";
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
    const auto ticks = static_cast<double>(std::max<std::uint64_t>(motion.generation_tick(), 1));
    const double fast = static_cast<double>(motion.too_fast_count()) / ticks; // bodies per tick
    if (motion.too_fast_count() == 0) {
        return {TickVerdict::Level::Good, "The tick is short enough: the fastest body moves " +
                                              significant(motion.fastest_step_share()) + " of its radius per tick."};
    }
    const std::string finding = "on average " + significant(fast) + " of " + with_separators(motion.body_count()) +
                                " bodies move further than their radius in a tick of this generation. Two such bodies "
                                "that meet may pass through each other.";
    const double share = fast / std::max<double>(motion.body_count(), 1);
    if (share < close_share) {
        return {TickVerdict::Level::Good, "The tick is short enough: only " + finding};
    }
    if (share < too_long_share) {
        return {TickVerdict::Level::Close, "The tick is nearly too long: " + finding + " " + advice(motion)};
    }
    return {TickVerdict::Level::TooLong, "The tick is too long: " + finding + " " + advice(motion)};
}

} // namespace evod::viewer
