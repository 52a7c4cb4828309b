// OrganismStory: what is known of one organism since it was selected: its health, its end, its children.
//
// Threads      none; used by the thread that draws.
#pragma once

#include "client/viewer/watch/population.h"
#include "proto/codec/snapshot_codec.h"

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

namespace evod::viewer {

class OrganismStory {
  public:
    static constexpr std::size_t points_max = 1024; // more are thinned to half

    struct Health {
        double s = 0; // simulated, since the run began
        float health = 0;
    };
    /// Who came of it in the generation after.
    struct Child {
        std::uint32_t id = 0;
        std::optional<std::uint32_t> other_parent{}; // nullopt: itself alone
        bool same_genes = false;                     // it lives on in it as it was
    };

    OrganismStory(std::uint32_t id, std::uint64_t generation) : id_{id}, generation_{generation} {}

    /// A picture of its island; those of other generations change nothing but end it.
    void see(const codec::DecodedSnapshot& picture);
    /// What the server says of the organism of that id; of another generation it is another organism.
    void take(const evod::v1::OrganismInfo& info);
    /// A whole population: of its generation, among which it lives, or of the one after, in which its children are.
    void take(const Population& population);

    std::uint32_t id() const { return id_; }
    std::uint64_t generation() const { return generation_; }
    const std::vector<Health>& health() const { return health_; } // rising in time
    /// The last that the server said; nullopt before it did.
    const std::optional<evod::v1::OrganismInfo>& info() const { return info_; }
    bool dead() const { return info_ && !info_->alive(); }
    bool ended() const { return ended_; } // its generation has
    /// Of its generation, by gene; empty before they are known.
    const std::vector<Population::Range>& ranges() const { return ranges_; }
    /// Nullopt until they are known.
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
