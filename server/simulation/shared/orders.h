// Orders: what rank 0 has the other processes do with their islands of a world, and the fields of what they send each
// other.
//
// The fields of each struct are declared once, for packing and for unpacking (base/packing.h); a struct of numbers
// needs no declaration. IslandState has bytes of its own (state_bytes.h).
#pragma once

#include "server/base/packing.h"
#include "server/simulation/local_islands.h"
#include "server/simulation/state_bytes.h"

#include <cstdint>
#include <span>
#include <string>
#include <type_traits>
#include <variant>
#include <vector>

namespace evod::base {

template <>
struct Fields<evolution::FreeGene> {
    static void visit(auto& gene, auto&& each) {
        each(gene.name, gene.kind, gene.min, gene.max, gene.step, gene.logarithmic, gene.mutation_step, gene.choices,
             gene.count);
    }
};
template <>
struct Fields<evolution::FreeGenes> {
    static void visit(auto& genes, auto&& each) {
        std::vector<evolution::FreeGene> list = genes.list();
        each(list);
        if constexpr (!std::is_const_v<std::remove_reference_t<decltype(genes)>>) {
            genes = evolution::FreeGenes{std::move(list)};
        }
    }
};
template <>
struct Fields<parameters::Parameters> {
    static void visit(auto& parameters, auto&& each) {
#define EVOD_NO_VISIT(topic)
#define EVOD_VISIT(name, ...) each(parameters.name);
        EVOD_FITNESS_PARAMETERS(EVOD_NO_VISIT, EVOD_VISIT, EVOD_VISIT, EVOD_VISIT, EVOD_VISIT)
        EVOD_EVOLUTION_PARAMETERS(EVOD_NO_VISIT, EVOD_VISIT, EVOD_VISIT, EVOD_VISIT, EVOD_VISIT)
        EVOD_MODEL_PARAMETERS(EVOD_NO_VISIT, EVOD_VISIT, EVOD_VISIT, EVOD_VISIT, EVOD_VISIT)
#undef EVOD_NO_VISIT
#undef EVOD_VISIT
        each(parameters.listed_genes);
    }
};
template <>
struct Fields<evolution::GeneMatrix> {
    static void visit(auto& genes, auto&& each) {
        auto rows = static_cast<std::int64_t>(genes.rows()), columns = static_cast<std::int64_t>(genes.cols());
        each(rows, columns);
        if constexpr (!std::is_const_v<std::remove_reference_t<decltype(genes)>>) {
            genes.resize(rows, columns);
        }
        each(std::span{genes.data(), static_cast<std::size_t>(genes.size())});
    }
};
template <>
struct Fields<evolution::NextGeneration> {
    static void visit(auto& generation, auto&& each) {
        each(generation.genes, generation.parents, generation.elite_count, generation.survivor_count,
             generation.clamped_count, generation.account, generation.predator_count, generation.predator_account);
    }
};
template <>
struct Fields<simulation::GenerationStatistics> {
    static void visit(auto& statistics, auto&& each) {
        for_each_number(statistics, [&](const char*, auto& number) { each(number); });
        bool has_colony = statistics.colony.has_value();
        each(statistics.genes, statistics.account, has_colony);
        if constexpr (!std::is_const_v<std::remove_reference_t<decltype(statistics)>>) {
            statistics.colony = has_colony ? std::optional{simulation::ColonyStatistics{}} : std::nullopt;
        }
        if (has_colony) { // number by number: equal statistics have equal bytes
            for_each_colony_number(*statistics.colony, [&](const char*, auto& number) { each(number); });
        }
        each(statistics.predators);
    }
};
template <>
struct Fields<simulation::IslandOutcome> {
    static void visit(auto& outcome, auto&& each) {
        each(outcome.fitness, outcome.objectives, outcome.repaired, outcome.lived_ticks, outcome.cause, outcome.births);
    }
};
template <>
struct Fields<simulation::Rating> {
    static void visit(auto& rating, auto&& each) { each(rating.fitness, rating.genes); }
};
template <>
struct Fields<simulation::IslandOpening> {
    static void visit(auto& opening, auto&& each) {
        std::string bytes;
        if constexpr (std::is_const_v<std::remove_reference_t<decltype(opening)>>) {
            bytes = bytes_of_opening(opening);
        }
        each(bytes);
        if constexpr (!std::is_const_v<std::remove_reference_t<decltype(opening)>>) {
            auto read = simulation::read_opening(bytes);
            EVOD_ASSERT(read.has_value());
            opening = *std::move(read);
        }
    }
};
template <>
struct Fields<simulation::BredIslands> {
    static void visit(auto& bred, auto&& each) { each(bred.islands, bred.founders, bred.openings); }
};
template <>
struct Fields<simulation::Migrants> {
    static void visit(auto& migrants, auto&& each) { each(migrants.fitness, migrants.founders, migrants.genes); }
};
template <>
struct Fields<simulation::EntityIds> {
    static void visit(auto& ids, auto&& each) { each(ids.food, ids.poison, ids.organisms); }
};
// Commands without the names of their worlds.
template <>
struct Fields<simulation::PlaceEntities> {
    static void visit(auto& command, auto&& each) { each(command.island, command.items, command.organisms); }
};
template <>
struct Fields<simulation::PlaceEntities::Organism> {
    static void visit(auto& organism, auto&& each) { each(organism.x_px, organism.y_px, organism.genes); }
};
template <>
struct Fields<simulation::RemoveEntities> {
    static void visit(auto& command, auto&& each) {
        each(command.island, command.food, command.poison, command.organisms);
    }
};

} // namespace evod::base

