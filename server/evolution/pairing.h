// Pairing: decides which parents mate.
#pragma once

#include "server/base/executor.h"
#include "server/base/random.h"

#include <cstdint>
#include <span>
#include <vector>

namespace evod::evolution {

/// The parents of a chromosome: indices into the parents' generation.
struct Parents {
    std::uint32_t first, second; // equal for a survivor, and for a child whose two parents are the same organism
    friend bool operator==(const Parents&, const Parents&) = default;
};

/// Pairs parents in rounds. In each round, all parents are shuffled and neighbours mate. If their number is odd, the
/// last parent mates with a random other parent; a single parent mates with itself. Every parent therefore mates in
/// each round. Rounds are repeated, each with a new shuffle, until there are pair_count pairs. Surplus pairs of the
/// last round are left out.
///
/// parents  indices into the present generation, at least one if pair_count > 0. An organism that was selected twice
///          counts as two parents, and may mate with itself.
/// key      the key of the draws; its purpose must be Purpose::Pairing. Round i draws from the stream of entity i.
/// returns  shape (pair_count).
std::vector<Parents> pair_up(std::span<const std::uint32_t> parents, std::uint32_t pair_count,
                             const base::RandomKey& key, base::Executor& executor);

} // namespace evod::evolution
