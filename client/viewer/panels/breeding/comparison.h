// Comparison: for each rank, the observed number of copies beside the number that the law of the selection method
// expects.
//
// Owner        BreedingPanel.
// Threads      none.
#pragma once

#include "client/viewer/panels/breeding/breeding_record.h"
#include "client/viewer/panels/breeding/theory.h"

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace evod::viewer {

/// The copies of each rank, observed and expected. Each list is indexed by rank and has one entry per contender.
struct Comparison {
    std::vector<std::uint32_t> organisms; // id of the organism with this rank
    std::vector<double> fitness;
    std::vector<std::uint32_t> copies; // observed in all picks
    Expectation expected;
    std::vector<double> deviations; // deviation of the observed from the expected copies, in standard errors
    std::vector<Prediction> predictions;
    std::size_t beyond_two = 0; // number of ranks whose copies deviate by more than two standard errors
};

/// Compares the observed copies with the expected ones.
///
/// returns  nullopt until the server has sent every contender.
std::optional<Comparison> compare(const BreedingRecord& record);

/// Returns, for each rank, the number of the first `count` picks that selected it. Ignores picks and contenders that
/// have not been received.
std::vector<std::uint32_t> copies_after(const BreedingRecord& record, std::uint32_t count);

/// A group of neighbouring ranks that is drawn as one bar.
struct RankColumn {
    std::size_t first = 0, last = 0; // first and last rank of the group
    double copies = 0, expected = 0; // sums over the ranks
    double deviation = 0;            // after all picks, in standard errors; ranks in a group are treated as independent
};

/// Distributes the ranks over at most `columns` groups. The sizes of any two groups differ by at most one.
///
/// copies          observed copies by rank, shape (ranks)
/// expected_share  factor for the expected copies: the fraction of all picks that `copies` includes, 0 to 1
std::vector<RankColumn> rank_columns(const Comparison& comparison, std::span<const std::uint32_t> copies,
                                     double expected_share, std::size_t columns);

/// A group of consecutive picks that is drawn as one cell.
struct PickColumn {
    std::uint32_t first = 0, last = 0; // first and last pick of the group
    std::optional<double> rank{};      // mean rank of the picks made; nullopt if none was made or received
};

/// Distributes all picks, in order, over at most `columns` groups. Ignores the ranks of picks after `index`.
std::vector<PickColumn> pick_columns(const BreedingRecord& record, std::uint32_t index, std::size_t columns);

} // namespace evod::viewer
