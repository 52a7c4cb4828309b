// Intervals: what an island with births hands over from one interval to the next (colony.h).
#include "server/simulation/island.h"

#include "server/base/elementary.h"

#include <algorithm>

namespace evod::simulation {
namespace {

/// Returns the items of the next interval. Items that do not reappear any more are forgotten. If fewer than
/// `rules.count` remain, new ones appear in its first tick; if more, those with the highest ids vanish.
///
/// tick  the last of this interval.
base::Column<Items::Item> items_from(const Items& items, const ItemRules& rules, std::uint32_t tick,
                                     const physics::Area& area) {
    base::Column<Items::Item> next;
    for (Items::Item item : items.all()) {
        if (item.due_tick == Items::none || next.size() == rules.count) {
            continue;
        }
        if (item.due_tick != 0) {
            item.due_tick = std::clamp(item.due_tick, tick + 1, tick + rules.respawn_ticks) - tick;
        }
        next.push_back(item);
    }
    next.resize(rules.count, {area.width / 2, area.height / 2, 1});
    return next;
}

/// Price's account of one interval for one species (evolution/price.h). Survivors count as their own descendants; the
/// genes that a child would have without transmission are the mean of its parents', so children of children within the
/// interval count right. What placed organisms change is migration.
///
/// first  the ids of the species at the beginning of the interval.
/// now    the ids of its living organisms.
std::optional<evolution::SelectionAccount> account_of(const Island& island, base::Range first,
                                                      std::span<const std::uint32_t> now) {
    const evolution::GeneMatrix& genes = island.born().genes;
    std::vector<std::uint32_t> natives;
    std::ranges::copy_if(now, std::back_inserter(natives), [&](std::uint32_t id) {
        return id < island.bred_count() || island.parents_of_child(id).first != Island::no_parents.first;
    });
    if (first.begin == first.end || natives.empty()) {
        return std::nullopt;
    }
    evolution::SelectionAccount account;
    std::vector<double> inherited(static_cast<std::size_t>(genes.cols()));
    for (Eigen::Index gene = 0; gene < genes.rows(); ++gene) {
        const auto own = [&](std::size_t id) {
            return static_cast<double>(genes(gene, static_cast<Eigen::Index>(id)));
        };
        double start = 0, of_parents = 0, of_natives = 0, of_all = 0;
        for (std::uint32_t id = 0; id < inherited.size(); ++id) {
            const evolution::Parents parents = island.parents_of_child(id);
            inherited[id] = parents.first == Island::no_parents.first
                                ? own(id)
                                : (inherited[parents.first] + inherited[parents.second]) / 2;
        }
        for (std::size_t id = first.begin; id < first.end; ++id) {
            start += own(id);
        }
        for (const std::uint32_t id : natives) {
            of_parents += inherited[id];
            of_natives += own(id);
        }
        for (const std::uint32_t id : now) {
            of_all += own(id);
        }
        start /= static_cast<double>(first.end - first.begin);
        of_parents /= static_cast<double>(natives.size());
        of_natives /= static_cast<double>(natives.size());
        of_all /= static_cast<double>(now.size());
        account.push_back({.selection = of_parents - start,
                           .transmission = of_natives - of_parents,
                           .migration = of_all - of_natives,
                           .change = of_all - start});
    }
    return account;
}

} // namespace

std::uint32_t Island::breeder_count(Species species) const {
    if (has_births_) {
        return colony_[static_cast<std::size_t>(species)].living;
    }
    const auto all = static_cast<std::uint32_t>(born_.genes.cols());
    return species == Species::Predator ? born_.predator_count : all - born_.predator_count;
}

std::vector<std::uint32_t> Island::breeders(Species species) const {
    std::vector<std::uint32_t> ids;
    for (std::uint32_t id = 0; id < life_records_.cause.size(); ++id) {
        if (species_of(id) == species && (!has_births_ || life_records_.cause[id] == CauseOfDeath::Alive)) {
            ids.push_back(id);
        }
    }
    return ids;
}

Island::Continuation Island::continuation(const parameters::Parameters& parameters, std::uint32_t tick,
                                          base::Executor& executor) const {
    const std::vector<std::uint32_t> predators = breeders(Species::Predator);
    std::vector<std::uint32_t> ids = breeders(Species::Prey);
    const std::uint32_t bred_prey = bred_count() - born_.predator_count;
    Continuation next;
    next.bred.account = account_of(*this, {0, bred_prey}, ids);
    next.bred.predator_account = account_of(*this, {bred_prey, bred_count()}, predators);
    ids.insert(ids.end(), predators.begin(), predators.end());

    const auto count = static_cast<std::uint32_t>(ids.size());
    next.bred.predator_count = next.opening.predator_count = static_cast<std::uint32_t>(predators.size());
    next.bred.survivor_count = count;
    next.bred.genes.resize(born_.genes.rows(), count);
    next.opening.next_number =
        number_of(bred_count()) + static_cast<std::uint32_t>(arrivals_.size()); // of the first arrival, and so on
    const IslandState now = state(executor);
    IslandState& state = next.opening.state;
    state.life_records.begin_generation(count, true);
    for (std::uint32_t id = 0; id < count; ++id) {
        const std::uint32_t old = ids[id];
        next.bred.genes.col(id) = born_.genes.col(old);
        next.bred.parents.push_back({old, old});
        next.opening.numbers.push_back(number_of(old));
        next.opening.age_ticks.push_back(age_ticks(old, tick));
        state.life_records.children[id] = life_records_.children[old];
        state.organisms.push_back(now.organisms[old]);
        state.hunts_from.push_back(now.hunts_from[old] == 0 ? 0 : now.hunts_from[old] - tick);
        if (!now.headings.empty()) {
            state.headings.push_back(now.headings[old]);
        }
    }
    state.crates = now.crates;
    state.latest_born = now.latest_born;
    const parameters::IslandPlan plan = parameters::island_plan(parameters);
    ItemRules rules = item_rules(parameters);
    rules.count = plan.food_count;
    state.food = items_from(food_, rules, tick, area_);
    rules.count = plan.poison_count;
    state.poison = items_from(poison_, rules, tick, area_);
    return next;
}

void Island::add_predators(Continuation& to, const parameters::Parameters& parameters, std::uint64_t generation) const {
    const parameters::Parameters of_predators = parameters::of_predators(parameters);
    const std::uint32_t key_island = index_ | 1u << 31;
    const evolution::GeneMatrix genes =
        evolution::initial_population(of_predators.population_size, of_predators, seed_, key_island);
    PlacedCircles room{area_, to.opening.numbers.size() + of_predators.population_size};
    for (Eigen::Index id = 0; id < to.bred.genes.cols(); ++id) {
        const IslandState::Organism& organism = to.opening.state.organisms[static_cast<std::size_t>(id)];
        room.add({organism.x, organism.y}, body_shape(to.bred.genes(evolution::BodySize, id), parameters).radius_px);
    }
    const BoxGrid boxes{area_, boxes_};
    const base::RandomKey key{seed_, base::Purpose::OrganismPlacement, key_island, generation};
    const Eigen::Index before = to.bred.genes.cols();
    to.bred.genes.conservativeResize(Eigen::NoChange, before + genes.cols());
    to.bred.genes.rightCols(genes.cols()) = genes;
    IslandState& state = to.opening.state;
    for (Eigen::Index i = 0; i < genes.cols(); ++i) {
        const float radius_px = body_shape(genes(evolution::BodySize, i), parameters).radius_px;
        base::RandomStream random{key, static_cast<std::uint32_t>(i)};
        Place place = random_place(random, area_, radius_px, boxes);
        // In a crowd, the last place may overlap an organism; contacts push them apart.
        for (unsigned attempt = 1; attempt < 64 && !room.clear(place, radius_px); ++attempt) {
            place = random_place(random, area_, radius_px, boxes);
        }
        room.add(place, radius_px);
        const float health = genes(evolution::BaseHealth, i);
        state.organisms.push_back({.x = place.x, .y = place.y, .velocity_x = 0, .velocity_y = 0, .health = health});
        if (living_.has_brains()) {
            state.headings.push_back(static_cast<float>(random.uniform(-base::pi, base::pi)));
        }
        state.hunts_from.push_back(0);
        state.life_records.add(true);
        to.bred.parents.push_back(no_parents);
        to.opening.numbers.push_back(to.opening.next_number++);
        to.opening.age_ticks.push_back(0);
    }
    to.bred.predator_count += of_predators.population_size;
    to.opening.predator_count = to.bred.predator_count;
    if (parameters.shuffle_births) {
        state.latest_born[1].assign(genes.data(), genes.data() + genes.size());
    }
}

} // namespace evod::simulation
