// What the processes that share a world exchange (share.h).
#include "server/simulation/world.h"

#include <algorithm>
#include <utility>

namespace evod::simulation {

std::uint32_t World::organism_count(std::size_t island) const {
    return is_mine(island) ? static_cast<std::uint32_t>(islands_[island].born().genes.cols())
                           : summaries_[island].organism_count;
}

void World::migrate(std::span<const evolution::MigrationRoute> routes, std::vector<evolution::GeneMatrix>& migrated) {
    const parameters::Parameters& p = parameters_.active;
    std::vector<evolution::Ranking> rankings(fitness_.begin(), fitness_.end());
    const auto process_of = [&](std::uint32_t island) { return rank_of(islands_.size(), island, exchange_->size()); };
    // A migrant: its fitness, its founder and its genes. The order of routes states which migrants these are.
    std::vector<base::Packer> sent(exchange_->size());
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
    parcels = exchange_->swap(std::move(parcels));
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
    for (const std::string& part : exchange_->gather(packer.take())) { // in order of islands
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
        events_.push_back(Extinction{.island = island.island, .generation = moment_.generation});
    }
}

std::vector<IslandSummary> World::summaries_of_share() const {
    std::vector<IslandSummary> summaries;
    for (std::size_t i = share_.begin; i < share_.end; ++i) {
        summaries.push_back({islands_[i].hash(), islands_[i].alive_count(), organism_count(i)});
    }
    return summaries;
}

void World::exchange_summaries() {
    if (!is_shared()) {
        return;
    }
    base::Packer packer;
    packer.add_list(summaries_of_share());
    auto summary = summaries_.begin();
    for (const std::string& part : exchange_->gather(packer.take())) {
        summary = std::ranges::copy(base::Unpacker{part}.next_list<IslandSummary>(), summary).out;
    }
}

} // namespace evod::simulation
