// Chromosomes: real genes (gene_layout.h); each chromosome is one column of a matrix.
//
// Determinism  each organism of the first generation has its own stream, so its genes do not depend on the number of
//              organisms.
#pragma once

#include "server/base/random.h"
#include "server/evolution/ga_parameters.h"
#include "server/evolution/gene_layout.h"

#include <Eigen/Core>

#include <cstdint>
#include <span>

namespace evod::evolution {

/// Shape (gene_count, organisms): column i is the chromosome of organism i.
using GeneMatrix = Eigen::Array<float, Eigen::Dynamic, Eigen::Dynamic>;
/// The genes of one body.
using BodyGenes = Eigen::Array<float, body_gene_count, 1>;

/// A view of one chromosome, a column of a GeneMatrix, or of a part of it.
using Genes = std::span<float>;
using ConstGenes = std::span<const float>;

template <std::size_t extent = std::dynamic_extent>
std::span<float, extent> column(GeneMatrix& genes, std::uint32_t organism) {
    const std::size_t count = extent == std::dynamic_extent ? static_cast<std::size_t>(genes.rows()) : extent;
    return std::span<float, extent>{genes.data() + count * organism, count};
}
template <std::size_t extent = std::dynamic_extent>
std::span<const float, extent> column(const GeneMatrix& genes, std::uint32_t organism) {
    const std::size_t count = extent == std::dynamic_extent ? static_cast<std::size_t>(genes.rows()) : extent;
    return std::span<const float, extent>{genes.data() + count * organism, count};
}
inline BodyGenes body_genes(const GeneMatrix& genes, std::uint32_t organism) {
    return BodyGenes{column(genes, organism).data()};
}

/// Returns the genes of `range`. A chromosome of a fixed number of genes has only the genes of the body, so it is
/// returned whole.
template <class T, std::size_t extent>
std::span<T, extent> part_of(std::span<T, extent> genes, GeneRange range) {
    if constexpr (extent == std::dynamic_extent) {
        return genes.subspan(range.first, range.count);
    } else {
        return genes;
    }
}

/// Divides the genes of a chromosome into blocks of body_gene_count genes, for loops over organisms that are fast if
/// the number of genes is a constant. Calls visit(first) with the index of each block's first gene. The last block may
/// contain genes of the block before it. There must be at least body_gene_count genes: with_a_block().
template <class Visit>
void for_each_block_of_genes(unsigned gene_count, const Visit& visit) {
    unsigned first = 0;
    for (; first + body_gene_count <= gene_count; first += body_gene_count) {
        visit(first);
    }
    if (first < gene_count) {
        visit(gene_count - body_gene_count);
    }
}

/// Returns the chromosomes with genes of 0 at their ends, so that there are body_gene_count genes.
///
/// genes  fewer genes than that.
inline GeneMatrix with_a_block(const GeneMatrix& genes) {
    GeneMatrix longer = GeneMatrix::Zero(body_gene_count, genes.cols());
    longer.topRows(genes.rows()) = genes;
    return longer;
}

/// Moves every gene outside its bounds to the nearer bound. Returns how many genes it moved.
template <std::size_t extent>
unsigned clamp(std::span<float, extent> genes, const GeneBounds& bounds);

/// Draws the first generation of one island, and clamps every gene to its bounds. Genes of the body are uniform in
/// [initial_gene_min, initial_gene_max], weights in their initial range, and free genes in their bounds.
///
/// organism_count  the size of the island's population; may be 0.
/// returns         shape (gene_count, organism_count). A larger population begins with the organisms of a smaller one,
///                 unless free_gene_start is latin_hypercube.
GeneMatrix initial_population(std::uint32_t organism_count, const Parameters& parameters, base::Seed seed,
                              std::uint32_t island);

} // namespace evod::evolution
