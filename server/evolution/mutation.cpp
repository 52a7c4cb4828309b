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

/// Calls `change` for every gene of the mask, in order.
template <class Change>
void for_each_gene(std::uint32_t mask, const Change& change) {
    for (; mask != 0; mask &= mask - 1) {
        change(static_cast<unsigned>(std::countr_zero(mask)));
    }
}

} // namespace

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

ValueMutation::ValueMutation(const Parameters& parameters)
    : bounds_{gene_bounds(parameters)}
    , creep_{parameters.creep}
    , creep_chance_{parameters.mutation_chance}
    , step_{parameters.mutation_step}
    , reset_chance_{parameters.reset_chance}
    , scale_chance_{parameters.scale_chance}
    , scale_range_{parameters.scale_range}
    , bit_flip_chance_{parameters.bit_flip_chance}
    , bits_{parameters.bit_flip_bits} {
    EVOD_ASSERT(bits_ >= 1);
    EVOD_ASSERT(bits_ <= 24);
    EVOD_ASSERT(step_ >= 0);
    if (!bit_flip_chance_.is_never() && parameters.bit_flip_chance <= rare_flip_chance_max) {
        rare_flips_.emplace(gene_count * bits_, parameters.bit_flip_chance);
    }
}

unsigned clamp(Genes genes, const GeneBounds& bounds, std::vector<GeneChange>& changes) {
    std::array<float, gene_count> before;
    std::ranges::copy(genes, before.begin());
    const unsigned clamped = clamp(genes, bounds);
    for (unsigned gene = 0; gene < gene_count; ++gene) {
        if (genes[gene] != before[gene]) {
            changes.push_back({gene, ChangeKind::Clamp, before[gene], genes[gene]});
        }
    }
    return clamped;
}

unsigned ValueMutation::apply(Genes genes, base::RandomStream& random) const {
    return mutate(
        genes, random, [&](unsigned gene, ChangeKind, float value) { genes[gene] = value; },
        [&] { return clamp(genes, bounds_); });
}

unsigned ValueMutation::apply(Genes genes, base::RandomStream& random, std::vector<GeneChange>& changes) const {
    return mutate(
        genes, random,
        [&](unsigned gene, ChangeKind kind, float value) {
            changes.push_back({gene, kind, genes[gene], value});
            genes[gene] = value;
        },
        [&] { return clamp(genes, bounds_, changes); });
}

template <class Change, class Clamp>
unsigned ValueMutation::mutate(ConstGenes genes, base::RandomStream& random, const Change& change,
                               const Clamp& clamp_all) const {
    if (!creep_chance_.is_never()) {
        for_each_gene(creep_chance_.draw_bits(gene_count, random), [&](unsigned gene) {
            const double unit = creep_ == Creep::Uniform ? symmetric_uniform(random) : draw_normal(random);
            change(gene, ChangeKind::Creep, static_cast<float>(genes[gene] + step_ * unit));
        });
    }
    if (!reset_chance_.is_never()) {
        for_each_gene(reset_chance_.draw_bits(gene_count, random), [&](unsigned gene) {
            change(gene, ChangeKind::Reset, static_cast<float>(random.uniform(bounds_.min[gene], bounds_.max[gene])));
        });
    }
    if (!scale_chance_.is_never()) {
        if (const std::optional<GeneChange> scaled = draw_scale(genes, random)) {
            change(scaled->gene, scaled->kind, scaled->after);
        }
    }
    const unsigned clamped = clamp_all();
    if (!bit_flip_chance_.is_never()) {
        flip_bits(genes, random, change);
    }
    return clamped;
}

std::optional<GeneChange> ValueMutation::draw_scale(ConstGenes genes, base::RandomStream& random) const {
    if (!scale_chance_.draw(random)) {
        return std::nullopt;
    }
    const unsigned gene = random.below(gene_count);
    const double factor = 1 + scale_range_ * symmetric_uniform(random);
    const float before = genes[gene];
    return GeneChange{gene, ChangeKind::Scale, before, static_cast<float>(static_cast<double>(before) * factor)};
}

template <class Change>
void ValueMutation::flip_bits(ConstGenes genes, base::RandomStream& random, const Change& change) const {
    std::array<std::uint32_t, gene_count> flips{};
    if (rare_flips_) {
        // Divides by bits_ without a division. The result is exact because there are few trials: the error of the
        // reciprocal adds up to less than 2^16.
        const unsigned reciprocal = (1u << 16) / bits_ + 1;
        rare_flips_->draw(random, [&](unsigned trial) {
            const unsigned gene = trial * reciprocal >> 16;
            flips[gene] |= 1u << (trial - gene * bits_);
        });
    } else {
        for (std::uint32_t& flipped : flips) {
            flipped = bit_flip_chance_.draw_bits(bits_, random);
        }
    }
    for (unsigned gene = 0; gene < gene_count; ++gene) {
        if (flips[gene] != 0) {
            const BinaryView view{bounds_.min[gene], bounds_.max[gene], bits_};
            change(gene, ChangeKind::BitFlip, view.to_value(view.to_code(genes[gene]) ^ flips[gene]));
        }
    }
}

} // namespace evod::evolution
