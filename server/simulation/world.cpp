#include "server/simulation/world.h"

#include "server/base/assert.h"
#include "server/base/inline_executor.h"
#include "server/evolution/fitness_shuffle.h"
#include "server/evolution/migration.h"
#include "server/simulation/packed.h"
#include "server/simulation/rating.h"

#include <algorithm>
#include <new>
#include <numeric>
#include <string>
#include <utility>

namespace evod::simulation {
template <class Make>
void World::begin_generation(Make&& make, base::Executor& executor) {
    opening_ = {moment_, parameters_, progress_};
    fitness_.clear();
    brought_.clear();
    bool fits = true;
    try {
        std::vector<evolution::NextGeneration> bred = make();
        find_founders(bred);
        for_each_island(share_, executor, [&](std::size_t i) {
            islands_[i].begin_generation(parameters_.active, moment_.generation, std::move(bred[i]), executor);
        });
    } catch (const std::bad_alloc&) {
        if (!is_shared()) {
            throw;
        }
        fits = false; // the other processes have to learn it
    }
    exchange_summaries(fits);
    update_hash();
}

World::World(const parameters::Parameters& parameters, base::Seed seed, FirstPopulation first_population,
             parameters::Schedule schedule, Leader* leader)
    : World{parameters::ParameterSet::all_in_effect(parameters), seed, std::move(first_population), std::move(schedule),
            Sharing{leader, parameters.island_count}} {}

World::World(parameters::ParameterSet parameters, base::Seed seed, FirstPopulation first_population,
             parameters::Schedule schedule, Sharing sharing)
    : seed_{seed}
    , parameters_{std::move(parameters)}
    , first_population_{std::move(first_population)}
    , schedule_{std::move(schedule)}
    , sharing_{std::move(sharing)} {
    order_creation();
    begin_run();
}

World::World(base::Seed seed, const Opening& opening, std::vector<evolution::NextGeneration> born, History history,
             base::Executor& executor, FirstPopulation first_population, Founders founders,
             parameters::Schedule schedule, Leader* leader)
    : World{seed,
            opening,
            std::move(born),
            std::move(history),
            executor,
            std::move(first_population),
            std::move(founders),
            std::move(schedule),
            Sharing{leader, opening.parameters.active.island_count}} {}

World::World(base::Seed seed, const Opening& opening, std::vector<evolution::NextGeneration> born, History history,
             base::Executor& executor, FirstPopulation first_population, Founders founders,
             parameters::Schedule schedule, Sharing sharing)
    : seed_{seed}
    , parameters_{opening.parameters}
    , first_population_{std::move(first_population)}
    , schedule_{std::move(schedule)}
    , moment_{opening.moment}
    , sharing_{std::move(sharing)}
    , history_{std::move(history)}
    , progress_{opening.progress} {
    EVOD_ASSERT(born.size() == parameters_.active.island_count);
    EVOD_ASSERT(moment_.generation_tick == 0);
    make_islands();
    order_opening(born, founders);
    begin_generation([&] { return std::move(born); }, executor);
    if (moment_.generation > 1) {
        founders_ = std::move(founders);
    }
    EVOD_ASSERT(founders_.empty() || founders_.size() == islands_.size());
}

World World::at_its_opening(base::Executor& executor) const {
    BredIslands bred = this->bred();
    History before = history_;
    while (!before.empty() && before.back().front().generation >= opening_.moment.generation) {
        before.pop_back();
    }
    return {seed_,
            opening_,
            std::move(bred.islands),
            std::move(before),
            executor,
            first_population_,
            std::move(bred.founders),
            schedule_,
            sharing_.leader()};
}

World World::copy(base::Executor& executor, Leader* leader) const {
    if (!is_shared() && leader == nullptr) {
        World copy = *this;
        copy.events_.clear();
        return copy;
    }
    BredIslands bred = this->bred();
    const WorldState now = state(executor);
    History before = history_;
    if (!now.ended.empty()) {
        before.pop_back();
    }
    World copy{seed_,    opening_,          std::move(bred.islands),  std::move(before),
               executor, first_population_, std::move(bred.founders), schedule_,
               leader};
    copy.restore_shared(now, executor);
    copy.set_planned(planned_, planned_count_);
    copy.changes_ = changes_;
    return copy;
}

void World::become_fork() {
    set_planned({}, 0);
    changes_.clear();
    const auto is_inherited = [&](const GenerationRows& rows) {
        return rows.front().generation + history_generations_inherited >= opening_.moment.generation;
    };
    while (!history_.empty() && !is_inherited(history_.front())) {
        history_.pop_front();
    }
}

base::Result<parameters::Parameters> World::beginning() const {
    return parameters::assign(parameters_.requested.values, schedule_.at(1));
}

void World::reset(base::Seed seed, Leader* leader) {
    const parameters::Parameters first = beginning().value();
    World fresh{parameters::ParameterSet::all_in_effect(first, parameters_.revision), seed, first_population_,
                schedule_, Sharing{leader, first.island_count}};
    *this = std::move(fresh);
}

void World::begin_run() {
    const parameters::Parameters& p = parameters_.active;
    moment_ = {};
    progress_ = {};
    generation_over_ = false;
    make_islands();
    EVOD_ASSERT(!first_population_ || first_population_->size() == p.island_count);
    const auto first = [&] {
        std::vector<evolution::NextGeneration> born(p.island_count);
        for (auto island = static_cast<std::uint32_t>(share_.begin); island < share_.end; ++island) {
            born[island].genes = first_population_ ? (*first_population_)[island]
                                                   : evolution::initial_population(p.population_size, p, seed_, island);
        }
        return born;
    };
    base::InlineExecutor executor; // a run begins between two ticks, where no executor is available
    begin_generation(first, executor);
}

void World::make_islands() {
    islands_.clear();
    for (std::uint32_t island = 0; island < parameters_.active.island_count; ++island) {
        islands_.emplace_back(seed_, island);
    }
    share_ = share_of(islands_.size(), sharing_.exchange().rank(), sharing_.exchange().size());
    summaries_.resize(is_shared() ? islands_.size() : 0);
}

void World::find_founders(const std::vector<evolution::NextGeneration>& bred) {
    if (moment_.generation == 1) {
        founders_.clear();
        for (std::size_t i = 0; i < bred.size(); ++i) { // all islands begin with the same number of organisms
            const auto count = static_cast<std::size_t>(bred[i].genes.cols());
            founders_.emplace_back(count);
            std::iota(founders_.back().begin(), founders_.back().end(), static_cast<std::uint32_t>(i * count));
        }
        return;
    }
    for (std::size_t i = 0; i < founders_.size(); ++i) {
        std::vector<std::uint32_t> of_bred;
        of_bred.reserve(bred[i].parents.size());
        for (const evolution::Parents& parents : bred[i].parents) {
            of_bred.push_back(founders_[i][parents.first]);
        }
        founders_[i] = std::move(of_bred);
    }
}

void World::record_change(const parameters::RequestedParameters& requested, const std::string& by) {
    changes_.add(moment_.generation + (is_after_last_tick() ? 1 : 0), by, parameters_.requested, requested);
}

void World::request_parameters(const parameters::RequestedParameters& requested, const std::string& by) {
    sharing_.order(Order::Request, [&](base::Packer& order) { order.add(requested.values); });
    record_change(requested, by);
    parameters_ = parameters::after_request(parameters_, requested);
}

evolution::Outcome World::outcome() const {
    return generation_over_ ? evolution::outcome(progress_, parameters_.active) : evolution::Outcome::Running;
}

std::vector<Intention> World::intentions(const Island& island, base::Range ids) const {
    if (is_after_last_tick()) {
        return std::vector<Intention>(ids.end - ids.begin);
    }
    return island.intentions(parameters_of_next_tick(), static_cast<std::uint32_t>(moment_.generation_tick) + 1, ids);
}

std::optional<Activations> World::activations(const Island& island, std::uint32_t id) const {
    if (is_after_last_tick()) {
        return std::nullopt;
    }
    return island.activations(parameters_of_next_tick(), id);
}

parameters::Parameters World::parameters_of_next_tick() const {
    return moment_.generation_tick == 0
               ? parameters::taking_effect(parameters_.active, parameters_.requested, base::Effect::NextTick)
               : parameters_.active;
}

std::uint64_t World::alive_count() const {
    std::uint64_t alive = 0;
    for (const Island& island : islands_) { // the islands of other processes are empty here
        alive += island.alive_count();
    }
    for (std::size_t i = 0; i < summaries_.size(); ++i) {
        alive += is_mine(i) ? 0 : summaries_[i].alive_count;
    }
    return alive;
}

std::uint64_t World::plan(parameters::PlannedChange change) {
    EVOD_ASSERT(is_in_future(change.at));
    sharing_.order(Order::Plan, [&](base::Packer& order) { pack(order, change); });
    return add_planned(std::move(change));
}

std::uint64_t World::add_planned(parameters::PlannedChange change) {
    change.id = ++planned_count_;
    planned_.push_back(std::move(change));
    return planned_count_;
}

std::optional<parameters::PlannedChange> World::cancel(std::uint64_t id) {
    sharing_.order(Order::Cancel, [&](base::Packer& order) { order.add(id); });
    const auto found = std::ranges::find(planned_, id, &parameters::PlannedChange::id);
    if (found == planned_.end()) {
        return std::nullopt;
    }
    parameters::PlannedChange cancelled = std::move(*found);
    planned_.erase(found);
    return cancelled;
}

bool World::is_in_future(const parameters::PlannedMoment& moment) const {
    return moment.generation ? *moment.generation > moment_.generation : *moment.tick > moment_.tick;
}

void World::drop_due_changes() {
    std::erase_if(planned_, [&](const parameters::PlannedChange& change) { return !is_in_future(change.at); });
}

void World::apply_planned_for(std::uint64_t generation) {
    if (const auto scheduled = schedule_.at(generation); !scheduled.empty()) {
        apply_planned(scheduled, parameters::request_at_generation(parameters_, scheduled), 0, {});
    }
    const auto is_due = [&](const parameters::PlannedChange& change) { return change.at.generation == generation; };
    for (const parameters::PlannedChange& change : planned_) {
        if (is_due(change)) {
            apply_planned(change.assignments, parameters::request_at_generation(parameters_, change.assignments),
                          change.id, change.by);
        }
    }
    std::erase_if(planned_, is_due);
}

void World::apply_planned_now() {
    const auto is_due = [&](const parameters::PlannedChange& change) { return change.at.tick == moment_.tick; };
    for (const parameters::PlannedChange& change : planned_) {
        if (is_due(change)) {
            apply_planned(change.assignments, parameters::request_of(parameters_, change.assignments), change.id,
                          change.by);
            parameters_.active =
                parameters::taking_effect(parameters_.active, parameters_.requested, base::Effect::NextTick);
        }
    }
    std::erase_if(planned_, is_due);
}

void World::apply_planned(std::span<const parameters::Assignment> changes,
                          const base::Result<parameters::RequestedParameters>& requested, std::uint64_t id,
                          const std::string& by) {
    std::vector<std::string> names;
    for (const parameters::Assignment& change : changes) {
        names.push_back(change.name);
    }
    if (!requested) {
        events_.push_back(ChangeDropped{
            .planned = id, .by = by, .names = std::move(names), .violations = requested.error().violations});
        return;
    }
    record_change(*requested, by);
    parameters_.requested = *requested;
    ++parameters_.revision;
    events_.push_back(
        ParametersChanged{.planned = id, .by = by, .names = std::move(names), .revision = parameters_.revision});
}

EntityIds World::place(const PlaceEntities& command) {
    Island* const island = island_here(command.island);
    sharing_.order(Order::Place, [&](base::Packer& order) { pack(order, command); });
    EntityIds ids{.island = command.island, .generation = moment_.generation};
    if (island != nullptr) {
        ids = place_here(*island, command);
    }
    exchange_summaries();
    update_hash();
    return ids;
}

EntityIds World::place_here(Island& island, const PlaceEntities& command) {
    EntityIds ids{.island = command.island, .generation = moment_.generation};
    for (const PlaceEntities::Item& item : command.items) {
        (item.kind == ItemKind::Food ? ids.food : ids.poison)
            .push_back(island.place(item.kind, {physics::to_units(item.x_px), physics::to_units(item.y_px)}));
    }
    std::vector<Island::NewOrganism> organisms;
    for (const PlaceEntities::Organism& organism : command.organisms) {
        organisms.push_back({{physics::to_units(organism.x_px), physics::to_units(organism.y_px)},
                             organism.genes,
                             static_cast<std::uint32_t>(moment_.generation_tick)});
    }
    if (!organisms.empty()) {
        ids.organisms.resize(organisms.size());
        std::iota(ids.organisms.begin(), ids.organisms.end(), island.place(organisms, parameters_.active));
        if (!founders_.empty()) {
            std::vector<std::uint32_t>& founders =
                is_mine(command.island) ? founders_[command.island] : brought(command.island).founders;
            founders.resize(founders.size() + organisms.size(), no_founder);
        }
    }
    return ids;
}

EntityIds World::remove(const RemoveEntities& command) {
    Island* const island = island_here(command.island);
    sharing_.order(Order::Remove, [&](base::Packer& order) { pack(order, command); });
    if (island != nullptr) {
        for (const std::uint32_t item : command.food) {
            island->remove(ItemKind::Food, item);
        }
        for (const std::uint32_t item : command.poison) {
            island->remove(ItemKind::Poison, item);
        }
        for (const std::uint32_t organism : command.organisms) {
            island->remove_organism(organism, static_cast<std::uint32_t>(moment_.generation_tick));
        }
        if (!command.organisms.empty() && island->alive_count() == 0) {
            events_.push_back(
                Extinction{.island = command.island, .generation = moment_.generation, .tick = moment_.tick});
        }
    }
    exchange_summaries();
    update_hash();
    return {command.island, moment_.generation, command.food, command.poison, command.organisms};
}

bool World::is_as_begun() const {
    if (moment_.generation_tick != 0 || !(parameters_ == opening_.parameters)) {
        return false;
    }
    for (std::size_t i = 0; i < islands_.size(); ++i) {
        if (!(is_mine(i) ? islands_[i].is_as_begun() : summaries_[i].is_as_begun)) {
            return false;
        }
    }
    return true;
}

void World::turn_over(base::Executor& executor) {
    if (!generation_over_) {
        return;
    }
    sharing_.order(Order::TurnOver);
    turn_over_share(executor);
}

void World::turn_over_share(base::Executor& executor) {
    apply_planned_for(moment_.generation + 1);
    parameters_.active = parameters::breeding_with(parameters_.active, parameters_.requested);
    const parameters::Parameters& p = parameters_.active;
    const auto key_of = [&](std::size_t island) -> evolution::BreedingKey {
        return {.seed = seed_, .island = static_cast<std::uint32_t>(island), .generation = moment_.generation};
    };
    evolution::apply_shuffle(
        p, islands_.size(), [&](std::size_t island) -> std::span<double> { return fitness_[island]; }, seed_,
        moment_.generation, executor);

    for (Island& island : islands_) {
        island.free_weights();
    }
    std::vector<evolution::GeneMatrix> migrated;
    const std::vector<const evolution::GeneMatrix*> genes = parents(migrated);
    std::vector<evolution::NextGeneration> bred(islands_.size());
    for_each_island(share_, executor, [&](std::size_t i) {
        bred[i] = evolution::next_generation(fitness_[i], *genes[i], p, p.population_size, key_of(i), executor);
        bred[i].account =
            evolution::account_for(islands_[i].born().genes, *genes[i], bred[i].genes, bred[i].parents, executor);
    });

    ++moment_.generation;
    moment_.generation_tick = 0;
    generation_over_ = false;
    begin_generation([&] { return std::move(bred); }, executor);
}

std::vector<const evolution::GeneMatrix*> World::parents(std::vector<evolution::GeneMatrix>& migrated) {
    const parameters::Parameters& p = parameters_.active;
    std::vector<const evolution::GeneMatrix*> genes;
    for (const Island& island : islands_) {
        genes.push_back(&island.born().genes);
    }
    if (!evolution::migration_due(moment_.generation, p)) {
        return genes;
    }
    std::vector<std::uint32_t> populations;
    for (std::size_t i = 0; i < islands_.size(); ++i) {
        populations.push_back(organism_count(i));
    }
    const auto routes = evolution::plan_migration(populations, p, seed_, moment_.generation);
    MigrationHappened happened{.generation = moment_.generation, .edges = {}};
    for (const evolution::MigrationRoute& route : routes) {
        if (route.count > 0) {
            happened.edges.push_back({route.from, route.to, route.count});
        }
    }
    if (happened.edges.empty()) {
        return genes;
    }
    for (const evolution::GeneMatrix* born : genes) {
        migrated.push_back(*born);
    }
    for (std::size_t i = 0; i < islands_.size(); ++i) {
        genes[i] = &migrated[i];
    }
    migrate(routes, migrated);
    events_.push_back(std::move(happened));
    return genes;
}

void World::advance(std::uint64_t tick, base::Executor& executor) {
    EVOD_ASSERT(tick > moment_.tick);
    EVOD_ASSERT(outcome() == evolution::Outcome::Running);
    EVOD_ASSERT(!awaits_fitness());
    sharing_.order(Order::Advance, [&](base::Packer& order) { order.add(tick); });
    if (generation_over_) {
        turn_over_share(executor);
    }
    if (moment_.generation_tick == 0) {
        parameters_.active =
            parameters::taking_effect(parameters_.active, parameters_.requested, base::Effect::NextTick);
    }
    std::uint64_t alive = advance_share(executor);
    while (moment_.tick < tick && !ends(moment_.generation_tick, alive)) {
        apply_planned_now();
        alive = advance_share(executor);
    }
    if (!summaries_.empty() && has_bodies()) {
        meet(executor);
        alive = alive_count();
    }
    update_hash();
    if (ends(moment_.generation_tick, alive)) {
        end_generation(executor);
    }
    apply_planned_now();
}

std::uint64_t World::advance_share(base::Executor& executor) {
    const parameters::Parameters& p = parameters_.active;
    ++moment_.tick;
    ++moment_.generation_tick;
    moment_.simulated_s += p.tick_s;
    if (!has_bodies()) {
        return 0;
    }
    const auto tick = static_cast<std::uint32_t>(moment_.generation_tick);
    std::uint64_t alive = 0;
    died_out_.assign(islands_.size(), 0);
    for_each_island(share_, executor, [&](std::size_t i) {
        if (islands_[i].alive_count() == 0) {
            islands_[i].skip_tick(tick);
            return;
        }
        islands_[i].advance_tick(p, tick, executor);
        died_out_[i] = islands_[i].alive_count() == 0;
    });
    for (auto i = static_cast<std::uint32_t>(share_.begin); i < share_.end; ++i) {
        alive += islands_[i].alive_count();
        if (died_out_[i] && is_shared()) {
            died_out_since_meeting_.push_back({moment_.tick, i});
        } else if (died_out_[i]) {
            events_.push_back(Extinction{.island = i, .generation = moment_.generation, .tick = moment_.tick});
        }
    }
    return alive;
}

bool World::ends(std::uint64_t generation_tick, std::uint64_t alive) const {
    const parameters::Parameters& p = parameters_.active;
    if (generation_tick == 0) {
        return false;
    }
    // The half tick is a tolerance, so that 40 s are exactly 2,400 ticks of 1/60 s despite rounding.
    return !has_bodies() || alive == 0 || static_cast<double>(generation_tick) + 0.5 > p.generation_s / p.tick_s;
}

void World::find_fitness(base::Executor& executor) {
    fitness_.assign(islands_.size(), {});
    for (std::size_t i = share_.begin; i < share_.end; ++i) {
        fitness_[i] =
            islands_[i].fitness(parameters_.active, static_cast<std::uint32_t>(moment_.generation_tick), executor);
    }
}

void World::end_generation(base::Executor& executor) {
    if (is_fitness_external()) {
        fitness_.assign(islands_.size(), {});
        events_.push_back(FitnessAwaited{moment_.generation});
        return;
    }
    find_fitness(executor);
    finish_generation(executor);
}

void World::finish_generation(base::Executor& executor) {
    const parameters::Parameters& p = parameters_.active;
    std::vector<GenerationStatistics> statistics;
    for (std::size_t i = share_.begin; i < share_.end; ++i) {
        GenerationStatistics s = generation_statistics(islands_[i], p, fitness_[i], executor);
        s.generation = moment_.generation;
        s.end_tick = moment_.tick;
        s.simulated_s = static_cast<double>(moment_.generation_tick) * p.tick_s;
        statistics.push_back(s);
    }
    if (is_shared()) {
        base::Packer packer;
        for (const GenerationStatistics& s : std::exchange(statistics, {})) {
            pack(packer, s);
        }
        for (const std::string& part : sharing_.exchange().gather(packer.take())) {
            for (base::Unpacker unpacker{part}; !unpacker.empty();) {
                statistics.push_back(unpack_statistics(unpacker));
            }
        }
    }
    close_generation(statistics);
    events_.push_back(GenerationFinished{std::move(statistics)});
    if (const evolution::Outcome reached = outcome(); reached != evolution::Outcome::Running) {
        events_.push_back(RunTerminated{reached});
    }
}

void World::close_generation(const std::vector<GenerationStatistics>& statistics) {
    generation_over_ = true;
    const double best = std::ranges::max(statistics, {}, &GenerationStatistics::fitness_best).fitness_best;
    progress_ = evolution::advance(progress_, {.best_fitness = best, .died_out = has_bodies() && alive_count() == 0});
    history_.push_back(statistics);
    if (history_.size() > history_generations_kept_here()) {
        history_.pop_front();
    }
}

void World::update_hash() {
    constexpr std::uint32_t world_kind = 100, island_kind = 101;
    hash_ = base::EntityHash{world_kind, seed_.value}.add(moment_.generation).add(moment_.generation_tick).finish();
    for (const Island& island : islands_) {
        const bool is_here = summaries_.empty() || is_mine(island.index());
        const base::StateHash hash = is_here ? island.hash() : summaries_[island.index()].hash;
        hash_ += base::EntityHash{island_kind, island.index()}.add(hash.low).add(hash.high).finish();
    }
    if (is_fitness_external()) {
        hash_ += hash_of_given(fitness_);
    }
}

} // namespace evod::simulation
