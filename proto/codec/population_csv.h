// Population CSV: the chromosomes of a generation as text, for another world to begin with.
//
//   island,organism,normal_speed,impulse,body_size,base_health,food_radius,poison_radius
//   0,0,103.2,97.5,…
//
// Islands and organisms count from 0, in order. A gene is the shortest text that reads back as the same float.
#pragma once

#include "proto/codec/result.h"

#include <cstddef>
#include <istream>
#include <string_view>
#include <vector>

namespace evod::codec {

constexpr std::string_view population_heading =
    "island,organism,normal_speed,impulse,body_size,base_health,food_radius,poison_radius";
constexpr std::size_t population_genes = 6;

/// Shape (islands, organisms · population_genes), each organism's genes together. Whether a world can begin so is not
/// judged here. Damage says which line, what was got and what is allowed: "line 3: got …, allowed …".
Result<std::vector<std::vector<float>>> read_population(std::istream& in);

} // namespace evod::codec
