#include "server/evolution/breeding_loops.h"

namespace evod::evolution {

void fill_wide(NextGeneration& next, const Choice& choice, const GeneMatrix& genes, const Parameters& parameters,
               const BreedingKey& key, base::Executor& executor) {
    fill<std::dynamic_extent>(next, choice, genes, parameters, key, executor);
}

} // namespace evod::evolution
