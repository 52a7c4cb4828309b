#include "server/recording/waiting_record.h"

#include "server/base/overloaded.h"

#include <variant>

namespace evod::recording {
namespace {

std::size_t bytes_of(const std::optional<evolution::SelectionAccount>& account) {
    return account ? account->size() * sizeof(evolution::GeneAccount) : 0;
}

std::size_t bytes_of(const std::vector<simulation::GenerationStatistics>& rows) {
    std::size_t bytes = 0;
    for (const simulation::GenerationStatistics& row : rows) {
        bytes += sizeof row + row.genes.size() * sizeof(simulation::GeneStatistics) + bytes_of(row.account) +
                 bytes_of(row.predators);
    }
    return bytes;
}

std::size_t bytes_of(const simulation::IslandOpening& opening) {
    constexpr std::size_t of_organism = 40; // its state, number, age, children and handling
    const simulation::IslandState& state = opening.state;
    return sizeof opening + opening.numbers.size() * of_organism +
           (state.food.size() + state.poison.size()) * sizeof(simulation::Items::Item) +
           (state.latest_born[0].size() + state.latest_born[1].size()) * sizeof(float);
}

} // namespace

std::size_t bytes_of(const Record& record) {
    constexpr std::size_t small = 256;
    return std::visit(base::Overloaded{
                          [](const run_file::JournalEntry& entry) {
                              return small + entry.origin.request.size() + entry.answer.size();
                          },
                          [](const run_file::Inherited& inherited) {
                              std::size_t bytes = small;
                              for (const simulation::GenerationRows& rows : inherited.history) {
                                  bytes += bytes_of(rows);
                              }
                              return bytes;
                          },
                          [](const run_file::GenerationBegun& begun) {
                              std::size_t bytes = small;
                              for (const std::vector<std::uint32_t>& founders : begun.founders) {
                                  bytes += founders.size() * sizeof(std::uint32_t);
                              }
                              for (const evolution::NextGeneration& born : begun.born) {
                                  bytes += static_cast<std::size_t>(born.genes.size()) * sizeof(float) +
                                           born.parents.size() * sizeof(evolution::Parents) + bytes_of(born.account) +
                                           bytes_of(born.predator_account);
                              }
                              for (const simulation::IslandOpening& opening : begun.openings) {
                                  bytes += bytes_of(opening);
                              }
                              return bytes;
                          },
                          [](const run_file::GenerationEnded& ended) {
                              std::size_t bytes = small;
                              bytes += bytes_of(ended.statistics);
                              for (const run_file::IslandOutcome& outcome : ended.outcomes) {
                                  bytes += small +
                                           outcome.fitness.size() * (sizeof(double) + sizeof(std::uint32_t) + 1) +
                                           outcome.objectives.size() * sizeof(double) +
                                           outcome.repaired.size() * sizeof(float) +
                                           outcome.births.size() * sizeof(simulation::Birth);
                              }
                              return bytes;
                          },
                          // A run has at most one waiting checkpoint.
                          [](const run_file::Checkpoint&) { return std::size_t{0}; },
                          [](const run_file::StoredCheckpoint&) { return std::size_t{0}; },
                          [](const auto&) { return sizeof(run_file::HashRecord); },
                      },
                      record);
}

std::size_t bytes_of(const std::vector<WaitingRecord>& records) {
    std::size_t bytes = 0;
    for (const WaitingRecord& record : records) {
        bytes += record.bytes;
    }
    return bytes;
}

bool Closing::ends_run() const {
    const auto* mark = last.empty() ? nullptr : std::get_if<run_file::EndMark>(&*last.back().record);
    return mark != nullptr && mark->ended;
}

} // namespace evod::recording
