// Population: the genes and behaviour of one generation on one island, in columns indexed by organism id.
//
// It is assembled from the pages that the server sends in answer to GetPopulation. Each page is validated.
//
// Owner        PopulationPoll.
// Threads      none; used by the thread that draws.
#pragma once

#include "evod/v1/commands.pb.h"
#include "proto/codec/snapshot_codec.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace evod::viewer {

class Population {
  public:
    struct Range {
        float min = 0, mean = 0, max = 0;
    };
    /// gene_count  number of genes of the world; the pages do not contain it.
    explicit Population(std::size_t gene_count = 0) : genes_(gene_count) {}

    /// Adds a page. The page must begin at the id next().
    ///
    /// returns  nullopt on success; otherwise the fault of the page, as a sentence without a full stop, and nothing is
    ///          added.
    std::optional<std::string> add(const evod::v1::Population& page);

    /// Returns the id at which the next page must begin.
    std::uint32_t next() const { return static_cast<std::uint32_t>(size()); }
    bool complete() const { return begun_ && size() == organism_count_; }

    std::uint64_t generation() const { return generation_; } // 0 before the first page
    std::uint64_t generation_tick() const { return generation_tick_; }
    std::size_t size() const { return choices_.size(); }
    /// Returns whether this page cannot follow the earlier ones, because another generation has begun or an organism
    /// was placed since then.
    bool is_outdated_by(const evod::v1::Population& page) const {
        return begun_ && (page.generation() != generation_ || page.organism_count() != organism_count_);
    }

    // The following functions take an id less than size().
    std::size_t gene_count() const { return genes_.size(); }
    std::span<const float> gene(std::size_t gene) const { return genes_[gene]; }
    evod::v1::Choice choice(std::uint32_t id) const { return evod::v1::Choice(choices_[id]); }
    std::span<const float> force_x() const { return forces_[0]; }
    std::span<const float> force_y() const { return forces_[1]; }
    std::span<const float> target_x_px() const { return targets_[0]; }
    std::span<const float> target_y_px() const { return targets_[1]; }

    // The following functions require a complete population.
    Range range(std::size_t gene) const { return ranges_[gene]; }

  private:
    void finish();

    bool begun_ = false;
    std::uint64_t generation_ = 0, generation_tick_ = 0;
    std::size_t organism_count_ = 0;
    std::vector<std::vector<float>> genes_;
    std::vector<std::uint8_t> choices_;
    std::array<std::vector<float>, 2> forces_, targets_;
    std::vector<Range> ranges_;
};

} // namespace evod::viewer
