// Comparison: the copies that a selection made beside those that its law expects, rank by rank.
//
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
    std::vector<std::uint32_t> organisms; // who has the rank
    std::vector<double> fitness;
    std::vector<std::uint32_t> copies; // that happened, of all the picks
    Expectation expected;
    std::vector<double> deviations; // of the copies, in standard errors
    std::vector<Finding> findings;
    std::size_t beyond_two = 0; // ranks whose copies are more than two standard errors off
};

/// returns  nullopt until every contender is known.
std::optional<Comparison> compare(const BreedingRecord& record);

/// How often each rank has been picked with picks 0 to `count` - 1, as far as they are known.
std::vector<std::uint32_t> copies_after(const BreedingRecord& record, std::uint32_t count);

/// Some ranks side by side, drawn as one bar.
struct RankColumn {
    std::size_t first = 0, last = 0; // ranks
    double copies = 0, expected = 0; // of all of them
    double deviation = 0; // of all the picks, in standard errors; of several ranks as if they were independent
};

/// The ranks as at most `columns` columns, each of as many ranks as any other but for one.
///
/// copies          shape (ranks)
/// expected_share  how much of what is expected of all the picks is expected of `copies`, 0 to 1
std::vector<RankColumn> rank_columns(const Comparison& comparison, std::span<const std::uint32_t> copies,
                                     double expected_share, std::size_t columns);

/// Some picks side by side, drawn as one cell.
struct PickColumn {
    std::uint32_t first = 0, last = 0; // picks
    std::optional<double> rank{};      // mean of those made so far; nullopt: none of them is, or is known
};

/// All picks in order as at most `columns` columns, those after pick `index` not made yet.
std::vector<PickColumn> pick_columns(const BreedingRecord& record, std::uint32_t index, std::size_t columns);

} // namespace evod::viewer
