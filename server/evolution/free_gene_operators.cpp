#include "server/evolution/free_gene_operators.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace evod::evolution {
namespace {

using Kind = FreeGene::Kind;

/// The positions that count as those of a gene: with steps, half a step more at each end, so that rounding gives every
/// value the same share.
struct Span {
    double low, high;
};
Span span_of(const GeneValues& values) {
    const double half = values.count() > 0 ? 0.5 : 0;
    return {values.first() - half, values.last() + half};
}

} // namespace

FreeGeneOperators::FreeGeneOperators(const Parameters& parameters)
    : mutates_{parameters.mutate_group == GeneGroup::All || parameters.mutate_group == GeneGroup::Free}
    , creep_{parameters.creep}
    , share_{parameters.free_mutation_step}
    , spread_index_{parameters.mutation_spread_index}
    , scale_range_{parameters.scale_range}
    , crossover_index_{parameters.crossover_spread_index}
    , creep_chance_{parameters.mutation_chance}
    , reset_chance_{parameters.reset_chance}
    , scale_chance_{parameters.scale_chance}
    , bit_flip_chance_{parameters.bit_flip_chance}
    , bits_{parameters.bit_flip_bits}
    , out_of_bounds_{parameters.out_of_bounds} {
    unsigned first = genes_of(GeneGroup::Free, parameters).first;
    for (const FreeGene& gene : parameters.listed_genes.list()) {
        entries_.push_back({gene.kind, GeneValues{gene}, first, gene.count});
        first += gene.count;
    }
}

void FreeGeneOperators::draw_slices(Mixture<>& mixture, base::RandomStream& random) const {
    for (const Entry& entry : entries_) {
        if (entry.kind == Kind::Permutation) {
            mixture.slices.push_back(draw_slice(entry.count, random));
        }
    }
}

void FreeGeneOperators::cross(ConstGenes first, ConstGenes second, const GeneMask<>& from_second,
                              const Mixture<>& mixture, Genes child) const {
    auto slice = mixture.slices.begin();
    for (const Entry& entry : entries_) {
        const bool swapped = from_second.contains(entry.first);
        const ConstGenes near = swapped ? second : first, far = swapped ? first : second;
        const unsigned gene = entry.first;
        if (entry.kind == Kind::Permutation && slice == mixture.slices.end()) {
            std::ranges::copy(near.subspan(gene, entry.count), child.subspan(gene).begin());
        } else if (entry.kind == Kind::Permutation) {
            cross_order(near.subspan(gene, entry.count), far.subspan(gene, entry.count), *slice++,
                        child.subspan(gene, entry.count));
        } else if (entry.kind == Kind::Choice || (!mixture.spreads && mixture.second_share == 0)) {
            child[gene] = near[gene];
        } else {
            const double a = entry.values.position_of(near[gene]), b = entry.values.position_of(far[gene]);
            const double position = mixture.spreads
                                        ? spread_position(a, b, (*mixture.spreads)[gene], entry.values.first(),
                                                          entry.values.last(), crossover_index_)
                                        : entry.values.position_of(first[gene]) +
                                              mixture.second_share * (entry.values.position_of(second[gene]) -
                                                                      entry.values.position_of(first[gene]));
            child[gene] = position == a ? near[gene] : entry.values.to_value(position);
        }
    }
}

double FreeGeneOperators::crept(const Entry& entry, double position, base::RandomStream& random) const {
    const GeneValues& values = entry.values;
    if (entry.kind == Kind::Choice) {
        const std::uint32_t other = random.below(values.count() - 1);
        return other < position ? other : other + 1.0;
    }
    const auto [low, high] = span_of(values);
    const double moved = creep_ == Creep::Polynomial ? polynomial_creep(position, low, high, spread_index_, random)
                                                     : position + values.creep(share_) * creep_unit(creep_, random);
    if (values.count() == 0) {
        return moved;
    }
    const double whole = std::nearbyint(moved);
    return whole != position || moved == position ? whole : position + (moved < position ? -1 : 1);
}

double FreeGeneOperators::redrawn(const Entry& entry, base::RandomStream& random) const {
    return entry.values.count() > 0 ? random.below(entry.values.count())
                                    : random.uniform(entry.values.first(), entry.values.last());
}

