#include "server/evolution/mutation.h"

#include "server/base/assert.h"
#include "server/base/elementary.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>

namespace evod::evolution {
namespace {

/// Draws a number that is uniform in (−1, 1), with mean 0 and variance 1/3, from one random word.
double symmetric_uniform(base::RandomStream& random) {
    return (random.word() + 0.5) * 0x1p-31 - 1;
}

/// Draws standard normal numbers, most of them from one word. The area under the density is covered by layers of equal
/// area. A point in the part of a layer that lies entirely under the density is accepted at once.
/// Source  Marsaglia & Tsang 2000, "The ziggurat method for generating random variables", with independent bits for
///         layer and position (Doornik 2005).
class Ziggurat {
  public:
    Ziggurat() {
        width_[0] = area / density(tail); // the lowest layer, including the tail
        width_[1] = tail;
        for (unsigned i = 2; i < layers; ++i) {
            width_[i] = std::sqrt(-2 * base::log(area / width_[i - 1] + density(width_[i - 1])));
        }
        width_[layers] = 0;
        for (unsigned i = 0; i < layers; ++i) {
            wholly_under_[i] = width_[i + 1] / width_[i];
        }
    }

    double draw(base::RandomStream& random) const {
        while (true) {
            const std::uint32_t word = random.word();
            const unsigned layer = word % layers;
            // The position in the layer, in (−1, 1), with 25 random bits.
            const double share = ((word / layers) + 0.5) * (2.0 * layers * 0x1p-32) - 1;
            const double x = share * width_[layer];
            if (std::abs(share) < wholly_under_[layer]) {
                return x;
            }
            if (layer == 0) {
                return std::copysign(draw_tail(random), x);
            }
            // The height of the point is uniform between the densities at the two edges of the layer.
            const double low = density(width_[layer]), high = density(width_[layer + 1]);
            if (low + random.uniform() * (high - low) < density(x)) {
                return x;
            }
        }
    }

  private:
    static constexpr unsigned layers = 128;
    static constexpr double tail = 3.442619855899, area = 9.91256303526217e-3; // for 128 layers

    static double density(double x) { return base::exp(-x * x / 2); } // without the constant factor

    /// Source  Marsaglia 1964, "Generating a variable from the tail of the normal distribution".
    static double draw_tail(base::RandomStream& random) {
        while (true) {
            const double beyond = -base::log(1 - random.uniform()) / tail; // 1 − [0, 1) is never 0
            if (-2 * base::log(1 - random.uniform()) >= beyond * beyond) {
                return tail + beyond;
            }
        }
    }

