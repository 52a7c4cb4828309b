#include "server/evolution/rearranging.h"

#include <algorithm>
#include <utility>

namespace evod::evolution {
namespace {

struct Slice {
    unsigned first, last; // first < last, both inclusive
};

Slice draw_slice(base::RandomStream& random) {
    const unsigned a = random.below(gene_count);
    const unsigned other = random.below(gene_count - 1);
    const unsigned b = other < a ? other : other + 1;
    return {std::min(a, b), std::max(a, b)};
}

template <class T>
void swap_pair(std::span<T, gene_count> genes, base::RandomStream& random) {
    const Slice pair = draw_slice(random);
    std::swap(genes[pair.first], genes[pair.last]);
}

} // namespace

RearrangingMutation::RearrangingMutation(const Parameters& parameters)
    : method_{parameters.rearranging}, chance_{parameters.rearrange_chance} {}

bool RearrangingMutation::apply(Genes genes, base::RandomStream& random) const {
    return rearrange(genes, random);
}

bool RearrangingMutation::apply(GeneOrder order, base::RandomStream& random) const {
    return rearrange(order, random);
}

template <class T>
bool RearrangingMutation::rearrange(std::span<T, gene_count> genes, base::RandomStream& random) const {
    if (is_off() || !chance_.draw(random)) {
        return false;
    }
    switch (method_) {
    case Rearranging::None:
        break;
    case Rearranging::Swap: {
        const bool twice = random.below(2) == 1;
        swap_pair(genes, random);
        if (twice) {
            swap_pair(genes, random);
        }
        break;
    }
    case Rearranging::Scramble: {
        const Slice slice = draw_slice(random);
        random.shuffle(std::span<T>{genes}.subspan(slice.first, slice.last - slice.first + 1));
        break;
    }
    case Rearranging::Inversion: {
        const Slice slice = draw_slice(random);
        std::reverse(genes.begin() + slice.first, genes.begin() + slice.last + 1);
        break;
    }
    }
    return true;
}

} // namespace evod::evolution
