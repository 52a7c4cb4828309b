// PopulationGenes: the genes of an island's population, put together from the answers to GetPopulation.
//
// Threads      none.
#pragma once

#include "evod/v1/session.pb.h"

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace evod::viewer {

class PopulationGenes {
  public:
    /// The next question; the answers must be taken in the order of their questions.
    evod::v1::Request question(const std::string& world, std::uint32_t island) const;

    /// False if it does not hang together with the answers before, or in itself: then all is to be asked for again.
    bool take(const evod::v1::Population& page);

    /// Whether everyone has been told of.
    bool complete() const { return organism_count_ && read_ == *organism_count_; }
    std::uint64_t generation() const { return generation_; }

    /// Whether it is known who lives: not where organisms have no bodies, or their generation is over.
    bool knows_the_living() const { return living_count_ > 0; }
    /// Of everyone, or of those that live; empty if there is no such gene.
    std::vector<float> gene(std::size_t index, bool of_the_living) const;

  private:
    std::uint64_t generation_ = 0;
    std::optional<std::uint32_t> organism_count_;
    std::uint32_t read_ = 0, living_count_ = 0;
    std::vector<std::vector<float>> genes_; // by gene
    std::vector<bool> lives_;
};

} // namespace evod::viewer
