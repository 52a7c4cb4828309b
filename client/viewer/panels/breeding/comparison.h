// Comparison: the copies a selection made beside the copies its law expects, rank by rank.
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

/// All by rank, shape (contenders).
struct Comparison {
    std::vector<std::uint32_t> organisms; // id of the organism with this rank
    std::vector<double> fitness;
    std::vector<std::uint32_t> copies; // observed, in all picks
    Expectation expected;
    std::vector<double> deviations; // of the copies, in standard errors
    std::vector<Prediction> predictions;
    std::size_t beyond_two = 0; // ranks whose copies deviate by more than two standard errors
};

/// returns  nullopt until the server has sent every contender.
std::optional<Comparison> compare(const BreedingRecord& record);

/// How often picks 0 to `count` - 1 picked each rank. Picks and contenders not yet received do not count.
std::vector<std::uint32_t> copies_after(const BreedingRecord& record, std::uint32_t count);

/// Neighbouring ranks drawn as one bar.
struct RankColumn {
    std::size_t first = 0, last = 0; // ranks
    double copies = 0, expected = 0; // sums over the ranks
    double deviation = 0;            // after all picks, in standard errors; several ranks are treated as independent
};

/// Distributes the ranks over at most `columns` columns whose sizes differ by at most one.
///
/// copies          shape (ranks)
/// expected_share  the fraction of the picks that `copies` counts, 0 to 1: scales the expected copies
std::vector<RankColumn> rank_columns(const Comparison& comparison, std::span<const std::uint32_t> copies,
                                     double expected_share, std::size_t columns);

/// Neighbouring picks drawn as one cell.
struct PickColumn {
    std::uint32_t first = 0, last = 0; // picks
    std::optional<double> rank{};      // mean rank of the picks made so far; nullopt: none made, or none received
};

/// Distributes all picks in order over at most `columns` columns; picks after `index` count as not yet made.
std::vector<PickColumn> pick_columns(const BreedingRecord& record, std::uint32_t index, std::size_t columns);

} // namespace evod::viewer
