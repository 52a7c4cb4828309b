// Flashes: finds meals and deaths by comparing successive snapshots, and keeps each for a short simulated time.
//
// A meal is an item that has disappeared or is at another place, because items disappear only when organisms eat them.
// A death is an organism that has disappeared. If only a region is streamed, entities near its border are ignored,
// because they may have left the region.
//
// Owner        IslandView.
// Threads      none.
#pragma once

#include "proto/codec/snapshot_codec.h"

#include <cstdint>
#include <memory>
#include <vector>

namespace evod::viewer {

struct Flash {
    enum class Kind : std::uint8_t { Food, Poison, Death } kind;
    float x_px, y_px;
    float radius_px; // of the item or organism
    double began_s;  // simulated time
};

class Flashes {
  public:
    static constexpr double shown_s = 0.7; // in simulated seconds
    /// Snapshots that are farther apart are not compared, because the flashes would last for one snapshot only.
    static constexpr double compared_s_max = shown_s / 2;

    /// Compares a snapshot with the one added before it. Clears all flashes if it is of another world, run, island or
    /// generation, or of an earlier tick.
    void add(const std::shared_ptr<const codec::ReceivedSnapshot>& snapshot);
    void clear() { *this = Flashes{}; }
    /// The flashes that began at most shown_s before the newest snapshot, oldest first.
    const std::vector<Flash>& all() const { return flashes_; }

  private:
    std::shared_ptr<const codec::ReceivedSnapshot> last_;
    std::vector<Flash> flashes_;
};

} // namespace evod::viewer