template <class Change>
unsigned FreeGeneOperators::mutate(ConstGenes genes, base::RandomStream& random, const Change& change) const {
    if (!mutates_) {
        return 0;
    }
    unsigned outside = 0;
    for (const Entry& entry : entries_) {
        if (entry.kind == Kind::Permutation) {
            continue;
        }
        const unsigned gene = entry.first;
        const GeneValues& values = entry.values;
        const auto move_to = [&](double position, ChangeKind kind) {
            const auto [low, high] = span_of(values);
            if (position < low || position > high) {
                ++outside;
                position = out_of_bounds_ == OutOfBounds::Clamp     ? std::clamp(position, low, high)
                           : out_of_bounds_ == OutOfBounds::Reflect ? reflected(position, low, high)
                                                                    : redrawn(entry, random);
            }
            change(gene, kind, values.to_value(position));
        };
        if (creep_chance_.draw(random)) {
            move_to(crept(entry, values.position_of(genes[gene]), random), ChangeKind::Creep);
        }
        if (reset_chance_.draw(random)) {
            move_to(redrawn(entry, random), ChangeKind::Reset);
        }
        if (entry.kind == Kind::Number && scale_chance_.draw(random)) {
            const double factor = 1 + scale_range_ * creep_unit(Creep::Uniform, random);
            move_to(values.position_of(static_cast<float>(double{genes[gene]} * factor)), ChangeKind::Scale);
        }
        if (const std::uint32_t flips = bit_flip_chance_.draw_bits(bits_, random); flips != 0) {
            const BinaryView view{values.min(), values.max(), bits_};
            move_to(values.position_of(view.to_value(view.to_code(genes[gene]) ^ flips)), ChangeKind::BitFlip);
        }
    }
    return outside;
}
template unsigned FreeGeneOperators::mutate(ConstGenes, base::RandomStream&, const SetGene&) const;
template unsigned FreeGeneOperators::mutate(ConstGenes, base::RandomStream&, const RecordGene&) const;

template <class T>
bool FreeGeneOperators::rearrange(const OrderMutation& by, std::span<T> items, base::RandomStream& random) const {
    bool changed = false;
    for (const Entry& entry : entries_) {
        if (entry.kind == Kind::Permutation && mutates_) {
            changed |= by.apply_to(items.subspan(entry.first, entry.count), random);
        }
    }
    return changed;
}
template bool FreeGeneOperators::rearrange(const OrderMutation&, std::span<float>, base::RandomStream&) const;
template bool FreeGeneOperators::rearrange(const OrderMutation&, std::span<std::uint32_t>, base::RandomStream&) const;

void FreeGeneOperators::draw(Genes genes, base::RandomStream& random) const {
    for (const Entry& entry : entries_) {
        if (entry.kind == Kind::Permutation) {
            const Genes order = genes.subspan(entry.first, entry.count);
            std::iota(order.begin(), order.end(), 0.0f);
            random.shuffle(order);
        } else {
            genes[entry.first] = entry.values.to_value(redrawn(entry, random));
        }
    }
}

void FreeGeneOperators::fill_latin_hypercube(GeneMatrix& genes, const base::RandomKey& key) const {
    const auto organisms = static_cast<std::uint32_t>(genes.cols());
    std::vector<std::uint32_t> parts(organisms);
    for (const Entry& entry : entries_) {
        if (entry.kind == Kind::Permutation) {
            continue;
        }
        base::RandomStream random{key, entry.first};
        std::iota(parts.begin(), parts.end(), 0u);
        random.shuffle(std::span{parts});
        const auto [low, high] = span_of(entry.values);
        for (std::uint32_t organism = 0; organism < organisms; ++organism) {
            const double share = (parts[organism] + random.uniform()) / organisms;
            genes(entry.first, organism) = entry.values.to_value(low + share * (high - low));
        }
    }
}

std::optional<unsigned> FreeGeneOperators::first_fault(ConstGenes genes) const {
    for (const Entry& entry : entries_) {
        std::vector<bool> seen(entry.count);
        for (unsigned gene = entry.first; gene < entry.first + entry.count; ++gene) {
            if (!entry.values.contains(genes[gene])) {
                return gene;
            }
            if (entry.kind == Kind::Permutation) {
                const auto element = static_cast<std::size_t>(genes[gene]);
                if (seen[element]) {
                    return gene;
                }
                seen[element] = true;
            }
        }
    }
    return std::nullopt;
}

} // namespace evod::evolution
