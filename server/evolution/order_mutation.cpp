#include "server/evolution/order_mutation.h"

#include <algorithm>
#include <utility>

namespace evod::evolution {
namespace {

template <class T, std::size_t extent>
void swap_pair(std::span<T, extent> genes, base::RandomStream& random) {
    const Slice pair = draw_slice(static_cast<unsigned>(genes.size()), random);
    std::swap(genes[pair.first], genes[pair.last]);
}

} // namespace

Slice draw_slice(unsigned gene_count, base::RandomStream& random) {
    const unsigned a = random.below(gene_count);
    const unsigned other = random.below(gene_count - 1);
    const unsigned b = other < a ? other : other + 1;
    return {std::min(a, b), std::max(a, b)};
}

OrderMutation::OrderMutation(const Parameters& parameters)
    : method_{parameters.rearranging}
    , chance_{parameters.rearrange_chance}
    , range_{unlisted_genes_of(parameters.mutate_group, parameters)} {}

template <class T, std::size_t extent>
bool OrderMutation::apply(std::span<T, extent> items, base::RandomStream& random) const {
    return apply_to(part_of(items, range_), random);
}

template <class T, std::size_t extent>
bool OrderMutation::apply_to(std::span<T, extent> genes, base::RandomStream& random) const {
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
template bool OrderMutation::apply_to(Genes, base::RandomStream&) const;
template bool OrderMutation::apply_to(std::span<std::uint32_t>, base::RandomStream&) const;

} // namespace evod::evolution
