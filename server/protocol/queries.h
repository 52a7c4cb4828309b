// Answers to queries, read from the laboratory between two ticks.
#pragma once

#include "evod/v1/commands.pb.h"
#include "server/base/result.h"
#include "server/simulation/laboratory.h"

#include <optional>
#include <vector>

namespace evod::protocol {

/// Answers to a history query at most so many GenerationStatistics, but a whole generation at least.
constexpr std::size_t history_statistics_max = 1000;

/// Organisms in an answer to a population query at most.
constexpr std::size_t population_rows_max = 10'000;

v1::WorldList list_worlds(const simulation::Laboratory& laboratory);
base::Result<v1::ParameterSet> get_parameters(const simulation::Laboratory& laboratory, const v1::GetParameters& query);
base::Result<v1::Statistics> get_statistics(const simulation::Laboratory& laboratory, const v1::GetStatistics& query);
base::Result<v1::OrganismInfo> get_organism(const simulation::Laboratory& laboratory, const v1::GetOrganism& query);

/// Part of a world's history, shared with it, so that the simulation need not wait for messages to be made.
struct HistoryPart {
    std::vector<simulation::GenerationRows> generations;
    std::optional<std::uint32_t> island; // nullopt: all
    std::optional<std::uint64_t> next_generation;
    bool begins_late = false; // some of those that were asked for are not kept any more
};
base::Result<HistoryPart> get_history(const simulation::Laboratory& laboratory, const v1::GetHistory& query);
v1::History to_proto(const HistoryPart& part);

/// Organisms of an island, copied as they lie for the same reason.
struct PopulationRows {
    std::uint64_t generation, generation_tick;
    std::uint32_t organism_count, first;
    std::vector<evolution::Chromosome> genes;
    std::vector<evolution::Parents> parents; // empty in the first generation
    std::vector<std::uint32_t> founders;     // empty where the world does not know
    std::vector<simulation::Intention> intentions;
};
constexpr std::size_t population_row_bytes =
    sizeof(evolution::Chromosome) + sizeof(evolution::Parents) + sizeof(std::uint32_t) + sizeof(simulation::Intention);
base::Result<PopulationRows> get_population(const simulation::Laboratory& laboratory, const v1::GetPopulation& query);
v1::Population to_proto(const PopulationRows& rows);

base::Result<v1::Motion> get_motion(const simulation::Laboratory& laboratory, const v1::GetMotion& query);

/// The world that is to be watched, as found by name.
struct Watched {
    std::string world;
    std::uint32_t island_count;
};
base::Result<Watched> find_watched(const simulation::Laboratory& laboratory, const v1::SubscribeSnapshots& request);

} // namespace evod::protocol