namespace evod::simulation::shared {

/// Creates the islands of a new world. Scattered, if is_given: their organisms.
struct Begin {
    base::Seed seed;
    std::uint64_t generation;
    parameters::Parameters parameters; // as after UseParameters
    bool is_given;                     // otherwise the organisms are drawn from the seed
    static void visit(auto& order, auto&& each) {
        each(order.seed, order.generation, order.parameters, order.is_given);
    }
};
/// The orders that follow use these parameters.
struct UseParameters {
    parameters::Parameters parameters;
    static void visit(auto& order, auto&& each) { each(order.parameters); }
};
/// Islands::restore(). Scattered: the states of the islands.
struct Restore {
    std::uint32_t tick;                // of the generation
    parameters::Parameters parameters; // those of the state
    static void visit(auto& order, auto&& each) { each(order.tick, order.parameters); }
};
struct Advance {
    GenerationTicks ticks;
};
/// Scattered, if is_given: what clients have given.
struct EndGeneration {
    std::uint32_t tick;
    bool is_given;
};
struct TurnOver {
    std::uint64_t generation;
    std::uint32_t tick;
    Routes routes;
    static void visit(auto& order, auto&& each) {
        each(order.generation, order.tick, order.routes.prey, order.routes.predators);
    }
};
struct Place {
    PlaceEntities command;
    std::uint32_t tick;
    static void visit(auto& order, auto&& each) { each(order.command, order.tick); }
};
struct Remove {
    RemoveEntities command;
    std::uint32_t tick;
    static void visit(auto& order, auto&& each) { each(order.command, order.tick); }
};
/// Sends islands to rank 0.
struct Bring {
    struct Island {
        std::uint32_t index;
        bool with_organisms; // rank 0 does not have the organisms of this generation yet
    };
    std::vector<Island> islands;
    static void visit(auto& order, auto&& each) { each(order.islands); }
};
// The functions of Islands with these names.
struct Bred {};
struct Outcomes {};
struct States {};
struct LiveStatisticsOfAll {};
/// The other processes follow no more.
struct End {};

using Order = std::variant<Begin, UseParameters, Restore, Advance, EndGeneration, TurnOver, Place, Remove, Bring, Bred,
                           Outcomes, States, LiveStatisticsOfAll, End>;

struct Message {
    std::vector<std::uint64_t> dropped; // worlds that have ended since the previous message
    std::uint64_t world = 0;            // the world that the order is about; for End, none
    Order order;
    static void visit(auto& message, auto&& each) { each(message.dropped, message.world, message.order); }
};

/// The results of an order that every process sends to all others.
struct ExchangedResults {
    bool fits = true;                   // memory suffices
    std::uint32_t tick = 0;             // Advance: the last tick that was performed
    std::vector<DiedOut> died_out = {}; // Advance
    EntityIds placed = {};              // Place, from the process that has the island
    std::vector<IslandSummary> summaries = {};
    static void visit(auto& results, auto&& each) {
        each(results.fits, results.tick, results.died_out, results.placed, results.summaries);
    }
};
/// An island as rank 0 gets it.
struct SentIsland {
    std::vector<evolution::NextGeneration> bred; // one element, or none if rank 0 has the organisms
    std::vector<IslandOpening> opening;          // with births; one element, or none, too
    std::vector<std::uint32_t> founders;
    std::string state; // state_bytes.h
    static void visit(auto& island, auto&& each) { each(island.bred, island.opening, island.founders, island.state); }
};

} // namespace evod::simulation::shared
