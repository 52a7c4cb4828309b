#include "server/experiments/paired_test.h"

#include "server/base/assert.h"

#include <boost/math/distributions/students_t.hpp>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numeric>

namespace evod::experiments {

double mean_of(std::span<const double> sample) {
    EVOD_ASSERT(!sample.empty());
    return std::accumulate(sample.begin(), sample.end(), 0.0) / static_cast<double>(sample.size());
}

double deviation_of(std::span<const double> sample) {
    EVOD_ASSERT(sample.size() >= 2);
    const double mean = mean_of(sample);
    double squares = 0;
    for (const double value : sample) {
        squares += (value - mean) * (value - mean);
    }
    return std::sqrt(squares / static_cast<double>(sample.size() - 1));
}

Interval student_interval(std::span<const double> sample, double confidence) {
    EVOD_ASSERT(confidence > 0 && confidence < 1);
    const double count = static_cast<double>(sample.size());
    const double deviation = deviation_of(sample);
    const double quantile =
        boost::math::quantile(boost::math::complement(boost::math::students_t(count - 1), (1 - confidence) / 2));
    const double mean = mean_of(sample), half = quantile * deviation / std::sqrt(count);
    return {mean - half, mean + half};
}

std::optional<double> hedges_g(std::span<const double> differences) {
    const bool all_equal = std::ranges::adjacent_find(differences, std::ranges::not_equal_to{}) == differences.end();
    if (differences.size() < 3 || all_equal) {
        return std::nullopt;
    }
    const double freedom = static_cast<double>(differences.size() - 1);
    return mean_of(differences) / deviation_of(differences) * (1 - 3 / (4 * freedom - 1));
}

double sign_flip_p(std::span<const double> differences, base::Seed seed) {
    EVOD_ASSERT(!differences.empty());
    double observed = 0, magnitude = 0;
    for (const double difference : differences) {
        observed += difference;
        magnitude += std::abs(difference);
    }
    // Two sums that are equal in theory may differ in their last digits, because rounding depends on the signs.
    const double least = std::abs(observed) - 1e-12 * magnitude;
    const std::size_t count = differences.size();
    const auto is_as_far = [&](const auto& is_negative) {
        double sum = 0;
        for (std::size_t i = 0; i < count; ++i) {
            sum += is_negative(i) ? -differences[i] : differences[i];
        }
        return std::abs(sum) >= least;
    };
    if (count <= exact_sign_flips_max) {
        // Inverting all signs only inverts the sum, so it is enough to try the patterns with a fixed last sign.
        const std::uint32_t patterns = 1u << (count - 1);
        std::uint32_t as_far = 0;
        for (std::uint32_t signs = 0; signs < patterns; ++signs) {
            as_far += is_as_far([&](std::size_t i) { return (signs >> i & 1) != 0; });
        }
        return static_cast<double>(as_far) / patterns;
    }
    constexpr std::uint32_t drawn = (1u << exact_sign_flips_max) - 1;
    base::RandomStream random{{seed, base::Purpose::SignFlip, 0, 0}, 0};
    std::vector<std::uint32_t> words((count + 31) / 32);
    std::uint32_t as_far = 1; // the observed pattern
    for (std::uint32_t i = 0; i < drawn; ++i) {
        for (std::uint32_t& word : words) {
            word = random.word();
        }
        as_far += is_as_far([&](std::size_t k) { return (words[k / 32] >> (k % 32) & 1) != 0; });
    }
    return static_cast<double>(as_far) / (drawn + 1.0);
}

double least_sign_flip_p(std::size_t differences) {
    EVOD_ASSERT(differences >= 1);
    return differences <= exact_sign_flips_max ? std::ldexp(1.0, 1 - static_cast<int>(differences))
                                               : std::ldexp(1.0, -static_cast<int>(exact_sign_flips_max));
}

std::vector<double> holm(std::span<const double> p) {
    std::vector<std::size_t> order(p.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::ranges::stable_sort(order, {}, [&](std::size_t i) { return p[i]; });
    std::vector<double> adjusted(p.size());
    double greatest = 0;
    for (std::size_t rank = 0; rank < order.size(); ++rank) {
        greatest = std::max(greatest, std::min(1.0, static_cast<double>(p.size() - rank) * p[order[rank]]));
        adjusted[order[rank]] = greatest;
    }
    return adjusted;
}

} // namespace evod::experiments
