#include "server/simulation/shared/part.h"

#include "server/base/assert.h"
#include "server/base/inline_executor.h"
#include "server/simulation/shared/share.h"
#include "server/simulation/state_bytes.h"

#include <algorithm>
#include <iterator>
#include <new>
#include <string>
#include <utility>

namespace evod::simulation::shared {
namespace {

/// Sends each rank what rank 0 passes for it, by rank. Returns that of this process.
template <class T>
T scatter(base::Exchange& exchange, std::vector<T> for_each_rank) {
    std::vector<std::string> parts(exchange.size());
    for (std::size_t rank = 1; exchange.rank() == 0 && rank < for_each_rank.size(); ++rank) {
        parts[rank] = base::pack(for_each_rank[rank]);
    }
    parts = exchange.swap(std::move(parts));
    return exchange.rank() == 0 ? std::move(for_each_rank.front()) : base::unpack<T>(parts.front());
}

/// Returns on rank 0 what all ranks pass, by rank; an empty vector on the others.
template <class T>
std::vector<T> collect(base::Exchange& exchange, T mine) {
    const bool is_first = exchange.rank() == 0;
    std::vector<std::string> parts = exchange.collect(is_first ? std::string{} : base::pack(mine));
    std::vector<T> all;
    for (std::size_t rank = 0; rank < parts.size(); ++rank) {
        all.push_back(rank == 0 ? std::move(mine) : base::unpack<T>(std::exchange(parts[rank], {})));
    }
    return all;
}

/// Returns what all ranks pass, by rank.
template <class T>
std::vector<T> gather(base::Exchange& exchange, const T& mine) {
    std::vector<T> all;
    for (const std::string& part : exchange.gather(base::pack(mine))) {
        all.push_back(base::unpack<T>(part));
    }
    return all;
}

/// Returns the elements of all lists, in their order.
template <class T>
std::vector<T> joined(std::vector<std::vector<T>> lists) {
    std::vector<T> all;
    for (std::vector<T>& list : lists) {
        std::ranges::move(list, std::back_inserter(all));
    }
    return all;
}

std::string bytes_of(const WorldState& state) {
    std::string bytes;
    bytes.reserve(bytes_of_state(state));
    write_state(state, [&](std::string_view piece) { bytes += piece; });
    return bytes;
}

WorldState state_of(std::string_view bytes, std::span<const IslandShape> shapes) {
    WorldState state{.moment = {}, .parameters = {}, .islands = {}, .ended = {}};
    const auto read = read_state(bytes, shapes, state);
    EVOD_ASSERT(read.has_value());
    return state;
}

/// The states of the islands of a process.
struct PartOfState {
    std::vector<IslandShape> shapes;
    std::string bytes;
    static void visit(auto& part, auto&& each) { each(part.shapes, part.bytes); }
};

/// The migrants of one route.
struct Travellers {
    std::uint64_t route;
    Migrants migrants;
    static void visit(auto& travellers, auto&& each) { each(travellers.route, travellers.migrants); }
};

} // namespace

Part::Part(base::Exchange& exchange, base::Seed seed, std::uint32_t island_count)
    : exchange_{exchange}
    , island_count_{island_count}
    , share_{share_of(island_count, exchange.rank(), exchange.size())}
    , islands_{seed, share_}
    , summaries_(island_count) {}

std::uint32_t Part::rank_of_island(std::size_t island) const {
    return rank_of(island_count_, island, exchange_.size());
}

template <class T>
std::vector<std::vector<T>> Part::divide(std::vector<T> of_all) const {
    std::vector<std::vector<T>> lists(exchange_.size());
    for (std::size_t island = 0; island < of_all.size(); ++island) {
        lists[rank_of_island(island)].push_back(std::move(of_all[island]));
    }
    return lists;
}

ExchangedResults Part::exchange_results(ExchangedResults own) {
    own.summaries.assign(islands_.summaries().begin(), islands_.summaries().end());
    ExchangedResults all;
    for (ExchangedResults& part : gather(exchange_, own)) {
        all.fits &= part.fits;
        all.tick = std::max(all.tick, part.tick);
        std::ranges::copy(part.died_out, std::back_inserter(all.died_out));
        std::ranges::copy(part.summaries, std::back_inserter(all.summaries));
        if (!(part.placed == EntityIds{})) {
            all.placed = std::move(part.placed);
        }
    }
    std::ranges::stable_sort(all.died_out, {}, &DiedOut::tick);
    summaries_ = all.summaries;
    return all;
}

bool Part::perform(const Begin& order, base::Executor& executor, BredIslands bred) {
    parameters_ = order.parameters;
    bool fits = true;
    try {
        BredIslands own;
        if (order.is_given) {
            auto islands = divide(std::move(bred.islands));
            auto founders = divide(std::move(bred.founders));
            auto openings = divide(std::move(bred.openings));
            std::vector<BredIslands> parts;
            for (std::uint32_t rank = 0; rank < exchange_.size(); ++rank) {
                parts.push_back({std::move(islands[rank]), std::move(founders[rank]), std::move(openings[rank])});
            }
            own = scatter(exchange_, std::move(parts));
        }
        islands_.begin_generation(parameters_, order.generation, std::move(own), executor);
    } catch (const std::bad_alloc&) {
        fits = false; // the other processes have to learn it
    }
    return exchange_results({.fits = fits}).fits;
}

void Part::perform(const Restore& order, base::Executor& executor, const WorldState& state) {
    const auto islands = divide(state.islands);
    const auto ended = divide(state.ended);
    const auto given = divide(state.ratings);
    std::vector<std::string> parts;
    for (std::uint32_t rank = 0; is_first() && rank < exchange_.size(); ++rank) {
        WorldState part;
        part.parameters.active = order.parameters;
        part.islands = islands[rank];
        part.ended = ended[rank];
        part.ratings = given[rank];
        parts.push_back(bytes_of(part));
    }
    WorldState own = state_of(scatter(exchange_, std::move(parts)), shapes());
    own.moment.generation_tick = order.tick;
    own.parameters.active = order.parameters;
    islands_.restore(parameters_, own, executor);
    (void)exchange_results();
}

std::vector<IslandShape> Part::shapes() const {
    std::vector<IslandShape> shapes;
    for (std::size_t island = share_.begin; island < share_.end; ++island) {
        shapes.push_back(islands_.island(island).shape());
    }
    return shapes;
}

ExchangedResults Part::perform(const Advance& order, base::Executor& executor) {
    ExchangedResults own;
    // A process whose organisms have all died stops early. Its islands would not change in the other ticks.
    own.tick = islands_.advance(parameters_, order.ticks, executor, own.died_out).tick;
    return exchange_results(std::move(own));
}

std::vector<GenerationStatistics> Part::perform(const EndGeneration& order, base::Executor& executor,
                                                std::span<const Rating> given) {
    std::vector<Rating> own;
    if (order.is_given) {
        own = scatter(exchange_, divide(std::vector(given.begin(), given.end())));
    }
    return joined(gather(exchange_, islands_.end_generation(parameters_, order.tick, own, executor)));
}

bool Part::perform(const TurnOver& order, base::Executor& executor) {
    bool fits = true;
    int exchanges_left = (order.routes.prey.empty() ? 0 : 1) + (order.routes.predators.empty() ? 0 : 1);
    try {
        islands_.breed_next_generation(
            parameters_, order.generation, order.tick, order.routes, executor,
            [&](std::span<const evolution::MigrationRoute> routes, std::vector<Migrants>& migrants) {
                carry(routes, migrants);
                --exchanges_left;
            });
    } catch (const std::bad_alloc&) {
        if (exchanges_left > 0) {
            throw; // the others wait for migrants
        }
        fits = false;
    }
    return exchange_results({.fits = fits}).fits;
}

void Part::carry(std::span<const evolution::MigrationRoute> routes, std::vector<Migrants>& migrants) const {
    std::vector<std::vector<Travellers>> sent(exchange_.size());
    for (std::size_t route = 0; route < routes.size(); ++route) {
        if (islands_.holds(routes[route].from) && !islands_.holds(routes[route].to)) {
            sent[rank_of_island(routes[route].to)].push_back({route, std::move(migrants[route])});
        }
    }
    std::vector<std::string> parcels;
    for (const std::vector<Travellers>& parcel : sent) {
        parcels.push_back(base::pack(parcel));
    }
    for (const std::string& parcel : exchange_.swap(std::move(parcels))) {
        for (Travellers& arrived : base::unpack<std::vector<Travellers>>(parcel)) {
            migrants.at(arrived.route) = std::move(arrived.migrants);
        }
    }
}

EntityIds Part::perform(const Place& order) {
    ExchangedResults own;
    if (islands_.holds(order.command.island)) {
        own.placed = islands_.place(order.command, parameters_, order.tick);
    }
    return exchange_results(std::move(own)).placed;
}

void Part::perform(const Remove& order) {
    if (islands_.holds(order.command.island)) {
        islands_.remove(order.command, order.tick);
    }
    (void)exchange_results();
}

std::vector<SentIsland> Part::perform(const Bring& order) const {
    base::InlineExecutor executor;
    std::vector<SentIsland> own;
    for (const auto& [index, with_organisms] : order.islands) {
        if (islands_.holds(index)) {
            const Island& island = islands_.island(index);
            const auto founders = islands_.founders(index);
            WorldState state;
            state.parameters.active = parameters_;
            state.islands.push_back(island.state(executor));
            own.push_back(
                {.bred = with_organisms ? std::vector{island.bred()} : std::vector<evolution::NextGeneration>{},
                 .opening = with_organisms && island.opening() != nullptr ? std::vector{*island.opening()}
                                                                          : std::vector<IslandOpening>{},
                 .founders = {founders.begin(), founders.end()},
                 .state = bytes_of(state)});
        }
    }
    std::vector<std::vector<SentIsland>> sent = collect(exchange_, std::move(own));
    std::vector<std::size_t> next(sent.size());
    std::vector<SentIsland> brought;
    for (std::size_t i = 0; is_first() && i < order.islands.size(); ++i) {
        const std::uint32_t rank = rank_of_island(order.islands[i].index);
        brought.push_back(std::move(sent[rank].at(next[rank]++)));
    }
    return brought;
}

BredIslands Part::perform(const Bred&) const {
    BredIslands all;
    for (BredIslands& part : collect(exchange_, islands_.bred())) {
        std::ranges::move(part.islands, std::back_inserter(all.islands));
        std::ranges::move(part.founders, std::back_inserter(all.founders));
        std::ranges::move(part.openings, std::back_inserter(all.openings));
    }
    return all;
}

std::vector<IslandOutcome> Part::perform(const Outcomes&) const {
    return joined(collect(exchange_, islands_.outcomes()));
}

std::vector<IslandState> Part::perform(const States&, base::Executor& executor) const {
    PartOfState own{.shapes = shapes(), .bytes = {}};
    std::vector<IslandState> states = islands_.states(executor);
    if (!is_first()) {
        WorldState state;
        state.parameters.active = parameters_;
        state.islands = std::exchange(states, {});
        own.bytes = bytes_of(state);
    }
    const std::vector<PartOfState> all = collect(exchange_, std::move(own));
    for (std::size_t rank = 1; rank < all.size(); ++rank) {
        std::ranges::move(state_of(all[rank].bytes, all[rank].shapes).islands, std::back_inserter(states));
    }
    return states;
}

std::vector<LiveStatistics> Part::perform(const LiveStatisticsOfAll&) const {
    return joined(collect(exchange_, islands_.live_statistics()));
}

} // namespace evod::simulation::shared
