#include "server/evolution/free_genes.h"

#include "server/base/elementary.h"

#include <algorithm>
#include <cmath>

namespace evod::evolution {
FreeGenes::FreeGenes(std::vector<FreeGene> list)
    : list_{list.empty() ? nullptr : std::make_shared<const std::vector<FreeGene>>(std::move(list))} {}
FreeGenes::FreeGenes(const FreeGenes& other) = default;
FreeGenes& FreeGenes::operator=(const FreeGenes& other) = default;
FreeGenes::~FreeGenes() = default;

const std::vector<FreeGene>& FreeGenes::list() const {
    static const std::vector<FreeGene> none;
    return list_ == nullptr ? none : *list_;
}

std::uint32_t FreeGenes::gene_count() const {
    std::uint32_t count = 0;
    for (const FreeGene& gene : list()) {
        count += gene.count;
    }
    return count;
}

GeneValues::GeneValues(const FreeGene& gene)
    : ordered_{gene.kind == FreeGene::Kind::Number}
    , logarithmic_{ordered_ && gene.logarithmic}
    , min_{ordered_ ? gene.min : 0}
    , step_{ordered_ ? gene.step : 1}
    , count_{0}
    , first_{0}
    , last_{0}
    , creep_{0} {
    if (gene.kind == FreeGene::Kind::Choice) {
        count_ = static_cast<std::uint32_t>(gene.choices.size());
    } else if (gene.kind == FreeGene::Kind::Permutation) {
        count_ = gene.count;
    } else if (step_ > 0) {
        count_ = static_cast<std::uint32_t>(std::nearbyint((gene.max - gene.min) / gene.step)) + 1;
    }
    if (count_ > 0) {
        last_ = count_ - 1;
        creep_ = ordered_ ? gene.mutation_step / step_ : 0;
    } else if (logarithmic_) {
        // A creep of mutation_step at the highest value.
        first_ = base::log(gene.min);
        last_ = base::log(gene.max);
        creep_ = gene.mutation_step > 0 ? base::log(1 + gene.mutation_step / gene.max) : 0;
    } else {
        first_ = gene.min;
        last_ = gene.max;
        creep_ = gene.mutation_step;
    }
    min_value_ = count_ > 0 ? to_value(first_) : static_cast<float>(gene.min);
    max_value_ = count_ > 0 ? to_value(last_) : static_cast<float>(gene.max);
}

double GeneValues::position_of(float value) const {
    if (count_ > 0) {
        return std::nearbyint((double{value} - min_) / step_);
    }
    return logarithmic_ ? base::log(std::max(double{value}, 0x1p-126)) : double{value};
}

float GeneValues::to_value(double position) const {
    if (count_ > 0) {
        return static_cast<float>(min_ + std::clamp(std::nearbyint(position), first_, last_) * step_);
    }
    return std::clamp(static_cast<float>(logarithmic_ ? base::exp(position) : position), min_value_, max_value_);
}

bool GeneValues::contains(float value) const {
    return count_ > 0 ? to_value(position_of(value)) == value : value >= min() && value <= max();
}

} // namespace evod::evolution
