// Chromosomes: each has six real genes and is one column of a matrix.
//
// Determinism  each organism of the first generation has its own stream, so its genes do not depend on the number of
//              organisms.
#pragma once

#include "server/base/random.h"
#include "server/evolution/parameters.h"

#include <Eigen/Core>

#include <array>
#include <cstdint>
#include <span>
#include <string_view>

namespace evod::evolution {

/// The genes, in chromosome order.
enum Gene : unsigned { NormalSpeed, Impulse, BodySize, BaseHealth, FoodRadius, PoisonRadius };
constexpr unsigned gene_count = 6;
constexpr std::array<std::string_view, gene_count> gene_names = {"normal_speed", "impulse",     "body_size",
                                                                 "base_health",  "food_radius", "poison_radius"};

/// Shape (gene_count, organisms): column i is the chromosome of organism i.
using GeneMatrix = Eigen::Array<float, gene_count, Eigen::Dynamic>;
using Chromosome = Eigen::Array<float, gene_count, 1>;

/// A view of one chromosome: a column of a GeneMatrix.
using Genes = std::span<float, gene_count>;
using ConstGenes = std::span<const float, gene_count>;

inline Genes column(GeneMatrix& genes, std::uint32_t organism) {
    return Genes{genes.data() + std::size_t{gene_count} * organism, gene_count};
}
inline ConstGenes column(const GeneMatrix& genes, std::uint32_t organism) {
    return ConstGenes{genes.data() + std::size_t{gene_count} * organism, gene_count};
}

/// The allowed range of each gene, both ends included.
struct GeneBounds {
    Chromosome min, max;
};

GeneBounds gene_bounds(const Parameters& parameters);

/// Moves every gene outside its bounds to the nearer bound. Returns how many genes it moved.
unsigned clamp(Genes genes, const GeneBounds& bounds);

/// Draws the first generation of one island: every gene is uniform in [initial_gene_min, initial_gene_max], and then
/// clamped to its bounds.
///
/// organism_count  the size of the island's population; may be 0.
/// returns         shape (gene_count, organism_count); a larger population begins with the organisms of a smaller one.
GeneMatrix initial_population(std::uint32_t organism_count, const Parameters& parameters, base::Seed seed,
                              std::uint32_t island);

} // namespace evod::evolution
