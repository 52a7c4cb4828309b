#include "server/evolution/crossover.h"

#include "server/base/assert.h"
#include "server/base/elementary.h"

#include <algorithm>
#include <cmath>

namespace evod::evolution {
namespace {

// The masks of all sets of cuts are computed once if there are at most this many.
constexpr std::uint64_t kept_masks_max = 16;

unsigned cut_count(const Parameters& parameters) {
    switch (parameters.crossover) {
    case CrossoverMethod::SinglePoint:
        return 1;
    case CrossoverMethod::MultiPoint:
        return parameters.crossover_cuts;
    case CrossoverMethod::Uniform:
    case CrossoverMethod::Blend:
    case CrossoverMethod::None:
    case CrossoverMethod::SimulatedBinary:
        break;
    }
    return 0;
}

/// Returns the number of sets of `chosen` out of `count` elements. For the numbers of genes and cuts that the
/// parameters allow, it is below 2^53.
std::uint64_t set_count(std::uint64_t count, std::uint64_t chosen) {
    std::uint64_t sets = 1;
    for (std::uint64_t i = 0; i < chosen; ++i) {
        sets = count > i ? sets * (count - i) / (i + 1) : 0;
    }
    return sets;
}

std::uint64_t draw_below(std::uint64_t bound, base::RandomStream& random) {
    if (bound <= ~std::uint32_t{0}) {
        return random.below(static_cast<std::uint32_t>(bound));
    }
    const std::uint64_t fair_end = ~std::uint64_t{0} / bound * bound; // a multiple of the bound
    while (true) {
        if (const std::uint64_t word = random.long_word(); word < fair_end) {
            return word % bound;
        }
    }
}

/// Bits of a word of Mixture::spreads: whether the gene is spread, and whether it comes from the second parent. The
/// other bits are those of the uniform number.
constexpr std::uint32_t is_spread = 1, is_swapped = 2;

/// Returns β of a child whose bound is `room` beyond the parent, relative to the distance of the parents: its
/// cumulative probability is `uniform` if the distribution is cut off at the bound.
double spread_factor(double uniform, double room, double index) {
    const double mass =
        2 - base::pow(1 + 2 * room, -(index + 1)); // twice the probability of the values within the bound
    const double doubled = uniform * mass;
    return base::pow(doubled <= 1 ? doubled : 1 / (2 - doubled), 1 / (index + 1));
}

} // namespace

template <std::size_t extent>
Crossover<extent>::Crossover(const Parameters& parameters, unsigned gene_count)
    : method_{parameters.crossover}
    , chance_{parameters.crossover_chance}
    , gene_count_{gene_count}
    , cut_count_{std::min(cut_count(parameters), gene_count - 1)} {
    cut_set_count_ = set_count(gene_count - 1, cut_count_);
    EVOD_ASSERT(cut_set_count_ >= 1);
    for (std::uint64_t index = 0; index < cut_set_count_ && cut_set_count_ <= kept_masks_max; ++index) {
        masks_.push_back(mask_of_cuts(index));
    }
}

// Source  the combinatorial number system: Knuth 2005, The Art of Computer Programming 4A, 7.2.1.3, theorem L.
template <std::size_t extent>
GeneMask<extent> Crossover<extent>::mask_of_cuts(std::uint64_t index) const {
    GeneMask<extent> mask{gene_count_};
    unsigned end = gene_count_; // the remaining cuts are before genes 1 … end − 1
    for (unsigned left = cut_count_; left > 0; --left) {
        unsigned last =
            left; // binary search for the last of these genes such that the sets of cuts before it are not enough
        while (last + 1 < end) {
            const unsigned middle = last + (end - last) / 2;
            (set_count(middle - 1, left) <= index ? last : end) = middle;
        }
        index -= set_count(last - 1, left);
        mask.flip_from(last);
        end = last;
    }
    return mask;
}

template <std::size_t extent>
bool Crossover<extent>::draw(Mixture<extent>& mixture, base::RandomStream& random) const {
    if (method_ == CrossoverMethod::None || !chance_.draw(random)) {
        return false;
    }
    if (method_ == CrossoverMethod::Uniform) {
        mixture.from_second.assign([&] { return random.word(); });
    } else if (method_ == CrossoverMethod::Blend) {
        const double weight = (random.word() + 0.5) * 0x1p-32;
        mixture.second_share = std::min(weight, 1 - weight);
        if (weight > 0.5) {
            mixture.from_second.complement();
        }
    } else if (method_ == CrossoverMethod::SimulatedBinary) {
        auto& words = mixture.spreads.emplace();
        if constexpr (extent == std::dynamic_extent) {
            words.resize(gene_count_);
        }
        for (std::uint32_t& word : words) {
            word = random.word();
        }
        unsigned gene = 0;
        mixture.from_second.assign([&] {
            std::uint32_t swapped = 0;
            const unsigned end = std::min<unsigned>(gene + GeneMask<extent>::word_bits, gene_count_);
            for (unsigned bit = 0; gene < end; ++gene, ++bit) {
                const bool both = (words[gene] & is_spread) != 0 && (words[gene] & is_swapped) != 0;
                swapped |= std::uint32_t{both} << bit;
            }
            return swapped;
        });
    } else {
        const std::uint64_t index = draw_below(cut_set_count_, random);
        mixture.from_second = masks_.empty() ? mask_of_cuts(index) : masks_[index];
    }
    return true;
}

template class Crossover<body_gene_count>;
template class Crossover<>;

template <std::size_t extent>
void blend(std::span<const float, extent> first, std::span<const float, extent> second, double second_share,
           std::span<float, extent> child) {
    for (unsigned gene = 0; gene < child.size(); ++gene) {
        const double from = static_cast<double>(first[gene]);
        child[gene] = static_cast<float>(from + second_share * (static_cast<double>(second[gene]) - from));
    }
}
template void blend(std::span<const float, body_gene_count>, std::span<const float, body_gene_count>, double,
                    std::span<float, body_gene_count>);
template void blend(ConstGenes, ConstGenes, double, Genes);

double spread_position(double near, double far, std::uint32_t word, double min, double max, double index) {
    if ((word & is_spread) == 0 || near == far) {
        return near;
    }
    const double uniform = ((word / 4) + 0.5) * 0x1p-30;
    const double distance = std::abs(near - far), room = near < far ? near - min : max - near;
    return (near + far) / 2 + (near - far) / 2 * spread_factor(uniform, room / distance, index);
}

void cross_order(ConstGenes near, ConstGenes far, Slice slice, Genes child) {
    const auto count = static_cast<unsigned>(near.size());
    std::vector<bool> taken(count);
    for (unsigned place = slice.first; place <= slice.last; ++place) {
        child[place] = near[place];
        taken[static_cast<std::size_t>(near[place])] = true;
    }
    unsigned place = slice.last + 1;
    for (unsigned i = 0; i < count; ++i) {
        const float element = far[(slice.last + 1 + i) % count];
        if (!taken[static_cast<std::size_t>(element)]) {
            child[place++ % count] = element;
        }
    }
}

template <std::size_t extent>
void spread(std::span<const float, extent> first, std::span<const float, extent> second,
            const GeneMask<extent>& from_second, const PerGene<std::uint32_t, extent>& words, const GeneBounds& bounds,
            double index, std::span<float, extent> child) {
    for (unsigned gene = 0; gene < child.size(); ++gene) {
        const float same = from_second.contains(gene) ? second[gene] : first[gene],
                    other = from_second.contains(gene) ? first[gene] : second[gene];
        const double min = double{bounds.min[gene]}, max = double{bounds.max[gene]};
        const double near = std::clamp(double{same}, min, max), far = std::clamp(double{other}, min, max);
        const double spread = spread_position(near, far, words[gene], min, max, index);
        child[gene] =
            spread == near ? same : std::clamp(static_cast<float>(spread), bounds.min[gene], bounds.max[gene]);
    }
}
template void spread(std::span<const float, body_gene_count>, std::span<const float, body_gene_count>,
                     const GeneMask<body_gene_count>&, const PerGene<std::uint32_t, body_gene_count>&,
                     const GeneBounds&, double, std::span<float, body_gene_count>);
template void spread(ConstGenes, ConstGenes, const GeneMask<>&, const PerGene<std::uint32_t, std::dynamic_extent>&,
                     const GeneBounds&, double, Genes);

} // namespace evod::evolution
