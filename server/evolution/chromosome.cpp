#include "server/evolution/chromosome.h"

#include "server/base/assert.h"
#include "server/evolution/brain_layout.h"
#include "server/evolution/free_gene_operators.h"

#include <algorithm>

namespace evod::evolution {

template <std::size_t extent>
unsigned clamp(std::span<float, extent> genes, const GeneBounds& bounds) {
    const float *const min = bounds.min.data(), *const max = bounds.max.data();
    unsigned clamped = 0;
    for (unsigned gene = 0; gene < genes.size(); ++gene) {
        const float value = genes[gene];
        genes[gene] = std::min(std::max(value, min[gene]), max[gene]);
        clamped += genes[gene] != value;
    }
    return clamped;
}
template unsigned clamp(std::span<float, body_gene_count>, const GeneBounds&);
template unsigned clamp(Genes, const GeneBounds&);

namespace {

/// Returns the parameters with a list of the free genes, which they lack.
Parameters with_list(Parameters parameters) {
    FreeGene real;
    real.min = parameters.free_gene_min;
    real.max = parameters.free_gene_max;
    parameters.listed_genes = FreeGenes{std::vector(parameters.free_genes, real)};
    return parameters;
}

} // namespace

GeneMatrix initial_population(std::uint32_t organism_count, const Parameters& parameters, base::Seed seed,
                              std::uint32_t island) {
    EVOD_ASSERT(parameters.initial_gene_min <= parameters.initial_gene_max);
    const base::RandomKey key{seed, base::Purpose::InitialChromosome, island, 1};
    const GeneBounds bounds = gene_bounds(parameters);
    const double weight = brain_genes(parameters).initial;
    const GeneRange body = genes_of(GeneGroup::Body, parameters), brain = genes_of(GeneGroup::Brain, parameters),
                    free = genes_of(GeneGroup::Free, parameters);
    const FreeGeneOperators listed{parameters};
    GeneMatrix genes(gene_count(parameters), organism_count);
    for (std::uint32_t organism = 0; organism < organism_count; ++organism) {
        base::RandomStream random{key, organism};
        const Genes chromosome = column(genes, organism);
        const auto draw = [&](GeneRange group, double least, double most) {
            for (float& gene : part_of(chromosome, group)) {
                gene = static_cast<float>(random.uniform(least, most));
            }
        };
        draw(body, parameters.initial_gene_min, parameters.initial_gene_max);
        draw(brain, -weight, weight);
        draw(free, parameters.free_gene_min, parameters.free_gene_max);
        clamp(chromosome, bounds);
        listed.draw(chromosome, random);
    }
    if (parameters.free_gene_start == FreeGeneStart::LatinHypercube) {
        const base::RandomKey hypercube{seed, base::Purpose::FirstFreeGenes, island, 1};
        (listed.empty() ? FreeGeneOperators{with_list(parameters)} : listed).fill_latin_hypercube(genes, hypercube);
    }
    return genes;
}

} // namespace evod::evolution
