// A population of organisms with the six body genes.
#pragma once

#include "proto/codec/population_csv.h"

#include <utility>
#include <vector>

namespace evod::viewer {

inline codec::Population population_of(std::vector<std::vector<float>> islands) {
    return {{"normal_speed", "impulse", "body_size", "base_health", "food_radius", "poison_radius"},
            std::move(islands)};
}

} // namespace evod::viewer
