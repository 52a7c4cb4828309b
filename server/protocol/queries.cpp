#include "server/protocol/queries.h"

#include "proto/codec/little_endian.h"
#include "server/protocol/actors.h"
#include "server/protocol/commands.h"
#include "server/protocol/experiment_summary.h"
#include "server/protocol/parameters.h"
#include "server/protocol/refusals.h"
#include "server/protocol/request_rules.h"
#include "server/protocol/worlds.h"
#include "server/simulation/fitness.h"

#include <algorithm>
#include <bit>
#include <limits>
#include <type_traits>
#include <utility>

namespace evod::protocol {
namespace {

base::Refusal not_found_refusal(const char* what, std::string field, std::uint64_t count, std::uint64_t got,
                                base::Reason reason) {
    return {.code = base::RefusalCode::NotFound,
            .message = std::string{"no such "} + what,
            .violations = {{std::move(field), count == 0 ? "none" : "0 to " + std::to_string(count - 1),
                            std::to_string(got)}},
            .reason = reason};
}

/// The world and the island of a query.
struct FoundIsland {
    const simulation::World& world;
    const simulation::Island& island;
};
base::Result<FoundIsland> find_island(const simulation::Laboratory& laboratory, const std::string& world,
                                      std::uint32_t island, const char* field) {
    const auto entry = laboratory.find(lookup_name(world));
    if (!entry) {
        return entry.error();
    }
    const simulation::World& there = (*entry)->world;
    if (island >= there.island_count()) {
        return not_found_refusal("island", field, there.island_count(), island, base::Reason::IslandNotFound);
    }
    return FoundIsland{there, there.island(island)};
}

/// Appends one little-endian number of 4 or 8 bytes for each row.
template <class Rows, class Of>
void append_column(std::string& bytes, const Rows& rows, Of&& of) {
    constexpr std::size_t number_bytes = sizeof(of(rows.front()));
    using Bits = std::conditional_t<number_bytes == sizeof(std::uint32_t), std::uint32_t, std::uint64_t>;
    std::size_t at = bytes.size();
    bytes.resize(at + static_cast<std::size_t>(rows.size()) * number_bytes);
    for (const auto& row : rows) {
        codec::store(std::bit_cast<Bits>(of(row)), &bytes[at]);
        at += number_bytes;
    }
}

} // namespace

v1::WorldList list_worlds(const simulation::Laboratory& laboratory) {
    v1::WorldList list;
    for (const auto& entry : laboratory.entries()) {
        if (!entry->replays_another_world()) {
            *list.add_worlds() = to_proto(*entry);
        }
    }
    // The worlds are sorted by name, because the order of their creation is not known after a restart.
    std::sort(list.mutable_worlds()->begin(), list.mutable_worlds()->end(),
              [](const v1::WorldInfo& a, const v1::WorldInfo& b) { return a.name() < b.name(); });
    for (const simulation::DamagedWorld& world : laboratory.damaged()) {
        *list.add_damaged() = to_proto(world);
    }
    std::sort(list.mutable_damaged()->begin(), list.mutable_damaged()->end(),
              [](const v1::DamagedWorld& a, const v1::DamagedWorld& b) { return a.name() < b.name(); });
    return list;
}

base::Result<v1::ParameterSet> get_parameters(const simulation::Laboratory& laboratory,
                                              const v1::GetParameters& query) {
    const auto entry = laboratory.find(lookup_name(query.world()));
    if (!entry) {
        return entry.error();
    }
    const simulation::World& world = (*entry)->world;
    v1::ParameterSet set = to_proto(world.parameters(), laboratory.class_of(**entry));
    for (const parameters::PlannedChange& change : world.planned()) {
        *set.add_planned() = to_proto(change);
    }
    *set.mutable_schedule() = to_proto(world.schedule(), world.moment().generation);
    set.set_summary(set.summary() + schedule_summary(world.schedule(), world.moment().generation));
    return set;
}

base::Result<v1::Statistics> get_statistics(const simulation::Laboratory& laboratory, const v1::GetStatistics& query) {
    const auto entry = laboratory.find(lookup_name(query.world()));
    if (!entry) {
        return entry.error();
    }
    const simulation::World& world = (*entry)->world;
    v1::Statistics statistics;
    *statistics.mutable_world() = to_proto(**entry);
    if (world.has_bodies()) {
        std::uint32_t island = 0;
        for (const simulation::LiveStatistics& live : world.islands().live_statistics()) {
            *statistics.add_live() = to_proto(live, island++);
        }
    }
    if (!world.history().empty()) {
        for (const auto& last : world.history().back()) {
            *statistics.add_last() = to_proto(last);
        }
    }
    return statistics;
}

base::Result<v1::OrganismInfo> get_organism(const simulation::Laboratory& laboratory, const v1::GetOrganism& query) {
    const auto found = find_island(laboratory, query.world(), query.island(), "get_organism.island");
    if (!found) {
        return found.error();
    }
    const auto born = static_cast<std::uint64_t>(found->island.born().genes.cols());
    if (query.organism() >= born) {
        return not_found_refusal("organism", "get_organism.organism", born, query.organism(),
                                 base::Reason::OrganismNotFound);
    }
    return organism_info(found->world, found->island, query.organism());
}

base::Result<HistoryPart> get_history(const simulation::Laboratory& laboratory, const v1::GetHistory& query,
                                      bool users_only) {
    const auto entry = laboratory.find(lookup_name(query.world()));
    if (!entry) {
        return entry.error();
    }
    const simulation::World& world = (*entry)->world;
    if (query.has_island() && query.island() >= world.island_count()) {
        return not_found_refusal("island", "get_history.island", world.island_count(), query.island(),
                                 base::Reason::IslandNotFound);
    }

    HistoryPart answer;
    answer.users_only = users_only;
    if (query.has_island()) {
        answer.island = query.island();
    }
    const auto& history = world.history();
    const std::uint64_t first = query.has_first_generation() ? query.first_generation() : 0;
    const std::uint64_t last =
        query.has_last_generation() ? query.last_generation() : std::numeric_limits<std::uint64_t>::max();
    answer.begins_late =
        history.size() >= simulation::history_generations_kept_of(world.island_count(),
                                                                  evolution::gene_count(world.parameters().active)) &&
        std::max<std::uint64_t>(first, 1) < history.front().front().generation;
    auto generation = std::partition_point(history.begin(), history.end(),
                                           [first](const auto& rows) { return rows.front().generation < first; });
    std::size_t count = 0;
    for (; generation != history.end() && generation->front().generation <= last; ++generation) {
        const simulation::GenerationStatistics& row = generation->front();
        count += (query.has_island() ? 1 : generation->size()) * row.genes.size() * (1 + row.predators.size());
        if (!answer.generations.empty() && count > history_statistics_max * evolution::body_gene_count) {
            answer.next_generation = generation->front().generation;
            break;
        }
        answer.generations.push_back(*generation);
    }
    const std::uint64_t end = answer.next_generation.value_or(std::numeric_limits<std::uint64_t>::max());
    for (const simulation::Change& change : world.changes().all()) {
        if (change.generation >= first && change.generation <= last && change.generation < end) {
            answer.changes.push_back(change);
        }
    }
    return answer;
}

v1::History to_proto(const HistoryPart& part) {
    v1::History history;
    for (const simulation::GenerationRows& rows : part.generations) {
        for (const simulation::GenerationStatistics& row : rows) {
            if (!part.island || row.island == *part.island) {
                *history.add_generations() = to_proto(row);
            }
        }
    }
    if (part.next_generation) {
        history.set_next_generation(*part.next_generation);
    }
    for (const simulation::Change& change : part.changes) {
        *history.add_changes() = to_proto(change);
    }
    if (part.users_only) {
        keep_users_only(history);
    }
    return history;
}

base::Result<ObservedHistory> get_observed(const simulation::Laboratory& laboratory, const v1::Observe& query) {
    const auto entry = laboratory.find(lookup_name(query.world()));
    if (!entry) {
        return entry.error();
    }
    const simulation::World& world = (*entry)->world;
    ObservedHistory observed{.observations = {}, .history = world.history(), .parameters = world.parameters().active};
    const simulation::ObservedColumns columns{observed.parameters};
    std::vector<base::Violation> violations;
    for (int i = 0; i < query.expressions_size(); ++i) {
        auto parsed = simulation::Observation::parse(query.expressions(i), columns,
                                                     "observe.expressions[" + std::to_string(i) + "]");
        if (parsed) {
            observed.observations.push_back(*std::move(parsed));
        } else {
            const base::Refusal refused = parsed.error();
            violations.insert(violations.end(), refused.violations.begin(), refused.violations.end());
        }
    }
    if (!violations.empty()) {
        return base::Refusal{.code = base::RefusalCode::InvalidArgument,
                             .message = "invalid expressions",
                             .violations = std::move(violations)};
    }
    return observed;
}

base::Result<v1::Observations> to_proto(const ObservedHistory& observed) {
    v1::Observations answer;
    std::uint64_t steps_left = simulation::Observation::steps_max;
    for (const simulation::Observation& observation : observed.observations) {
        v1::Observation& added = *answer.add_observations();
        if (const auto value = observation.value({observed.history, observed.parameters}, steps_left)) {
            added.set_value(*value);
        }
    }
    if (steps_left == 0) {
        return base::Refusal{.code = base::RefusalCode::InvalidArgument,
                             .message = "the expressions read too many numbers",
                             .violations = {{"observe.expressions",
                                             "at most " + std::to_string(simulation::Observation::steps_max) +
                                                 " numbers: name ranges of generations, or send fewer expressions",
                                             "more"}}};
    }
    return answer;
}

/// Returns PopulationRows::fitness.
std::vector<double> known_fitness(const simulation::World& world, const simulation::Island& island, base::Range ids) {
    const parameters::FitnessFunction function = world.parameters().active.fitness;
    std::vector<double> fitness;
    if (function == parameters::FitnessFunction::External && world.is_rated(island.index())) {
        const std::size_t objectives = world.parameters().active.objectives;
        const std::vector<double>& given = world.ratings()[island.index()].fitness;
        fitness.assign(given.data() + ids.begin * objectives, given.data() + ids.end * objectives);
    } else if (!world.has_bodies() && function != parameters::FitnessFunction::External) {
        const auto of_genes =
            function == parameters::FitnessFunction::GeneSum ? simulation::gene_sum : simulation::rastrigin;
        for (std::size_t id = ids.begin; id < ids.end; ++id) {
            fitness.push_back(of_genes(evolution::body_genes(island.born().genes, static_cast<std::uint32_t>(id))));
        }
    }
    return fitness;
}

base::Result<PopulationRows> get_population(const simulation::Laboratory& laboratory, const v1::GetPopulation& query) {
    const auto found = find_island(laboratory, query.world(), query.island(), "get_population.island");
    if (!found) {
        return found.error();
    }
    const auto& [world, island] = *found;
    const evolution::NextGeneration& born = island.born();
    const auto count = static_cast<std::size_t>(born.genes.cols());
    const std::size_t first = query.first_organism();
    if (first >= count) {
        return not_found_refusal("organism", "get_population.first_organism", count, first,
                                 base::Reason::OrganismNotFound);
    }
    const auto genes = static_cast<std::size_t>(born.genes.rows());
    const std::size_t rows_max = std::max<std::size_t>(population_rows_max * evolution::body_gene_count / genes, 1);
    const base::Range ids{first, std::min(count, first + rows_max)};
    PopulationRows answer{.generation = world.moment().generation,
                          .generation_tick = world.moment().generation_tick,
                          .organism_count = static_cast<std::uint32_t>(count),
                          .first = query.first_organism(),
                          .genes = {},
                          .parents = {},
                          .founders = {},
                          .intentions = world.intentions(island, ids),
                          .lives = {},
                          .tick_s = world.parameters().active.tick_s,
                          .fitness = known_fitness(world, island, ids)};
    if (query.with_life() && world.has_bodies()) {
        const auto tick = static_cast<std::uint32_t>(world.moment().generation_tick);
        answer.lives.reserve(ids.end - ids.begin);
        for (std::size_t id = ids.begin; id < ids.end; ++id) {
            answer.lives.push_back(island.life(static_cast<std::uint32_t>(id), tick));
        }
    }
    answer.genes =
        born.genes.middleCols(static_cast<Eigen::Index>(ids.begin), static_cast<Eigen::Index>(ids.end - ids.begin));
    for (std::size_t id = ids.begin; id < ids.end && (!born.parents.empty() || island.has_births()); ++id) {
        answer.parents.push_back(shown_parents(island, static_cast<std::uint32_t>(id)));
    }
    if (const auto founders = world.islands().founders(island.index()); !founders.empty()) {
        answer.founders.assign(founders.begin() + ids.begin, founders.begin() + ids.end);
    }
    return answer;
}

v1::Population to_proto(const PopulationRows& rows) {
    v1::Population population;
    population.set_generation(rows.generation);
    population.set_generation_tick(rows.generation_tick);
    population.set_organism_count(rows.organism_count);
    population.set_first(rows.first);
    population.set_count(static_cast<std::uint32_t>(rows.genes.cols()));
    for (Eigen::Index gene = 0; gene < rows.genes.rows(); ++gene) {
        const Eigen::ArrayXf row = rows.genes.row(gene);
        const std::vector<float> values{row.begin(), row.end()};
        append_column(*population.mutable_genes(), values, [](float value) { return value; });
    }
    append_column(*population.mutable_parents(), rows.parents, [](const auto& parents) { return parents.first; });
    append_column(*population.mutable_parents(), rows.parents, [](const auto& parents) { return parents.second; });
    append_column(*population.mutable_founders(), rows.founders, [](std::uint32_t founder) { return founder; });
    using simulation::Intention;
    for (const Intention& intention : rows.intentions) {
        population.mutable_choices()->push_back(static_cast<char>(intention.choice));
    }
    const auto append = [&rows](std::string& bytes, auto of) { append_column(bytes, rows.intentions, of); };
    append(*population.mutable_forces(), [](const Intention& i) { return i.force_x; });
    append(*population.mutable_forces(), [](const Intention& i) { return i.force_y; });
    const auto px = [](physics::Coordinate units) { return static_cast<float>(physics::to_px(units)); };
    append(*population.mutable_targets(), [px](const Intention& i) { return px(i.target_x); });
    append(*population.mutable_targets(), [px](const Intention& i) { return px(i.target_y); });
    using Life = simulation::Island::Life;
    append_column(*population.mutable_lived_s(), rows.lives,
                  [&rows](const Life& life) { return life.lived_ticks * rows.tick_s; });
    append_column(*population.mutable_health(), rows.lives, [](const Life& life) { return life.health; });
    append_column(*population.mutable_food_eaten(), rows.lives, [](const Life& life) { return life.food_eaten; });
    append_column(*population.mutable_poison_eaten(), rows.lives, [](const Life& life) { return life.poison_eaten; });
    const std::size_t objectives = rows.fitness.size() / static_cast<std::size_t>(rows.genes.cols());
    for (std::size_t objective = 0; objective < objectives; ++objective) {
        std::vector<double> column;
        for (std::size_t i = objective; i < rows.fitness.size(); i += objectives) {
            column.push_back(rows.fitness[i]);
        }
        append_column(*population.mutable_objectives(), column, [](double number) { return number; });
    }
    return population;
}

base::Result<v1::Motion> get_motion(const simulation::Laboratory& laboratory, const v1::GetMotion& query) {
    const auto found = find_island(laboratory, query.world(), query.island(), "get_motion.island");
    if (!found) {
        return found.error();
    }
    const auto& [world, island] = *found;
    const parameters::Parameters& parameters = world.parameters().active;
    const auto report = island.motion_report(parameters);
    v1::Motion motion;
    motion.set_tick(world.moment().tick);
    motion.set_tick_s(parameters.tick_s);
    motion.set_body_count(report.body_count);
    motion.set_kinetic_energy(report.kinetic_energy);
    motion.set_momentum_x(report.momentum_x);
    motion.set_momentum_y(report.momentum_y);
    motion.set_touching_count(report.touching_count);
    motion.set_deepest_overlap_px(report.deepest_overlap_px);
    motion.set_deepest_overlap_share(report.deepest_overlap_share);
    motion.set_fastest_px_s(report.fastest_px_s);
    motion.set_fastest_step_share(report.fastest_step);
    motion.set_cell_px(report.strip_px);
    motion.set_too_fast_count(island.counts().too_fast_count);
    motion.set_speed_limit_count(island.counts().speed_limit_count);
    motion.set_generation_tick(world.moment().generation_tick);
    return motion;
}

base::Result<FoundWorld> find_world(const simulation::Laboratory& laboratory, const v1::Request& request) {
    if (request.has_subscribe_events() && !request.subscribe_events().has_world()) {
        return FoundWorld{};
    }
    const auto entry = laboratory.find(lookup_name(world_of(request)));
    if (!entry) {
        return entry.error();
    }
    const auto island_count = (*entry)->world.island_count();
    const v1::SubscribeSnapshots& snapshots = request.subscribe_snapshots();
    if (snapshots.has_island() && snapshots.island() >= island_count) {
        return not_found_refusal("island", "subscribe_snapshots.island", island_count, snapshots.island(),
                                 base::Reason::IslandNotFound);
    }
    return FoundWorld{(*entry)->name, island_count};
}

QueryResult answer_query(const v1::Request& request, const simulation::Laboratory& laboratory, bool users_only,
                         v1::Response& response) {
    const auto refuse = [&](const base::Refusal& refused) {
        *response.mutable_status() = to_proto(with_paths(refused, name_of(request)));
    };
    const auto put = [&]<class Message>(base::Result<Message> result, Message* (v1::Response::*field)()) {
        if (result) {
            *(response.*field)() = *std::move(result);
        } else {
            refuse(result.error());
        }
    };
    const auto later = [&]<class Part>(base::Result<Part> found) -> QueryResult {
        if (!found) {
            refuse(found.error());
            return {};
        }
        return *std::move(found);
    };
    switch (request.kind_case()) {
    case v1::Request::kListWorlds:
        *response.mutable_worlds() = list_worlds(laboratory);
        break;
    case v1::Request::kGetParameters:
        put(get_parameters(laboratory, request.get_parameters()), &v1::Response::mutable_parameters);
        if (const auto entry = laboratory.find(lookup_name(request.get_parameters().world()))) {
            add_warnings(response, (*entry)->world.parameters().requested);
        }
        break;
    case v1::Request::kGetStatistics:
        put(get_statistics(laboratory, request.get_statistics()), &v1::Response::mutable_statistics);
        break;
    case v1::Request::kGetOrganism:
        put(get_organism(laboratory, request.get_organism()), &v1::Response::mutable_organism);
        break;
    case v1::Request::kGetMotion:
        put(get_motion(laboratory, request.get_motion()), &v1::Response::mutable_motion);
        break;
    case v1::Request::kGetHistory:
        return later(get_history(laboratory, request.get_history(), users_only));
    case v1::Request::kObserve:
        return later(get_observed(laboratory, request.observe()));
    case v1::Request::kGetPopulation:
        return later(get_population(laboratory, request.get_population()));
    case v1::Request::kSubscribeSnapshots:
    case v1::Request::kSubscribeEvents:
    case v1::Request::kRenewLease:
        return later(find_world(laboratory, request));
    default:
        refuse(base::refusal(base::RefusalCode::Unimplemented, "not a query of the simulation",
                             base::Reason::RequestUnknown));
        break;
    }
    if (users_only) {
        keep_users_only(response);
    }
    return {};
}

void add_rows(const QueryResult& result, v1::Response& response) {
    if (const auto* part = std::get_if<HistoryPart>(&result)) {
        *response.mutable_history() = to_proto(*part);
    } else if (const auto* observed = std::get_if<ObservedHistory>(&result)) {
        if (auto answer = to_proto(*observed)) {
            *response.mutable_observations() = *std::move(answer);
        } else {
            *response.mutable_status() = to_proto(answer.error());
        }
    } else if (const auto* columns = std::get_if<PopulationRows>(&result)) {
        *response.mutable_population() = to_proto(*columns);
    }
}

std::size_t row_bytes(const QueryResult& result) {
    if (const auto* part = std::get_if<HistoryPart>(&result)) {
        std::size_t bytes = part->generations.size() * sizeof(simulation::GenerationRows);
        for (const simulation::Change& change : part->changes) {
            bytes += sizeof change + change.values.size() * sizeof(simulation::ChangedValue);
        }
        return bytes;
    }
    if (const auto* observed = std::get_if<ObservedHistory>(&result)) {
        return observed->history.size() * sizeof(simulation::GenerationRows) +
               observed->observations.size() * simulation::Observation::bytes_max *
                   sizeof(simulation::Observation::Node);
    }
    if (const auto* rows = std::get_if<PopulationRows>(&result)) {
        return static_cast<std::size_t>(rows->genes.size()) * sizeof(float) +
               rows->parents.size() * sizeof(evolution::Parents) + rows->founders.size() * sizeof(std::uint32_t) +
               rows->intentions.size() * sizeof(simulation::Intention) +
               rows->lives.size() * sizeof(simulation::Island::Life) + rows->fitness.size() * sizeof(double);
    }
    return 0;
}

} // namespace evod::protocol
