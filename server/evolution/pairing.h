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
    std::uint32_t first, second; // equal for a survivor, and for a child of one organism with itself
    friend bool operator==(const Parents&, const Parents&) = default;
};

/// Pairs parents in rounds. In each round all parents are shuffled and neighbours mate. If their number is odd, the
/// last one mates with one of the others, each equally likely; a single parent mates with itself. In each round, every
/// parent mates. Rounds are repeated, with a new shuffle each, until there are enough pairs; the surplus pairs of the
/// last round are omitted.
///
/// parents  indices into the present generation, at least one if pair_count > 0. An organism that was selected twice
///          counts as two parents, and may mate with itself.
/// key      made for Purpose::Pairing; round i draws from the stream of entity i.
/// returns  shape (pair_count).
std::vector<Parents> pair_up(std::span<const std::uint32_t> parents, std::uint32_t pair_count,
                             const base::RandomKey& key, base::Executor& executor);

} // namespace evod::evolution
