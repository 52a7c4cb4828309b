// Pairing: who mates with whom.
//
// Determinism  each round has a stream of its own.
#pragma once

#include "server/base/executor.h"
#include "server/base/random.h"

#include <cstdint>
#include <span>
#include <vector>

namespace evod::evolution {

/// Where a chromosome comes from: indices into the parents' generation.
struct Parents {
    std::uint32_t first, second; // equal for a survivor, and for a child of one organism with itself
    friend bool operator==(const Parents&, const Parents&) = default;
};

/// Pairs up parents in rounds. In a round all are shuffled and neighbours mate; if their number is odd, the one left
/// over mates with one of the others, each equally likely, and a lone parent with itself. So everyone has mated before
/// anyone mates for a second time of its own. Rounds follow, freshly shuffled, until there are enough pairs; the last
/// one's surplus pairs are not made.
///
/// parents  indices into the present generation, at least one if pair_count > 0. An organism that was selected twice is
///          two parents, and may mate with itself.
/// key      made for Purpose::Pairing; round i draws from the stream of entity i.
/// returns  shape (pair_count).
std::vector<Parents> pair_up(std::span<const std::uint32_t> parents, std::uint32_t pair_count,
                             const base::RandomKey& key, base::Executor& executor);

} // namespace evod::evolution
