// Healthiest: the living organisms that do best at a moment.
//
// Owner        WorldFeed has a HealthRanking for each island.
// Threads      none; used by the thread that draws.
#pragma once

#include "proto/codec/snapshot_codec.h"

#include <cstddef>
#include <memory>
#include <span>
#include <vector>

namespace evod::viewer {

/// Returns the indices of the `count` healthiest organisms, or of all if there are fewer; the healthiest first, and
/// those with equal health by id.
std::vector<std::size_t> healthiest(const codec::Entities& organisms, std::size_t count);

/// Ranks the organisms of a snapshot once, although several parts of the viewer show the healthiest in every frame.
class HealthRanking {
  public:
    static constexpr std::size_t named_count = 3;  // labels on the island and the summary name this many organisms
    static constexpr std::size_t ranked_count = 5; // the organism panel offers all that are ranked

    /// Returns healthiest() of a snapshot, for a `count` of at most ranked_count; none if the snapshot is null. Valid
    /// until the next call.
    std::span<const std::size_t> of(const std::shared_ptr<const codec::ReceivedSnapshot>& snapshot, std::size_t count);

  private:
    std::shared_ptr<const codec::ReceivedSnapshot> ranked_;
    std::vector<std::size_t> indices_; // the healthiest in ranked_
};

} // namespace evod::viewer
