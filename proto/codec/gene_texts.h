// Gene texts: the texts of genes that are choices, for people and tables. Chromosomes contain the index of a choice.
#pragma once

#include "evod/v1/world.pb.h"

#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace evod::codec {

class GeneTexts {
  public:
    /// None of the genes is a choice.
    GeneTexts() = default;
    /// list        of the free genes, as WorldInfo contains it.
    /// gene_names  the genes of a chromosome or a table, in its order.
    GeneTexts(const v1::FreeGeneList& list, std::span<const std::string> gene_names);

    explicit GeneTexts(const v1::WorldInfo& world);

    /// The choice whose index a gene contains; nullptr for numbers, and if no choice has this index.
    const std::string* choice(std::size_t gene, float value) const;
    /// Returns the choice, or `number`, which is the value as text.
    std::string text_of(std::size_t gene, float value, std::string number) const;
    /// Returns the index of a choice; nullopt if the gene has no choice with this text.
    std::optional<float> index_of(std::size_t gene, std::string_view text) const;
    /// Returns all choices of a gene: "steel, wood"; "" for numbers.
    std::string all(std::size_t gene) const;

  private:
    std::vector<std::vector<std::string>> choices_; // by gene; may be shorter than a chromosome
};

} // namespace evod::codec
