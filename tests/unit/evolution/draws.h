// Shared by the tests of the genetic algorithm: streams by seed, and counts of events.
#pragma once

#include "server/base/inline_executor.h"
#include "server/base/random.h"
#include "server/evolution/gene_layout.h"
#include "tests/support/chi_square.h"

#include <cmath>
#include <cstdint>
#include <numeric>
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

/// The number of events in all cells.
inline double total_of(std::span<const std::uint64_t> counts) {
    return static_cast<double>(std::accumulate(counts.begin(), counts.end(), std::uint64_t{0}));
}

/// Pearson's test of `counts` against a law: the probabilities of the same cells, with sum 1. Cells of probability 0
/// must be empty and do not count.
inline double p_value_of_law(std::span<const std::uint64_t> counts, std::span<const double> law) {
    const double total = total_of(counts);
    std::vector<std::uint64_t> observed;
    std::vector<double> expected;
    for (std::size_t i = 0; i < law.size(); ++i) {
        if (law[i] > 0) {
            observed.push_back(counts[i]);
            expected.push_back(law[i] * total);
        } else if (counts[i] > 0) {
            return 0;
        }
    }
    return support::p_value(support::chi_square(observed, expected), observed.size() - 1);
}

/// Pearson's test of independent rows of counts, each against the law.
inline double p_value_of_rows(std::span<const std::vector<std::uint64_t>> rows, std::span<const double> law) {
    double statistic = 0;
    for (const std::vector<std::uint64_t>& counts : rows) {
        const double total = total_of(counts);
        std::vector<double> expected;
        for (const double probability : law) {
            expected.push_back(probability * total);
        }
        statistic += support::chi_square(counts, expected);
    }
    return support::p_value(statistic, rows.size() * (law.size() - 1));
}

/// The probabilities of 0 … trials events, each with the same chance and independent.
inline std::vector<double> binomial_law(unsigned trials, double chance) {
    std::vector<double> law(trials + 1);
    for (unsigned events = 0; events <= trials; ++events) {
        law[events] =
            std::exp(std::lgamma(trials + 1.0) - std::lgamma(events + 1.0) - std::lgamma(trials - events + 1.0) +
                     events * std::log(chance) + (trials - events) * std::log1p(-chance));
    }
    return law;
}

/// Pearson's test as p_value_of_law(), with neighbouring cells joined until at least ten events are expected in each.
inline double p_value_of_joined_cells(std::span<const std::uint64_t> counts, std::span<const double> law) {
    const double total = total_of(counts);
    std::vector<std::uint64_t> joined;
    std::vector<double> probabilities;
    double left = 1;
    for (std::size_t i = 0; i < law.size(); ++i) {
        if (probabilities.empty() || (probabilities.back() * total >= 10 && left * total >= 10)) {
            joined.push_back(0);
            probabilities.push_back(0);
        }
        joined.back() += counts[i];
        probabilities.back() += law[i];
        left -= law[i];
    }
    return p_value_of_law(joined, probabilities);
}

/// Chromosomes longer than a word of a gene mask, and the longest with a brain.
constexpr unsigned wide_gene_counts[] = {10, 64, 65, 328};

/// Chromosomes of `genes` genes, of which the last 322 are those of the largest brain if `genes` is 328, and free genes
/// otherwise. Nothing mutates.
inline Parameters wide_parameters(unsigned genes) {
    Parameters parameters;
    parameters.mutation_chance = 0;
    if (genes == 328) {
        parameters.controller = Controller::Network;
        parameters.sense_speed = parameters.sense_health = parameters.sense_wall = true;
        parameters.brain_hidden = 32;
    } else {
        parameters.free_genes = genes - body_gene_count;
    }
    return parameters;
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
