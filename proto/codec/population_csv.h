// Population CSV: the chromosomes of a generation as text. Another world can start from this text.
//
//   island,organism,normal_speed,impulse,body_size,base_health,food_radius,poison_radius
//   0,0,103.2,97.5,…
//
// Islands and organisms are numbered from 0, in order. Each gene is the shortest text that parses to the same float.
#pragma once

#include "proto/codec/result.h"

#include <cstddef>
#include <istream>
#include <string>
#include <string_view>
#include <vector>

namespace evod::codec {

constexpr std::string_view population_heading =
    "island,organism,normal_speed,impulse,body_size,base_health,food_radius,poison_radius";
constexpr std::size_t population_genes = 6;

/// Reads the genes. The shape of the result is (islands, organisms · population_genes); the genes of an organism are
/// adjacent. Does not check whether a world can start with them. Damage reads "line 3: got …, allowed …".
Result<std::vector<std::vector<float>>> read_population(std::istream& in);

/// Returns the text of a file with these genes, in the shape that read_population() returns.
std::string population_text(const std::vector<std::vector<float>>& islands);

} // namespace evod::codec
