#include "client/viewer/panels/breeding/comparison.h"

#include <algorithm>
#include <cmath>

namespace evod::viewer {

std::optional<Comparison> compare(const BreedingRecord& record) {
    if (!record.known()) {
        return std::nullopt;
    }
    const evod::v1::Breeding& breeding = record.breeding();
    const std::size_t count = breeding.contender_count();
    if (count == 0 || static_cast<std::size_t>(breeding.contenders_size()) != count) {
        return std::nullopt;
    }
    Comparison comparison;
    comparison.organisms.resize(count);
    comparison.fitness.resize(count);
    comparison.copies.resize(count);
    Expectation& expected = comparison.expected;
    expected.copies.resize(count);
    expected.standard_error.resize(count);
    expected.unpicked_chance.resize(count);
    for (std::size_t organism = 0; organism < count; ++organism) {
        const evod::v1::Contender& contender = breeding.contenders(static_cast<int>(organism));
        if (contender.rank() >= count) {
            return std::nullopt;
        }
        comparison.organisms[contender.rank()] = static_cast<std::uint32_t>(organism);
        comparison.fitness[contender.rank()] = contender.fitness();
        comparison.copies[contender.rank()] = contender.copies();
        expected.copies[contender.rank()] = contender.expected_copies();
        expected.standard_error[contender.rank()] = contender.expected_copies_error();
        expected.unpicked_chance[contender.rank()] = contender.unpicked_chance();
    }
    comparison.predictions =
        predictions(selection_of(breeding), comparison.expected, comparison.fitness, comparison.copies);
    for (std::size_t rank = 0; rank < count; ++rank) {
        const double off = deviation(comparison.copies[rank], expected.copies[rank], expected.standard_error[rank]);
        comparison.deviations.push_back(off);
        comparison.beyond_two += std::abs(off) > 2;
    }
    return comparison;
}

std::vector<std::uint32_t> copies_after(const BreedingRecord& record, std::uint32_t count) {
    std::vector<std::uint32_t> copies(record.known() ? record.breeding().contender_count() : 0);
    for (std::uint32_t i = 0; i < count; ++i) {
        const evod::v1::Pick* pick = record.pick(i);
        const evod::v1::Contender* contender = pick != nullptr ? record.contender(pick->organism()) : nullptr;
        if (contender != nullptr && contender->rank() < copies.size()) {
            ++copies[contender->rank()];
        }
    }
    return copies;
}

std::vector<RankColumn> rank_columns(const Comparison& comparison, std::span<const std::uint32_t> copies,
                                     double expected_share, std::size_t columns) {
    const std::size_t count = copies.size();
    columns = std::min(columns, count);
    std::vector<RankColumn> made;
    for (std::size_t i = 0; i < columns; ++i) {
        RankColumn column{.first = i * count / columns, .last = (i + 1) * count / columns - 1};
        double all_copies = 0, all_expected = 0, variance = 0;
        for (std::size_t rank = column.first; rank <= column.last; ++rank) {
            column.copies += copies[rank];
            all_copies += comparison.copies[rank];
            all_expected += comparison.expected.copies[rank];
            variance += comparison.expected.standard_error[rank] * comparison.expected.standard_error[rank];
        }
        column.expected = all_expected * expected_share;
        column.deviation = deviation(all_copies, all_expected, std::sqrt(variance));
        made.push_back(column);
    }
    return made;
}

std::vector<PickColumn> pick_columns(const BreedingRecord& record, std::uint32_t index, std::size_t columns) {
    const std::uint64_t count = record.pick_count();
    columns = std::min<std::size_t>(columns, count);
    std::vector<PickColumn> made;
    for (std::size_t i = 0; i < columns; ++i) {
        PickColumn column{.first = static_cast<std::uint32_t>(i * count / columns),
                          .last = static_cast<std::uint32_t>((i + 1) * count / columns - 1)};
        double ranks = 0, known = 0;
        for (std::uint32_t pick = column.first; pick <= std::min(column.last, index); ++pick) {
            const evod::v1::Pick* picked = record.pick(pick);
            if (const auto* contender = picked != nullptr ? record.contender(picked->organism()) : nullptr) {
                ranks += contender->rank();
                ++known;
            }
        }
        if (known > 0) {
            column.rank = ranks / known;
        }
        made.push_back(column);
    }
    return made;
}

} // namespace evod::viewer
