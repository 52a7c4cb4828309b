// Shared by the tests of the genetic algorithm: streams by seed, and counts of events.
#pragma once

#include "server/base/inline_executor.h"
#include "server/base/random.h"
#include "tests/support/chi_square.h"

#include <cstdint>
#include <span>
#include <vector>

namespace evod::evolution {

using support::alpha;

inline base::RandomKey key_of(std::uint64_t seed) {
    return {base::Seed{seed}, base::Purpose::ScenarioTest, 0, 1};
}
inline base::RandomStream stream_of(std::uint64_t seed, std::uint32_t entity = 0) {
    return {key_of(seed), entity};
}

/// Pearson's test of `counts` against a law: the probabilities of the same cells, with sum 1. Cells of probability 0
/// must be empty and do not count.
inline double p_value_of_law(std::span<const std::uint64_t> counts, std::span<const double> law) {
    std::uint64_t total = 0;
    for (const std::uint64_t count : counts) {
        total += count;
    }
    std::vector<std::uint64_t> observed;
    std::vector<double> expected;
    for (std::size_t i = 0; i < law.size(); ++i) {
        if (law[i] > 0) {
            observed.push_back(counts[i]);
            expected.push_back(law[i] * static_cast<double>(total));
        } else if (counts[i] > 0) {
            return 0;
        }
    }
    return support::p_value(support::chi_square(observed, expected), observed.size() - 1);
}

/// The number of occurrences of each of 0 … cells − 1.
inline std::vector<std::uint64_t> count_each(std::span<const std::uint32_t> values, std::size_t cells) {
    std::vector<std::uint64_t> counts(cells);
    for (const std::uint32_t value : values) {
        ++counts.at(value);
    }
    return counts;
}

} // namespace evod::evolution
