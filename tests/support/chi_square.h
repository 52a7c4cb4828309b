// Pearson's chi-square test, for tests that check the distribution of an operator's results.
#pragma once

#include <boost/math/distributions/chi_squared.hpp>

#include <cstddef>
#include <cstdint>
#include <span>

namespace evod::support {

constexpr double alpha = 1e-6; // share of seeds for which a correct build would fail a statistical test

/// Σ (observed − expected)² / expected. `expected` are counts > 0 with the same total as `observed`.
inline double chi_square(std::span<const std::uint64_t> observed, std::span<const double> expected) {
    double sum = 0;
    for (std::size_t i = 0; i < observed.size(); ++i) {
        const double difference = static_cast<double>(observed[i]) - expected[i];
        sum += difference * difference / expected[i];
    }
    return sum;
}

/// The probability that a correct program gives a statistic at least this large.
inline double p_value(double statistic, std::size_t degrees_of_freedom) {
    return boost::math::cdf(
        boost::math::complement(boost::math::chi_squared(static_cast<double>(degrees_of_freedom)), statistic));
}

/// The same for equally likely cells.
inline double p_value_of_equal_cells(std::span<const std::uint64_t> observed) {
    std::uint64_t total = 0;
    for (const std::uint64_t count : observed) {
        total += count;
    }
    const double expected = static_cast<double>(total) / static_cast<double>(observed.size());
    double sum = 0;
    for (const std::uint64_t count : observed) {
        sum += (static_cast<double>(count) - expected) * (static_cast<double>(count) - expected) / expected;
    }
    return p_value(sum, observed.size() - 1);
}

} // namespace evod::support
