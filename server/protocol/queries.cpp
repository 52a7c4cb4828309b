#include "server/protocol/queries.h"

#include "server/protocol/commands.h"
#include "server/protocol/parameters.h"
#include "server/protocol/worlds.h"

#include <algorithm>
#include <limits>

namespace evod::protocol {
namespace {

base::Refusal no_such(const char* what, std::string field, std::uint64_t count, std::uint64_t got) {
    return {.code = base::RefusalCode::NotFound,
            .message = std::string{"there is no such "} + what,
            .violations = {
                {std::move(field), count == 0 ? "none" : "0 to " + std::to_string(count - 1), std::to_string(got)}}};
}

} // namespace

v1::WorldList list_worlds(const simulation::Laboratory& laboratory) {
    v1::WorldList list;
    for (const auto& entry : laboratory.entries())
        if (!entry->is_look_back())
            *list.add_worlds() = to_proto(*entry);
    return list;
}

base::Result<v1::ParameterSet> get_parameters(const simulation::Laboratory& laboratory,
                                              const v1::GetParameters& query) {
    const auto entry = laboratory.find(lookup_name(query.world()));
    if (!entry)
        return entry.error();
    return to_proto((*entry)->world.parameters());
}

base::Result<v1::Statistics> get_statistics(const simulation::Laboratory& laboratory, const v1::GetStatistics& query) {
    const auto entry = laboratory.find(lookup_name(query.world()));
    if (!entry)
        return entry.error();
    const simulation::World& world = (*entry)->world;
    v1::Statistics statistics;
    *statistics.mutable_world() = to_proto(**entry);
    if (world.has_bodies())
        for (const simulation::Island& island : world.islands())
            *statistics.add_live() = to_proto(island.live_statistics(), island.index());
    if (!world.history().empty())
        for (const auto& last : world.history().back())
            *statistics.add_last() = to_proto(last);
    return statistics;
}

base::Result<v1::OrganismInfo> get_organism(const simulation::Laboratory& laboratory, const v1::GetOrganism& query) {
    const auto entry = laboratory.find(lookup_name(query.world()));
    if (!entry)
        return entry.error();
    const simulation::World& world = (*entry)->world;
    if (query.island() >= world.islands().size())
        return no_such("island", "get_organism.island", world.islands().size(), query.island());
    const simulation::Island& island = world.islands()[query.island()];
    const auto born = static_cast<std::uint64_t>(island.born().genes.cols());
    if (query.organism() >= born)
        return no_such("organism", "get_organism.organism", born, query.organism());
    return organism_info(world, island, query.organism());
}

base::Result<HistoryPart> get_history(const simulation::Laboratory& laboratory, const v1::GetHistory& query) {
    const auto entry = laboratory.find(lookup_name(query.world()));
    if (!entry)
        return entry.error();
    const simulation::World& world = (*entry)->world;
    if (query.has_island() && query.island() >= world.islands().size())
        return no_such("island", "get_history.island", world.islands().size(), query.island());

    HistoryPart answer;
    if (query.has_island())
        answer.island = query.island();
    const auto& history = world.history();
    const std::uint64_t first = query.has_first_generation() ? query.first_generation() : 0;
    const std::uint64_t last =
        query.has_last_generation() ? query.last_generation() : std::numeric_limits<std::uint64_t>::max();
    answer.begins_late = history.size() == simulation::World::history_generations_kept &&
                         std::max<std::uint64_t>(first, 1) < history.front().front().generation;
    auto generation = std::partition_point(history.begin(), history.end(),
                                           [first](const auto& rows) { return rows.front().generation < first; });
    std::size_t count = 0;
    for (; generation != history.end() && generation->front().generation <= last; ++generation) {
        count += query.has_island() ? 1 : generation->size();
        if (!answer.generations.empty() && count > history_statistics_max) {
            answer.next_generation = generation->front().generation;
            break;
        }
        answer.generations.push_back(*generation);
    }
    return answer;
}

v1::History to_proto(const HistoryPart& part) {
    v1::History history;
    for (const simulation::GenerationRows& rows : part.generations)
        for (const simulation::GenerationStatistics& row : rows)
            if (!part.island || row.island == *part.island)
                *history.add_generations() = to_proto(row);
    if (part.next_generation)
        history.set_next_generation(*part.next_generation);
    return history;
}

base::Result<Watched> find_watched(const simulation::Laboratory& laboratory, const v1::SubscribeSnapshots& request) {
    const auto entry = laboratory.find(lookup_name(request.world()));
    if (!entry)
        return entry.error();
    const auto island_count = static_cast<std::uint32_t>((*entry)->world.islands().size());
    if (request.has_island() && request.island() >= island_count)
        return no_such("island", "subscribe_snapshots.island", island_count, request.island());
    return Watched{(*entry)->name, island_count};
}

} // namespace evod::protocol
