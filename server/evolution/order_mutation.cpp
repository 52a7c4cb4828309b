#include "server/evolution/order_mutation.h"

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

OrderMutation::OrderMutation(const Parameters& parameters)
    : method_{parameters.rearranging}, chance_{parameters.rearrange_chance} {}

bool OrderMutation::apply(Genes genes, base::RandomStream& random) const {
    return mutate_order(genes, random);
}

bool OrderMutation::apply(GeneOrder order, base::RandomStream& random) const {
    return mutate_order(order, random);
}

template <class T>
bool OrderMutation::mutate_order(std::span<T, gene_count> genes, base::RandomStream& random) const {
    if (is_off() || !chance_.draw(random)) {
        return false;
    }
    switch (method_) {
    case OrderMutationMethod::None:
        break;
    case OrderMutationMethod::Swap: {
        const bool twice = random.below(2) == 1;
        swap_pair(genes, random);
        if (twice) {
            swap_pair(genes, random);
        }
        break;
    }
    case OrderMutationMethod::Scramble: {
        const Slice slice = draw_slice(random);
        random.shuffle(std::span<T>{genes}.subspan(slice.first, slice.last - slice.first + 1));
        break;
    }
    case OrderMutationMethod::Inversion: {
        const Slice slice = draw_slice(random);
        std::reverse(genes.begin() + slice.first, genes.begin() + slice.last + 1);
        break;
    }
    }
    return true;
}

} // namespace evod::evolution
