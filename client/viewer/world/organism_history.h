// OrganismHistory: the data about one organism that were received since it was selected: its health over time, its
// death, its parents and its children.
//
// Owner        IslandView.
// Threads      none; used by the thread that draws.
#pragma once

#include "client/viewer/world/population.h"
#include "evod/v1/commands.pb.h"
#include "proto/codec/snapshot_codec.h"

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

namespace evod::viewer {

class OrganismHistory {
  public:
    static constexpr std::size_t points_max = 1024; // when reached, every second point is removed

    struct Health {
        double s = 0; // simulated time since the start of the run
        float health = 0;
    };
    /// A child in the next generation.
    struct Child {
        std::uint32_t id = 0;
        std::optional<std::uint32_t> other_parent{}; // nullopt: the child has only one parent
        bool same_genes = false;                     // the child is an unchanged copy
    };

    struct Parent {
        std::uint32_t id = 0;
        /// The organism of another island of which the parent is a copy; nullopt: the parent lived on this island.
        std::optional<evod::v1::Migrant> migrant{};
    };
    /// How the organism itself came into its generation.
    enum class Origin { Unknown, Elite, Survivor, Child };

    OrganismHistory(std::uint32_t id, std::uint64_t generation) : id_{id}, generation_{generation} {}

    /// Adds a point of health from a snapshot of the organism's island. A snapshot of another generation ends the
    /// history.
    void add(const codec::ReceivedSnapshot& snapshot);
    /// Stores the server's description if it is about this organism. Both id and generation must match, because every
    /// generation uses the same ids.
    void add(const evod::v1::OrganismInfo& info);
    /// Reads a population: the ranges of the genes from the organism's own generation, the children from the next one.
    void add(const Population& population);
    /// Reads a parent. The list of contenders of the answer begins at the organism that wanted_parent() has named.
    void add(const evod::v1::GetBreeding& request, const evod::v1::Breeding& breeding);

    /// Returns the next request for a parent, without world and island; nullopt if nothing is missing.
    std::optional<evod::v1::GetBreeding> wanted_parent() const;
    /// Returns the parent with this id; null until known.
    const Parent* parent(std::uint32_t id) const;
    Origin origin() const { return origin_; }

    std::uint32_t id() const { return id_; }
    std::uint64_t generation() const { return generation_; }
    const std::vector<Health>& health() const { return health_; } // ordered by time
    /// Returns the newest description by the server; nullopt before the first one.
    const std::optional<evod::v1::OrganismInfo>& info() const { return info_; }
    bool dead() const { return info_ && !info_->alive(); }
    bool ended() const { return ended_; } // whether its generation has ended
    /// Returns the range of each gene in the organism's generation; empty until the population has been received.
    const std::vector<Population::Range>& ranges() const { return ranges_; }
    /// Returns the children; nullopt until the next generation's population has been received.
    const std::optional<std::vector<Child>>& children() const { return children_; }
    bool waits_for_children() const { return ended_ && !children_ && !too_late_; }

  private:
    std::uint32_t id_;
    std::uint64_t generation_;
    std::vector<Health> health_;
    std::optional<evod::v1::OrganismInfo> info_;
    std::vector<Population::Range> ranges_;
    std::optional<std::vector<Child>> children_;
    std::vector<Parent> parents_; // those that were received
    Origin origin_ = Origin::Unknown;
    bool ended_ = false, too_late_ = false;
};

} // namespace evod::viewer
