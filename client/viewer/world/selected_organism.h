// SelectedOrganism: what was received about one organism since it was selected: the server's description, and the
// ranges of the genes in its generation.
//
// Owner        IslandData.
// Threads      none; used by the thread that draws.
#pragma once

#include "client/viewer/world/population.h"
#include "evod/v1/commands.pb.h"

#include <cstdint>
#include <optional>
#include <vector>

namespace evod::viewer {

class SelectedOrganism {
  public:
    SelectedOrganism(std::uint32_t id, std::uint64_t generation) : id_{id}, generation_{generation} {}

    /// Reads the generation of a snapshot of the organism's island. Another one ends the organism's generation.
    void add_generation(std::uint64_t shown) { ended_ = ended_ || shown != generation_; }
    /// Stores the server's description if it is about this organism. Both id and generation must match, because every
    /// generation uses the same ids.
    void add(const evod::v1::OrganismInfo& info);
    /// Reads the ranges of the genes from a population of the organism's generation.
    void add(const Population& population);

    std::uint32_t id() const { return id_; }
    std::uint64_t generation() const { return generation_; }
    /// Returns the newest description by the server; nullopt before the first one.
    const std::optional<evod::v1::OrganismInfo>& info() const { return info_; }
    bool dead() const { return info_ && !info_->alive(); }
    bool ended() const { return ended_; } // whether its generation has ended
    /// Returns the range of each gene in the organism's generation; empty until the population has been received.
    const std::vector<Population::Range>& ranges() const { return ranges_; }

  private:
    std::uint32_t id_;
    std::uint64_t generation_;
    std::optional<evod::v1::OrganismInfo> info_;
    std::vector<Population::Range> ranges_;
    bool ended_ = false;
};

} // namespace evod::viewer