    std::array<double, layers + 1> width_;    // half the width of each layer, from the lowest up; decreasing
    std::array<double, layers> wholly_under_; // per layer: the share of the width that lies entirely under the density
};

double draw_normal(base::RandomStream& random) {
    static const Ziggurat ziggurat;
    return ziggurat.draw(random);
}

// Up to this probability of a flip it is cheaper to draw the distances between flipped bits than to draw for each bit.
constexpr double rare_flip_chance_max = 0.125;

constexpr unsigned genes_per_draw = 32; // genes for which one call of Chance::draw_bits() decides
constexpr unsigned genes_per_flips = 6; // genes for which one call of RareEvents::draw() decides

/// Calls `change` for every gene of the mask, in order.
template <class Change>
void for_each_gene(std::uint32_t mask, const Change& change) {
    for (; mask != 0; mask &= mask - 1) {
        change(static_cast<unsigned>(std::countr_zero(mask)));
    }
}

} // namespace

double creep_unit(Creep creep, base::RandomStream& random) {
    return creep == Creep::Uniform ? symmetric_uniform(random) : draw_normal(random);
}

double polynomial_creep(double value, double min, double max, double index, base::RandomStream& random) {
    if (!(min < max)) {
        return min;
    }
    const double within = std::clamp(value, min, max);
    const double uniform = random.uniform(), side = std::min(uniform, 1 - uniform);
    const double room = (uniform < 0.5 ? within - min : max - within) / (max - min);
    // side is uniform in [0, ½]; the cumulative probability of a step that goes no further than the bound.
    const double kept = base::pow(1 - room, index + 1);
    const double step = 1 - base::pow(2 * side + (1 - 2 * side) * kept, 1 / (index + 1));
    return within + (uniform < 0.5 ? -step : step) * (max - min);
}

double reflected(double value, double min, double max) {
    const double width = max - min;
    if (!(width > 0)) {
        return min;
    }
    const double beyond = std::abs(std::fmod(value - min, 2 * width)); // also if value < min: mirrored at min
    return min + std::min(beyond, 2 * width - beyond);
}

std::uint32_t BinaryView::to_code(float value) const {
    EVOD_ASSERT(value >= min);
    EVOD_ASSERT(value <= max);
    if (!(min < max)) {
        return 0;
    }
    const double share = (double{value} - min) / (double{max} - min);
    return static_cast<std::uint32_t>(share * ((1u << bits) - 1) + 0.5);
}

float BinaryView::to_value(std::uint32_t code) const {
    EVOD_ASSERT(code < 1u << bits);
    const double share = static_cast<double>(code) / ((1u << bits) - 1);
    return std::clamp(static_cast<float>(min + share * (double{max} - min)), min, max);
}

template <std::size_t extent>
ValueMutation<extent>::ValueMutation(const Parameters& parameters)
    : range_{unlisted_genes_of(parameters.mutate_group, parameters)}
    , bounds_{gene_bounds(parameters)}
    , creep_{parameters.creep}
    , creep_chance_{parameters.mutation_chance}
    , spread_index_{parameters.mutation_spread_index}
    , reset_chance_{parameters.reset_chance}
    , scale_chance_{parameters.scale_chance}
    , scale_range_{parameters.scale_range}
    , bit_flip_chance_{parameters.bit_flip_chance}
    , bits_{parameters.bit_flip_bits}
    , out_of_bounds_{parameters.out_of_bounds} {
    EVOD_ASSERT(bits_ >= 1);
    EVOD_ASSERT(bits_ <= 24);
    if constexpr (extent == std::dynamic_extent) {
        steps_.resize(gene_count(parameters));
    }
    const auto set_steps = [&](GeneGroup group, double step) {
        EVOD_ASSERT(step >= 0);
        std::ranges::fill(part_of(std::span{steps_}, genes_of(group, parameters)), step);
    };
    set_steps(GeneGroup::Body, parameters.mutation_step);
    if constexpr (extent == std::dynamic_extent) {
        set_steps(GeneGroup::Brain, parameters.brain_mutation_step);
        set_steps(GeneGroup::Free, parameters.free_mutation_step);
    }
    if (!bit_flip_chance_.is_never() && parameters.bit_flip_chance <= rare_flip_chance_max) {
        rare_flips_.emplace(genes_per_flips * bits_, parameters.bit_flip_chance);
    }
}

unsigned clamp(Genes genes, const GeneBounds& bounds, std::vector<GeneChange>& changes) {
    const std::vector<float> before(genes.begin(), genes.end());
    const unsigned clamped = clamp(genes, bounds);
    for (unsigned gene = 0; gene < genes.size(); ++gene) {
        if (genes[gene] != before[gene]) {
            changes.push_back({gene, ChangeKind::Clamp, before[gene], genes[gene]});
        }
    }
    return clamped;
}

template <std::size_t extent>
unsigned ValueMutation<extent>::apply(std::span<float, extent> genes, base::RandomStream& random) const {
    return mutate(genes, random, SetGene{genes}, [&] { return clamp(genes, bounds_); });
}

template <std::size_t extent>
unsigned ValueMutation<extent>::apply(std::span<float, extent> genes, base::RandomStream& random,
                                      std::vector<GeneChange>& changes) const requires(extent == std::dynamic_extent) {
    return mutate(genes, random, RecordGene{genes, changes}, [&] { return clamp(genes, bounds_, changes); });
}

template <std::size_t extent>
template <class Change, class Clamp>
unsigned ValueMutation<extent>::mutate(std::span<const float, extent> genes, base::RandomStream& random,
                                       const Change& change, const Clamp& clamp_all) const {
    const unsigned end = range().first + range().count;
    // Calls change_gene for every gene of the range with the given chance, in order.
    const auto change_each = [&](const Chance& chance, const auto& change_gene) {
        for (unsigned first = range().first; first < end; first += genes_per_draw) {
            const std::uint32_t changing = chance.draw_bits(std::min(genes_per_draw, end - first), random);
            for_each_gene(changing, [&](unsigned i) { change_gene(first + i); });
        }
    };
    if (!creep_chance_.is_never()) {
        change_each(creep_chance_,
                    [&](unsigned gene) { change(gene, ChangeKind::Creep, crept(genes[gene], gene, random)); });
    }
    if (!reset_chance_.is_never()) {
        change_each(reset_chance_, [&](unsigned gene) {
            change(gene, ChangeKind::Reset, static_cast<float>(random.uniform(bounds_.min[gene], bounds_.max[gene])));
        });
    }
    if (!scale_chance_.is_never() && range().count > 0) {
        if (const std::optional<GeneChange> scaled = draw_scale(genes, random)) {
            change(scaled->gene, scaled->kind, scaled->after);
        }
    }
    const unsigned outside = out_of_bounds_ == OutOfBounds::Clamp ? clamp_all() : bring_back(genes, random, change);
    if (!bit_flip_chance_.is_never()) {
        for (unsigned first = range().first; first < end; first += genes_per_flips) {
            flip_bits(genes, {first, std::min(genes_per_flips, end - first)}, random, change);
        }
    }
    return outside;
}

template <std::size_t extent>
float ValueMutation<extent>::crept(float value, unsigned gene, base::RandomStream& random) const {
    if (creep_ == Creep::Polynomial) {
        return static_cast<float>(polynomial_creep(double{value}, double{bounds_.min[gene]}, double{bounds_.max[gene]},
                                                   spread_index_, random));
    }
    return static_cast<float>(value + steps_[gene] * creep_unit(creep_, random));
}

template <std::size_t extent>
template <class Change>
unsigned ValueMutation<extent>::bring_back(std::span<const float, extent> genes, base::RandomStream& random,
                                           const Change& change) const {
    unsigned outside = 0;
    for (unsigned gene = 0; gene < genes.size(); ++gene) {
        const float min = bounds_.min[gene], max = bounds_.max[gene];
        if (genes[gene] >= min && genes[gene] <= max) {
            continue;
        }
        ++outside;
        const bool reflects = out_of_bounds_ == OutOfBounds::Reflect;
        const double value = reflects ? reflected(double{genes[gene]}, double{min}, double{max})
                                      : random.uniform(double{min}, double{max});
        change(gene, reflects ? ChangeKind::Reflect : ChangeKind::Redraw,
               std::clamp(static_cast<float>(value), min, max));
    }
    return outside;
}

template <std::size_t extent>
std::optional<GeneChange> ValueMutation<extent>::draw_scale(std::span<const float, extent> genes,
                                                            base::RandomStream& random) const {
    if (!scale_chance_.draw(random)) {
        return std::nullopt;
    }
    const unsigned gene = range().first + random.below(range().count);
    const double factor = 1 + scale_range_ * symmetric_uniform(random);
    const float before = genes[gene];
    return GeneChange{gene, ChangeKind::Scale, before, static_cast<float>(static_cast<double>(before) * factor)};
}

template <std::size_t extent>
template <class Change>
void ValueMutation<extent>::flip_bits(std::span<const float, extent> genes, GeneRange block, base::RandomStream& random,
                                      const Change& change) const {
    std::array<std::uint32_t, genes_per_flips> flips{};
    if (rare_flips_) {
        // Divides by bits_ without a division. The result is exact because there are few trials: the error of the
        // reciprocal adds up to less than 2^16. Trials beyond the genes of the block have no effect.
        const unsigned reciprocal = (1u << 16) / bits_ + 1;
        rare_flips_->draw(random, [&](unsigned trial) {
            const unsigned gene = trial * reciprocal >> 16;
            flips[gene] |= 1u << (trial - gene * bits_);
        });
    } else {
        for (unsigned i = 0; i < block.count; ++i) {
            flips[i] = bit_flip_chance_.draw_bits(bits_, random);
        }
    }
    for (unsigned i = 0; i < block.count; ++i) {
        if (flips[i] != 0) {
            const unsigned gene = block.first + i;
            const BinaryView view{bounds_.min[gene], bounds_.max[gene], bits_};
            change(gene, ChangeKind::BitFlip, view.to_value(view.to_code(genes[gene]) ^ flips[i]));
        }
    }
}

template class ValueMutation<body_gene_count>;
template class ValueMutation<>;

} // namespace evod::evolution
