// OrganismHistory: what is known of one organism since it was selected: its health over time, its death, its children.
//
// Owner        IslandView.
// Threads      none; used by the thread that draws.
#pragma once

#include "client/viewer/world/population.h"
#include "proto/codec/snapshot_codec.h"

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

namespace evod::viewer {

class OrganismHistory {
  public:
    static constexpr std::size_t points_max = 1024; // when full, every second point is dropped

    struct Health {
        double s = 0; // simulated seconds since the start of the run
        float health = 0;
    };
    /// A child in the next generation.
    struct Child {
        std::uint32_t id = 0;
        std::optional<std::uint32_t> other_parent{}; // nullopt: it is the only parent
        bool same_genes = false;                     // an unchanged copy
    };

    OrganismHistory(std::uint32_t id, std::uint64_t generation) : id_{id}, generation_{generation} {}

    /// Adds a point of health from a snapshot of its island. A snapshot of another generation ends the history.
    void add(const codec::DecodedSnapshot& snapshot);
    /// Takes over the server's description, if it is of this id and generation: ids repeat in every generation.
    void add(const evod::v1::OrganismInfo& info);
    /// Takes the ranges of the genes from its own generation, and the children from the next one.
    void add(const Population& population);

    std::uint32_t id() const { return id_; }
    std::uint64_t generation() const { return generation_; }
    const std::vector<Health>& health() const { return health_; } // rising in time
    /// The server's newest description; nullopt before the first.
    const std::optional<evod::v1::OrganismInfo>& info() const { return info_; }
    bool dead() const { return info_ && !info_->alive(); }
    bool ended() const { return ended_; } // whether its generation has ended
    /// Of its generation, by gene; empty until known.
    const std::vector<Population::Range>& ranges() const { return ranges_; }
    /// Nullopt until known.
    const std::optional<std::vector<Child>>& children() const { return children_; }
    bool waits_for_children() const { return ended_ && !children_ && !too_late_; }

  private:
    std::uint32_t id_;
    std::uint64_t generation_;
    std::vector<Health> health_;
    std::optional<evod::v1::OrganismInfo> info_;
    std::vector<Population::Range> ranges_;
    std::optional<std::vector<Child>> children_;
    bool ended_ = false, too_late_ = false;
};

} // namespace evod::viewer
