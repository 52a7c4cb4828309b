// Brain input: what a network may have as inputs. This file contains only an enumeration, so that kernels
// (base/lanes.h) may include it.
#pragma once

#include <cstdint>

namespace evod::evolution {

/// The inputs that a network can have. A network has those that the parameters select, in this order.
enum class BrainInput : std::uint8_t {
    FoodBearing,
    FoodProximity,
    PoisonBearing,
    PoisonProximity,
    Speed,
    Health,
    WallProximity
};
constexpr unsigned brain_inputs_max = 7;
constexpr unsigned brain_hidden_max = 32;

} // namespace evod::evolution
