// What the processes that share a world order and exchange (sharing.h).
#include "server/base/assert.h"
#include "server/base/inline_executor.h"
#include "server/simulation/packed.h"
#include "server/simulation/world.h"

#include <algorithm>
#include <type_traits>
#include <utility>

namespace evod::simulation {

static_assert(std::is_trivially_copyable_v<Opening>);

namespace {

/// Sends something of every island from rank 0 to the process that simulates it.
///
/// pack  pack(packer, island)
template <class Pack>
void scatter_islands(base::Exchange& exchange, std::size_t island_count, Pack&& pack) {
    std::vector<std::string> parts(exchange.size());
    for (std::uint32_t rank = 1; rank < exchange.size(); ++rank) {
        base::Packer packer;
        const base::Range share = share_of(island_count, rank, exchange.size());
        for (std::size_t island = share.begin; island < share.end; ++island) {
            pack(packer, island);
        }
        parts[rank] = packer.take();
    }
    exchange.swap(std::move(parts));
}

/// Receives, in the other processes, what scatter_islands() sends.
///
/// unpack  unpack(unpacker, island)
template <class Unpack>
void receive_islands(base::Exchange& exchange, std::size_t island_count, Unpack&& unpack) {
    const std::string part = exchange.swap(std::vector<std::string>(exchange.size())).front();
    base::Unpacker unpacker{part};
    const base::Range share = share_of(island_count, exchange.rank(), exchange.size());
    for (std::size_t island = share.begin; island < share.end; ++island) {
        unpack(unpacker, island);
    }
}

} // namespace

void World::order_creation() const {
    if (sharing_.leader() == nullptr) {
        return;
    }
    sharing_.order(Order::Create, [&](base::Packer& order) {
        order.add(parameters_);
        order.add(seed_);
        order.add(first_population_ != nullptr);
        pack(order, schedule_);
    });
    if (first_population_) {
        scatter_islands(sharing_.exchange(), first_population_->size(), [&](base::Packer& packer, std::size_t island) {
            pack(packer, {.genes = (*first_population_)[island], .parents = {}});
        });
    }
}

World World::created(base::Unpacker& order, base::Exchange& exchange) {
    const auto set = order.next<parameters::ParameterSet>();
    const auto seed = order.next<base::Seed>();
    const bool population_given = order.next<bool>();
    parameters::Schedule schedule = unpack_schedule(order);
    FirstPopulation population;
    if (population_given) {
        std::vector<evolution::GeneMatrix> islands(set.active.island_count);
        receive_islands(exchange, islands.size(), [&](base::Unpacker& unpacker, std::size_t island) {
            islands[island] = unpack_generation(unpacker).genes;
        });
        population = std::make_shared<const std::vector<evolution::GeneMatrix>>(std::move(islands));
    }
    return {set, seed, std::move(population), std::move(schedule), Sharing{exchange}};
}

void World::order_opening(const std::vector<evolution::NextGeneration>& born, const Founders& founders) const {
    if (sharing_.leader() == nullptr) {
        return;
    }
    sharing_.order(Order::Open, [&](base::Packer& order) {
        order.add(seed_);
        order.add(Opening{moment_, parameters_, progress_});
        order.add(!founders.empty());
        pack(order, schedule_);
    });
    scatter_islands(sharing_.exchange(), born.size(), [&](base::Packer& packer, std::size_t island) {
        pack(packer, born[island]);
        if (!founders.empty()) {
            packer.add_list(founders[island]);
        }
    });
}

World World::opened(base::Unpacker& order, base::Exchange& exchange, base::Executor& executor) {
    const auto seed = order.next<base::Seed>();
    const auto opening = order.next<Opening>();
    const bool founders_known = order.next<bool>();
    parameters::Schedule schedule = unpack_schedule(order);
    std::vector<evolution::NextGeneration> born(opening.parameters.active.island_count);
    Founders founders(founders_known ? born.size() : 0);
    receive_islands(exchange, born.size(), [&](base::Unpacker& unpacker, std::size_t island) {
        born[island] = unpack_generation(unpacker);
        if (founders_known) {
            unpacker.next_list(founders[island]);
        }
    });
    return {seed,
            opening,
            std::move(born),
            {}, // rank 0 has the history
            executor,
            {},
            std::move(founders),
            std::move(schedule),
            Sharing{exchange}};
}

void World::restore_shared(const WorldState& state, base::Executor& executor) {
    if (is_shared()) {
        sharing_.order(Order::Restore, [&](base::Packer& order) {
            order.add(state.moment);
            order.add(state.parameters);
            order.add(std::uint64_t{state.ended.size()});
            for (const GenerationStatistics& island : state.ended) {
                pack(order, island);
            }
            order.add(std::uint64_t{state.given_fitness.size()});
            for (const std::vector<double>& island : state.given_fitness) {
                order.add_list(island);
            }
        });
        scatter_islands(sharing_.exchange(), islands_.size(),
                        [&](base::Packer& packer, std::size_t island) { pack(packer, state.islands[island]); });
    }
    apply_state(state, executor);
}

void World::restore_share(base::Unpacker& order, base::Executor& executor) {
    WorldState state;
    state.moment = order.next<Moment>();
    state.parameters = order.next<parameters::ParameterSet>();
    state.ended.resize(order.next<std::uint64_t>());
    for (GenerationStatistics& island : state.ended) {
        island = unpack_statistics(order);
    }
    state.given_fitness.resize(order.next<std::uint64_t>());
    for (std::vector<double>& island : state.given_fitness) {
        order.next_list(island);
    }
    state.islands.resize(islands_.size());
    receive_islands(sharing_.exchange(), islands_.size(), [&](base::Unpacker& unpacker, std::size_t island) {
        state.islands[island] = unpack_island_state(unpacker);
    });
    apply_state(state, executor);
}

void World::set_planned(std::vector<parameters::PlannedChange> planned, std::uint64_t planned_count) {
    sharing_.order(Order::SetPlanned, [&](base::Packer& order) {
        order.add(std::uint64_t{planned.size()});
        for (const parameters::PlannedChange& change : planned) {
            pack(order, change);
        }
        order.add(planned_count);
    });
    planned_ = std::move(planned);
    planned_count_ = planned_count;
}

void World::bring(std::span<const std::uint32_t> islands) const {
    std::vector<WantedIsland> wanted;
    for (const std::uint32_t island : islands) {
        const auto here = brought_.find(island);
        if (!is_mine(island) && (here == brought_.end() || here->second.tick != moment_.tick)) {
            wanted.push_back({.island = island, .with_organisms = here == brought_.end()});
        }
    }
    if (wanted.empty()) {
        return;
    }
    EVOD_ASSERT(sharing_.leader() != nullptr);
    sharing_.order(Order::Bring, [&](base::Packer& order) { order.add_list(wanted); });
    const std::vector<std::string> parts = sharing_.exchange().collect({});
    std::vector<base::Unpacker> received(parts.begin(), parts.end());
    for (const WantedIsland& island : wanted) {
        receive(island, received[rank_of(islands_.size(), island.island, sharing_.exchange().size())]);
    }
}

void World::receive(const WantedIsland& wanted, base::Unpacker& unpacker) const {
    base::InlineExecutor executor; // a reader has none
    if (wanted.with_organisms) {
        Island begun{seed_, wanted.island};
        begun.begin_generation(opening_.parameters.active, moment_.generation, unpack_generation(unpacker), executor);
        brought_.emplace(wanted.island, BroughtIsland{.begun = begun, .now = begun, .tick = 0, .founders = {}});
    }
    BroughtIsland& here = brought_.at(wanted.island);
    here.now = here.begun;
    unpacker.next_list(here.founders);
    here.now.restore(unpack_island_state(unpacker), static_cast<std::uint32_t>(moment_.generation_tick),
                     opening_.parameters.active, executor);
    EVOD_ASSERT(here.now.hash() == summaries_[wanted.island].hash);
    here.tick = moment_.tick;
}

void World::send_islands(std::span<const WantedIsland> islands) const {
    base::InlineExecutor executor;
    base::Packer packer;
    for (const auto& [island, with_organisms] : islands) {
        if (!is_mine(island)) {
            continue;
        }
        if (with_organisms) {
            pack(packer, islands_[island].bred());
        }
        packer.add_list(founders_.empty() ? std::vector<std::uint32_t>{} : founders_[island]);
        pack(packer, islands_[island].state(executor));
    }
    sharing_.exchange().collect(packer.take());
}

World::BroughtIsland& World::brought(std::size_t island) const {
    const auto index = static_cast<std::uint32_t>(island);
    bring({&index, 1});
    return brought_.at(island);
}

Island* World::island_here(std::size_t island) {
    return is_mine(island) ? &islands_[island] : sharing_.leader() != nullptr ? &brought(island).now : nullptr;
}

std::span<const std::uint32_t> World::founders(const Island& island) const {
    if (founders_.empty()) {
        return {};
    }
    return is_mine(island.index()) ? founders_[island.index()] : brought(island.index()).founders;
}

BredIslands World::bred() const {
    sharing_.order(Order::Bred);
    BredIslands bred{.islands = {}, .founders = founders_};
    for (std::size_t i = 0; i < islands_.size(); ++i) {
        bred.islands.push_back(islands_[i].bred());
        if (is_mine(i) && !founders_.empty()) {
            bred.founders[i].resize(islands_[i].bred_count());
        }
    }
    collect_islands(
        sharing_.exchange(), share_,
        [&](base::Packer& packer, std::size_t island) {
            pack(packer, bred.islands[island]);
            if (!bred.founders.empty()) {
                packer.add_list(bred.founders[island]);
            }
        },
        [&](base::Unpacker& unpacker, std::size_t island) {
            bred.islands[island] = unpack_generation(unpacker);
            if (!bred.founders.empty()) {
                unpacker.next_list(bred.founders[island]);
            }
        });
    return bred;
}

std::vector<IslandOutcome> World::outcomes() const {
    EVOD_ASSERT(generation_over_);
    sharing_.order(Order::Outcomes);
    std::vector<IslandOutcome> outcomes(islands_.size());
    for (std::size_t i = share_.begin; i < share_.end; ++i) {
        const Fate& fate = islands_[i].fate();
        outcomes[i] = {fitness_[i], fate.lived_ticks, fate.cause};
    }
    collect_islands(
        sharing_.exchange(), share_,
        [&](base::Packer& packer, std::size_t island) {
            packer.add_list(outcomes[island].fitness);
            packer.add_list(outcomes[island].lived_ticks);
            packer.add_list(outcomes[island].cause);
        },
        [&](base::Unpacker& unpacker, std::size_t island) {
            unpacker.next_list(outcomes[island].fitness);
            unpacker.next_list(outcomes[island].lived_ticks);
            unpacker.next_list(outcomes[island].cause);
        });
    return outcomes;
}

std::vector<LiveStatistics> World::live_statistics() const {
    sharing_.order(Order::LiveStatistics);
    std::vector<LiveStatistics> statistics(islands_.size());
    for (std::size_t i = share_.begin; i < share_.end; ++i) {
        statistics[i] = islands_[i].live_statistics();
    }
    collect_islands(
        sharing_.exchange(), share_, [&](base::Packer& packer, std::size_t island) { packer.add(statistics[island]); },
        [&](base::Unpacker& unpacker, std::size_t island) { statistics[island] = unpacker.next<LiveStatistics>(); });
    return statistics;
}

void World::migrate(std::span<const evolution::MigrationRoute> routes, std::vector<evolution::GeneMatrix>& migrated) {
    const parameters::Parameters& p = parameters_.active;
    std::vector<evolution::Ranking> rankings(fitness_.begin(), fitness_.end());
    const auto process_of = [&](std::uint32_t island) {
        return rank_of(islands_.size(), island, sharing_.exchange().size());
    };
    // A migrant: its fitness, its founder and its genes. The order of routes states which migrants these are.
    std::vector<base::Packer> sent(sharing_.exchange().size());
    for (const evolution::MigrationRoute& route : routes) {
        if (!is_mine(route.from)) {
            continue;
        }
        base::Packer& parcel = sent[process_of(route.to)];
        for (const std::uint32_t organism :
             evolution::emigrants(route, rankings[route.from], p, seed_, moment_.generation)) {
            parcel.add(fitness_[route.from][organism]);
            parcel.add(founders_.empty() ? no_founder : founders_[route.from][organism]);
            const auto genes = migrated[route.from].col(organism);
            parcel.add_values(std::span{genes.data(), static_cast<std::size_t>(genes.size())});
        }
    }
    std::vector<std::string> parcels;
    for (base::Packer& parcel : sent) {
        parcels.push_back(parcel.take());
    }
    parcels = sharing_.exchange().swap(std::move(parcels));
    std::vector<base::Unpacker> received(parcels.begin(), parcels.end());
    std::vector<std::uint32_t> replaced; // on the island `to` of the previous route
    std::uint32_t to = ~0U;
    for (const evolution::MigrationRoute& route : routes) { // ordered by (to, from)
        if (!is_mine(route.to)) {
            continue;
        }
        if (std::exchange(to, route.to) != route.to) {
            replaced = evolution::replaced_first(to, rankings[to], p, seed_, moment_.generation);
        }
        base::Unpacker& parcel = received[process_of(route.from)];
        for (std::uint32_t migrant = 0; migrant < route.count; ++migrant) {
            const std::uint32_t place = replaced[route.first_place + migrant];
            fitness_[to][place] = parcel.next<double>();
            const auto founder = parcel.next<std::uint32_t>();
            if (!founders_.empty()) {
                founders_[to][place] = founder;
            }
            auto genes = migrated[to].col(place);
            parcel.next_values(std::span{genes.data(), static_cast<std::size_t>(genes.size())});
        }
    }
}

void World::meet(base::Executor& executor) {
    base::Packer packer;
    packer.add(moment_.tick);
    packer.add_list(std::exchange(died_out_since_meeting_, {}));
    packer.add_list(summaries_of_share());
    std::uint64_t last = 0;
    std::vector<DiedOut> died_out;
    auto summary = summaries_.begin();
    for (const std::string& part : sharing_.exchange().gather(packer.take())) { // in order of islands
        base::Unpacker unpacker{part};
        last = std::max(last, unpacker.next<std::uint64_t>());
        const auto there = unpacker.next_list<DiedOut>();
        died_out.insert(died_out.end(), there.begin(), there.end());
        summary = std::ranges::copy(unpacker.next_list<IslandSummary>(), summary).out;
    }
    // A process whose organisms have all died has stopped early. Its islands do not change until the others stop.
    while (moment_.tick < last) {
        apply_planned_now();
        advance_share(executor);
    }
    std::ranges::stable_sort(died_out, {}, &DiedOut::tick);
    for (const DiedOut& island : died_out) {
        events_.push_back(Extinction{.island = island.island, .generation = moment_.generation, .tick = island.tick});
    }
}

std::vector<IslandSummary> World::summaries_of_share() const {
    std::vector<IslandSummary> summaries;
    for (std::size_t i = share_.begin; i < share_.end; ++i) {
        summaries.push_back({.hash = islands_[i].hash(),
                             .alive_count = islands_[i].alive_count(),
                             .organism_count = organism_count(i),
                             .is_as_begun = moment_.generation_tick == 0 && islands_[i].is_as_begun()});
    }
    return summaries;
}

void World::exchange_summaries(bool fits) {
    if (!is_shared()) {
        return;
    }
    base::Packer packer;
    packer.add(fits);
    packer.add_list(fits ? summaries_of_share() : std::vector<IslandSummary>(share_.end - share_.begin));
    auto summary = summaries_.begin();
    for (const std::string& part : sharing_.exchange().gather(packer.take())) {
        base::Unpacker unpacker{part};
        fits &= unpacker.next<bool>();
        summary = std::ranges::copy(unpacker.next_list<IslandSummary>(), summary).out;
    }
    if (!fits) {
        throw TooLargeToShare{};
    }
}

std::uint32_t World::organism_count(std::size_t island) const {
    return is_mine(island) ? static_cast<std::uint32_t>(islands_[island].born().genes.cols())
                           : summaries_[island].organism_count;
}

} // namespace evod::simulation
