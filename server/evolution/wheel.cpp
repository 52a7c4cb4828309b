#include "server/evolution/wheel.h"

#include "server/base/assert.h"

#include <algorithm>
#include <cmath>

namespace evod::evolution {
namespace {

void make_non_negative(std::vector<double>& weights) {
    const auto [least, greatest] = std::minmax_element(weights.begin(), weights.end());
    if (*least >= 0) {
        return;
    }
    const double unit = std::isfinite(*greatest - *least) ? 1 : 0.5;
    const double floor = *least * unit;
    for (double& weight : weights) {
        weight = weight * unit - floor;
    }
}

/// Returns a power of two that scales `greatest` to about 1, so that sums neither overflow nor lose all their digits.
double factor_to_about_one(double greatest) {
    return std::ldexp(1.0, std::clamp(-std::ilogb(greatest), -1000, 1000));
}

} // namespace

Wheel::Wheel(std::vector<double> weights) : ends_{std::move(weights)} {
    const std::size_t population = ends_.size();
    EVOD_ASSERT(population >= 1);
    make_non_negative(ends_);
    const double greatest = *std::max_element(ends_.begin(), ends_.end());
    EVOD_ASSERT(std::isfinite(greatest));
    if (greatest == 0) {
        std::fill(ends_.begin(), ends_.end(), 1.0);
    }
    const double unit = greatest == 0 ? 1 : factor_to_about_one(greatest);
    double end = 0;
    for (double& weight : ends_) {
        end += weight * unit;
        weight = end;
    }

    guide_.resize(population);
    const double step = end / static_cast<double>(population);
    std::uint32_t organism = 0;
    for (std::size_t i = 0; i < population; ++i) {
        const double place = static_cast<double>(i) * step;
        while (organism + 1 < population && ends_[organism] <= place) {
            ++organism;
        }
        guide_[i] = organism;
    }
}

std::uint32_t Wheel::at(double turns) const {
    EVOD_ASSERT(turns >= 0);
    EVOD_ASSERT(turns < 1);
    const double place = turns * ends_.back();
    std::uint32_t organism = guide_[static_cast<std::size_t>(turns * static_cast<double>(guide_.size()))];
    // Because of rounding, the guide may point one slot too far.
    while (organism > 0 && ends_[organism - 1] > place) {
        --organism;
    }
    while (ends_[organism] <= place) {
        ++organism;
    }
    return organism;
}

double Wheel::share(std::uint32_t organism) const {
    EVOD_ASSERT(organism < ends_.size());
    const double begin = organism == 0 ? 0 : ends_[organism - 1];
    return (ends_[organism] - begin) / ends_.back();
}

} // namespace evod::evolution
