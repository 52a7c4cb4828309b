#include "server/evolution/next_generation.h"

#include "server/base/assert.h"
#include "server/evolution/breeding_loops.h"

namespace evod::evolution {
NextGeneration next_generation(std::span<const double> fitness, const GeneMatrix& genes, const Parameters& parameters,
                               std::uint32_t wanted, const BreedingKey& key, base::Executor& executor) {
    EVOD_ASSERT(!fitness.empty());
    EVOD_ASSERT(genes.cols() == static_cast<Eigen::Index>(fitness.size()));
    EVOD_ASSERT(wanted >= 1);
    Ranking ranking{fitness, executor};
    const Choice choice = choose(ranking, parameters, wanted, key, executor);
    const Places& places = choice.places;

    NextGeneration next{.genes = GeneMatrix(genes.rows(), wanted),
                        .parents = std::vector<Parents>(wanted),
                        .elite_count = places.elite,
                        .survivor_count = places.survivors,
                        .clamped_count = 0};
    if (genes.rows() == body_gene_count && parameters.free_genes == 0) {
        fill<body_gene_count>(next, choice, genes, parameters, key, executor);
    } else {
        fill_wide(next, choice, genes, parameters, key, executor);
    }
    return next;
}

} // namespace evod::evolution
