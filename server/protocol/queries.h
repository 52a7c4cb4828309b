// Queries: answers queries by reading the laboratory between two ticks.
//
// Threads      answer_query(), get_…() and find_world() run on the simulation thread; add_rows() and to_proto() run on
//              the network thread.
#pragma once

#include "evod/v1/commands.pb.h"
#include "server/base/result.h"
#include "server/simulation/laboratory.h"
#include "server/simulation/observation.h"

#include <cstddef>
#include <optional>
#include <string>
#include <variant>
#include <vector>

namespace evod::protocol {

/// Maximum number of GenerationStatistics in an answer. One whole generation is always allowed.
constexpr std::size_t history_statistics_max = 1000;

/// Maximum number of organisms in an answer.
constexpr std::size_t population_rows_max = 10'000;

v1::WorldList list_worlds(const simulation::Laboratory& laboratory);
base::Result<v1::ParameterSet> get_parameters(const simulation::Laboratory& laboratory, const v1::GetParameters& query);
base::Result<v1::Statistics> get_statistics(const simulation::Laboratory& laboratory, const v1::GetStatistics& query);
base::Result<v1::OrganismInfo> get_organism(const simulation::Laboratory& laboratory, const v1::GetOrganism& query);

/// A part of a world's history. It shares the memory of the history, so the simulation does not wait for the
/// conversion.
struct HistoryPart {
    std::vector<simulation::GenerationRows> generations;
    std::optional<std::uint32_t> island; // nullopt: all islands
    std::optional<std::uint64_t> next_generation;
    std::vector<simulation::Change> changes;
    bool users_only = false;  // the client must not see the programs and addresses of other clients
    bool begins_late = false; // some of the requested generations are no longer stored
};
/// users_only  whether the client may see only the users among the causes of changes
base::Result<HistoryPart> get_history(const simulation::Laboratory& laboratory, const v1::GetHistory& query,
                                      bool users_only);
v1::History to_proto(const HistoryPart& part);

/// Maximum number of expressions in an Observe.
constexpr std::size_t expressions_max = 32;

/// The expressions of an Observe, and what they read. The history shares the memory of the world.
struct ObservedHistory {
    std::vector<simulation::Observation> observations;
    simulation::History history;
    parameters::Parameters parameters;
};
base::Result<ObservedHistory> get_observed(const simulation::Laboratory& laboratory, const v1::Observe& query);
/// Evaluates the expressions. Refused if they would take too long.
base::Result<v1::Observations> to_proto(const ObservedHistory& observed);

/// A copy of the columns of an island's organisms, so the simulation does not wait for the conversion.
struct PopulationRows {
    std::uint64_t generation, generation_tick;
    std::uint32_t organism_count, first;
    evolution::GeneMatrix genes;             // a column for each organism
    std::vector<evolution::Parents> parents; // empty in the first generation
    std::vector<std::uint32_t> founders;     // empty if the founders are unknown
    std::vector<simulation::Intention> intentions;
    // Empty unless the query asks for them, and if there are no bodies.
    std::vector<simulation::Island::Life> lives;
    double tick_s; // unit of Life::lived_ticks
    // What is known of the fitness: it depends on the genes alone, or clients have given it; otherwise empty. All
    // objectives of an organism, one organism after another.
    std::vector<double> fitness;
};
base::Result<PopulationRows> get_population(const simulation::Laboratory& laboratory, const v1::GetPopulation& query);
v1::Population to_proto(const PopulationRows& rows);

base::Result<v1::Motion> get_motion(const simulation::Laboratory& laboratory, const v1::GetMotion& query);

/// The world that a subscription or a RenewLease names.
struct FoundWorld {
    std::string name; // empty: the subscription to events is for all worlds
    std::uint32_t island_count = 0;
};
base::Result<FoundWorld> find_world(const simulation::Laboratory& laboratory, const v1::Request& request);

/// What the network thread still has to do for a request: convert copied rows, or apply the request to the world;
/// monostate: the response is complete.
using QueryResult = std::variant<std::monostate, HistoryPart, ObservedHistory, PopulationRows, FoundWorld>;

/// Answers a request that reads the laboratory. If the request is refused, the response contains the refusal.
///
/// users_only  true: the programs and addresses of other clients are removed from the response.
QueryResult answer_query(const v1::Request& request, const simulation::Laboratory& laboratory, bool users_only,
                         v1::Response& response);
/// If the result contains rows, converts them and adds them to the response.
void add_rows(const QueryResult& result, v1::Response& response);
/// Memory of the rows that a result has copied. The rows of a history are shared with the world.
std::size_t row_bytes(const QueryResult& result);

} // namespace evod::protocol
