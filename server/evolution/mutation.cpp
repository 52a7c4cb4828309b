#include "server/evolution/mutation.h"

#include "server/base/elementary.h"

#include <algorithm>
#include <bit>
#include <cmath>

namespace evod::evolution {
namespace {

/// Uniform in (−1, 1), symmetric, with mean 0 and variance 1/3; one word.
double symmetric_uniform(base::RandomStream& random) {
    return (random.word() + 0.5) * 0x1p-31 - 1;
}

/// Independent standard normal numbers, two from every two uniform ones. Source: Box & Muller 1958.
class NormalPairs {
  public:
    double draw(base::RandomStream& random) {
        second_ = !second_;
        if (!second_)
            return radius_ * base::sin_turns(turns_);
        radius_ = std::sqrt(-2 * base::log(1 - random.uniform())); // 1 − [0, 1) is never 0
        turns_ = random.uniform();
        return radius_ * base::cos_turns(turns_);
    }

  private:
    double radius_ = 0, turns_ = 0;
    bool second_ = false; // whether the next is the second of a pair
};

/// Calls `change` for every gene of the mask, in order.
template <class Change>
void for_each_gene(std::uint32_t mask, const Change& change) {
    for (; mask != 0; mask &= mask - 1)
        change(static_cast<unsigned>(std::countr_zero(mask)));
}

} // namespace

std::uint32_t BinaryView::to_code(float value) const {
    if (!(min < max))
        return 0;
    const double share = (double{value} - min) / (double{max} - min);
    return static_cast<std::uint32_t>(share * ((1u << bits) - 1) + 0.5);
}

float BinaryView::to_value(std::uint32_t code) const {
    const double share = static_cast<double>(code) / ((1u << bits) - 1);
    return std::clamp(static_cast<float>(min + share * (double{max} - min)), min, max);
}

ValueMutation::ValueMutation(const Parameters& parameters)
    : bounds_{gene_bounds(parameters)}
    , creep_{parameters.creep}
    , creep_chance_{parameters.mutation_chance}
    , step_{parameters.mutation_step}
    , reset_chance_{parameters.reset_chance}
    , bit_flip_chance_{parameters.bit_flip_chance}
    , bits_{parameters.bit_flip_bits} {}

unsigned ValueMutation::apply(Genes genes, base::RandomStream& random) const {
    NormalPairs normal;
    if (!creep_chance_.is_never())
        for_each_gene(creep_chance_.draw_bits(gene_count, random), [&](unsigned gene) {
            const double unit = creep_ == Creep::Uniform ? symmetric_uniform(random) : normal.draw(random);
            genes[gene] = static_cast<float>(genes[gene] + step_ * unit);
        });
    if (!reset_chance_.is_never())
        for_each_gene(reset_chance_.draw_bits(gene_count, random), [&](unsigned gene) {
            genes[gene] = static_cast<float>(random.uniform(bounds_.min[gene], bounds_.max[gene]));
        });
    const unsigned clamped = clamp(genes, bounds_);
    if (!bit_flip_chance_.is_never())
        for (unsigned gene = 0; gene < gene_count; ++gene)
            if (const std::uint32_t flips = bit_flip_chance_.draw_bits(bits_, random); flips != 0) {
                const BinaryView view{bounds_.min[gene], bounds_.max[gene], bits_};
                genes[gene] = view.to_value(view.to_code(genes[gene]) ^ flips);
            }
    return clamped;
}

} // namespace evod::evolution
