#include "server/evolution/chromosome.h"

#include "server/base/assert.h"

namespace evod::evolution {

GeneBounds gene_bounds(const Parameters& parameters) {
    const double min[gene_count] = {parameters.normal_speed_min, parameters.impulse_min,
                                    parameters.body_size_min,    parameters.base_health_min,
                                    parameters.food_radius_min,  parameters.poison_radius_min};
    const double max[gene_count] = {parameters.normal_speed_max, parameters.impulse_max,
                                    parameters.body_size_max,    parameters.base_health_max,
                                    parameters.food_radius_max,  parameters.poison_radius_max};
    GeneBounds bounds;
    for (unsigned gene = 0; gene < gene_count; ++gene) {
        EVOD_ASSERT(min[gene] <= max[gene]);
        bounds.min[gene] = static_cast<float>(min[gene]);
        bounds.max[gene] = static_cast<float>(max[gene]);
    }
    return bounds;
}

unsigned clamp(Genes genes, const GeneBounds& bounds) {
    unsigned clamped = 0;
    for (unsigned gene = 0; gene < gene_count; ++gene) {
        const float value = genes[gene];
        const bool below = value < bounds.min[gene];
        const bool above = value > bounds.max[gene];
        genes[gene] = below ? bounds.min[gene] : above ? bounds.max[gene] : value;
        clamped += below || above;
    }
    return clamped;
}

GeneMatrix initial_population(std::uint32_t organism_count, const Parameters& parameters, base::Seed seed,
                              std::uint32_t island) {
    EVOD_ASSERT(parameters.initial_gene_min <= parameters.initial_gene_max);
    const base::RandomKey key{seed, base::Purpose::InitialChromosome, island, 1};
    const GeneBounds bounds = gene_bounds(parameters);
    GeneMatrix genes(gene_count, organism_count);
    for (std::uint32_t organism = 0; organism < organism_count; ++organism) {
        base::RandomStream random{key, organism};
        for (float& gene : column(genes, organism)) {
            gene = static_cast<float>(random.uniform(parameters.initial_gene_min, parameters.initial_gene_max));
        }
        clamp(column(genes, organism), bounds);
    }
    return genes;
}

} // namespace evod::evolution
