#include "server/evolution/order_mutation.h"

#include <algorithm>
#include <utility>

namespace evod::evolution {
namespace {

struct Slice {
    unsigned first, last; // first < last, both inclusive
};

Slice draw_slice(unsigned gene_count, base::RandomStream& random) {
    const unsigned a = random.below(gene_count);
    const unsigned other = random.below(gene_count - 1);
    const unsigned b = other < a ? other : other + 1;
    return {std::min(a, b), std::max(a, b)};
}

template <class T, std::size_t extent>
void swap_pair(std::span<T, extent> genes, base::RandomStream& random) {
    const Slice pair = draw_slice(static_cast<unsigned>(genes.size()), random);
    std::swap(genes[pair.first], genes[pair.last]);
}

} // namespace

OrderMutation::OrderMutation(const Parameters& parameters)
    : method_{parameters.rearranging}
    , chance_{parameters.rearrange_chance}
    , range_{genes_of(parameters.mutate_group, parameters)} {}

template <class T, std::size_t extent>
bool OrderMutation::apply(std::span<T, extent> items, base::RandomStream& random) const {
    const std::span<T, extent> genes = part_of(items, range_);
    if (is_off() || genes.size() < 2 || !chance_.draw(random)) {
        return false;
    }
    const auto gene_count = static_cast<unsigned>(genes.size());
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
        const Slice slice = draw_slice(gene_count, random);
        random.shuffle(std::span<T>{genes}.subspan(slice.first, slice.last - slice.first + 1));
        break;
    }
    case OrderMutationMethod::Inversion: {
        const Slice slice = draw_slice(gene_count, random);
        std::reverse(genes.begin() + slice.first, genes.begin() + slice.last + 1);
        break;
    }
    }
    return true;
}
template bool OrderMutation::apply(std::span<float, body_gene_count>, base::RandomStream&) const;
template bool OrderMutation::apply(Genes, base::RandomStream&) const;
template bool OrderMutation::apply(std::span<std::uint32_t>, base::RandomStream&) const;

} // namespace evod::evolution
