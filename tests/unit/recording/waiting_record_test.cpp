#include "server/recording/waiting_record.h"

#include <gtest/gtest.h>

#include <cstddef>
#include <vector>

namespace evod::recording {
namespace {

constexpr std::size_t genes = 1006, organisms = 40; // with 1000 free genes
constexpr std::size_t bytes_of_account = genes * sizeof(evolution::GeneAccount);
constexpr std::size_t bytes_of_statistics = genes * sizeof(simulation::GeneStatistics);

simulation::GenerationStatistics wide_row(bool has_account) {
    simulation::GenerationStatistics row;
    row.genes.resize(genes);
    if (has_account) {
        row.account.emplace(genes);
    }
    return row;
}

evolution::NextGeneration wide_generation(bool has_account) {
    evolution::NextGeneration born;
    born.genes.resize(genes, organisms);
    born.parents.resize(organisms);
    if (has_account) {
        born.account.emplace(genes);
    }
    return born;
}

TEST(WaitingRecord, CountsTheGenesOfEndedGenerations) {
    run_file::GenerationEnded ended;
    const std::size_t empty = bytes_of(ended);
    ended.statistics = {wide_row(false), wide_row(false)};
    const std::size_t without = bytes_of(ended);
    EXPECT_GE(without, empty + 2 * bytes_of_statistics);
    ended.statistics = {wide_row(true), wide_row(true)};
    EXPECT_EQ(bytes_of(ended), without + 2 * bytes_of_account);
}

TEST(WaitingRecord, CountsTheGenesOfInheritedGenerations) {
    run_file::Inherited inherited;
    const std::size_t empty = bytes_of(inherited);
    inherited.history.emplace_back(std::vector{wide_row(true), wide_row(true)});
    inherited.history.emplace_back(std::vector{wide_row(true), wide_row(true)});
    EXPECT_GE(bytes_of(inherited), empty + 4 * (bytes_of_statistics + bytes_of_account));
}

TEST(WaitingRecord, CountsTheGenesAndAccountsOfBeginnings) {
    run_file::GenerationBegun begun;
    const std::size_t empty = bytes_of(begun);
    begun.born = {wide_generation(false)};
    const std::size_t without = bytes_of(begun);
    EXPECT_GE(without, empty + genes * organisms * sizeof(float) + organisms * sizeof(evolution::Parents));
    begun.born = {wide_generation(true)};
    EXPECT_EQ(bytes_of(begun), without + bytes_of_account);
}

} // namespace
} // namespace evod::recording
