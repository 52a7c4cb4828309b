#include "server/evolution/crossover.h"

#include "server/base/assert.h"

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

std::optional<Mixture> Crossover::draw(base::RandomStream& random) const {
    if (method_ == CrossoverMethod::None || !chance_.draw(random)) {
        return {};
    }
    if (method_ == CrossoverMethod::Uniform) {
        return Mixture{.from_second = random.word() & all_genes};
    }
    if (method_ == CrossoverMethod::Blend) {
        return Mixture{.second_share = (random.word() + 0.5) * 0x1p-32};
    }
    return Mixture{.from_second = masks_[random.below(mask_count_)]};
}

} // namespace evod::evolution
