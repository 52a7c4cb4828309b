#include "server/evolution/crossover.h"

#include "server/base/assert.h"

#include <algorithm>
#include <bit>

namespace evod::evolution {
namespace {

int cut_count(const Parameters& parameters) {
    switch (parameters.crossover) {
    case CrossoverMethod::SinglePoint:
        return 1;
    case CrossoverMethod::MultiPoint:
        return static_cast<int>(parameters.crossover_cuts);
    case CrossoverMethod::Uniform:
    case CrossoverMethod::Blend:
    case CrossoverMethod::None:
        break;
    }
    return 0;
}

} // namespace

GeneMask mask_of_cuts(GeneMask cuts) {
    EVOD_ASSERT(cuts <= all_genes);
    GeneMask mask = 0, side = 0;
    for (unsigned gene = 0; gene < gene_count; ++gene) {
        side ^= cuts >> gene & 1;
        mask |= side << gene;
    }
    return mask;
}

Crossover::Crossover(const Parameters& parameters)
    : method_{parameters.crossover}, chance_{parameters.crossover_chance} {
    const int wanted = cut_count(parameters);
    if (wanted == 0) {
        return;
    }
    for (GeneMask cuts = 2; cuts <= all_genes; cuts += 2) { // even numbers only: bit 0 would be a cut before gene 0
        if (std::popcount(cuts) == wanted) {
            masks_.at(mask_count_++) = mask_of_cuts(cuts);
        }
    }
    EVOD_ASSERT(mask_count_ >= 1);
}

bool Crossover::draw(Mixture& mixture, base::RandomStream& random) const {
    if (method_ == CrossoverMethod::None || !chance_.draw(random)) {
        return false;
    }
    if (method_ == CrossoverMethod::Uniform) {
        mixture.from_second = random.word() & all_genes;
    } else if (method_ == CrossoverMethod::Blend) {
        const double weight = (random.word() + 0.5) * 0x1p-32;
        mixture = {.from_second = weight > 0.5 ? all_genes : 0, .second_share = std::min(weight, 1 - weight)};
    } else {
        mixture.from_second = masks_[random.below(mask_count_)];
    }
    return true;
}

void blend(ConstGenes first, ConstGenes second, double second_share, Genes child) {
    for (unsigned gene = 0; gene < gene_count; ++gene) {
        const double from = static_cast<double>(first[gene]);
        child[gene] = static_cast<float>(from + second_share * (static_cast<double>(second[gene]) - from));
    }
}

} // namespace evod::evolution
