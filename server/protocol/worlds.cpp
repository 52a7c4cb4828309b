#include "server/protocol/worlds.h"

#include "server/base/assert.h"
#include "server/protocol/event_text.h"
#include "server/protocol/gene_list.h"
#include "server/protocol/public_text.h"
#include "server/protocol/ratings.h"
#include "server/protocol/refusals.h"

namespace evod::protocol {

v1::RunState to_proto(simulation::RunState state) {
    switch (state) {
    case simulation::RunState::Waiting:
        return v1::RUN_STATE_WAITING;
    case simulation::RunState::Running:
        return v1::RUN_STATE_RUNNING;
    case simulation::RunState::Paused:
        return v1::RUN_STATE_PAUSED;
    case simulation::RunState::Terminated:
        return v1::RUN_STATE_TERMINATED;
    }
    return v1::RUN_STATE_UNSPECIFIED;
}

v1::Outcome to_proto(evolution::Outcome outcome) {
    switch (outcome) {
    case evolution::Outcome::Running:
        return v1::OUTCOME_UNSPECIFIED;
    case evolution::Outcome::TargetFitness:
        return v1::OUTCOME_TARGET_FITNESS;
    case evolution::Outcome::Extinction:
        return v1::OUTCOME_EXTINCTION;
    case evolution::Outcome::Stagnation:
        return v1::OUTCOME_STAGNATION;
    case evolution::Outcome::GenerationLimit:
        return v1::OUTCOME_GENERATION_LIMIT;
    }
    return v1::OUTCOME_UNSPECIFIED;
}

v1::GeneGroup to_proto(evolution::GeneGroup group) {
    switch (group) {
    case evolution::GeneGroup::All:
        break;
    case evolution::GeneGroup::Body:
        return v1::GENE_GROUP_BODY;
    case evolution::GeneGroup::Brain:
        return v1::GENE_GROUP_BRAIN;
    case evolution::GeneGroup::Free:
        return v1::GENE_GROUP_FREE;
    }
    return v1::GENE_GROUP_UNSPECIFIED;
}

v1::Speed to_proto(const simulation::Speed& speed) {
    v1::Speed to;
    if (speed) {
        to.set_real_time_factor(*speed);
    } else {
        to.set_max(true);
    }
    return to;
}

v1::Storage to_proto(const simulation::Storage& storage) {
    v1::Storage to;
    to.set_reason(quotable(public_text(storage.reason), 2000));
    switch (storage.state) {
    case simulation::StorageState::KeepsUp:
        to.set_state(v1::STORAGE_STATE_KEEPS_UP);
        break;
    case simulation::StorageState::Behind:
        to.set_state(v1::STORAGE_STATE_BEHIND);
        break;
    case simulation::StorageState::Failing:
        to.set_state(v1::STORAGE_STATE_FAILING);
        break;
    case simulation::StorageState::Stalled:
        to.set_state(v1::STORAGE_STATE_STALLED);
        break;
    }
    to.set_text(storage_text(to));
    return to;
}

v1::WorldInfo to_proto(const simulation::Entry& entry) {
    const simulation::World& world = entry.world;
    const simulation::Moment& moment = world.moment();
    v1::WorldInfo to;
    to.set_name(entry.name);
    to.set_run_id(to_text(entry.run_id));
    to.set_seed(world.seed().value);
    to.set_island_count(world.island_count());
    to.set_tick(moment.tick);
    to.set_generation(moment.generation);
    to.set_generation_tick(moment.generation_tick);
    to.set_simulated_s(moment.simulated_s);
    to.set_state(to_proto(entry.state()));
    to.set_outcome(to_proto(world.outcome()));
    *to.mutable_speed() = to_proto(entry.control.speed);
    to.set_state_hash(to_text(world.hash()));
    to.set_parameter_revision(world.parameters().revision);
    if (const auto ended = entry.control.until_generation) {
        // The goal is the start of the next generation.
        to.set_run_until_generation(*ended + (*ended < ~std::uint64_t{0} ? 1 : 0));
    }
    to.set_leased(entry.control.leased);
    to.set_slowed(entry.slowed);
    if (entry.control.until_tick) {
        to.set_run_until_tick(*entry.control.until_tick);
    }
    to.set_ticks_per_s(entry.ticks_per_s);
    const evolution::GeneLayout layout = evolution::gene_layout(world.parameters().active);
    for (std::size_t gene = 0; gene < layout.names.size(); ++gene) {
        to.add_gene_names(layout.names[gene]);
        to.add_gene_groups(to_proto(layout.groups[gene]));
    }
    if (const auto& listed = world.parameters().active.listed_genes; !listed.empty()) {
        to_proto(listed, *to.mutable_free_genes());
    }
    if (entry.replay) {
        v1::Replay& replay = *to.mutable_replay();
        replay.set_replay_of(entry.replay->replay_of);
        replay.set_first_generation(entry.replay->first_generation);
        replay.set_last_generation(entry.replay->last_generation);
        replay.set_first_tick(entry.replay->first_tick);
        replay.set_last_tick(entry.replay->last_tick);
    }
    if (world.awaits_fitness()) {
        to.mutable_awaited_fitness()->set_generation(moment.generation);
        add_awaited_islands(world, *to.mutable_awaited_fitness()->mutable_islands());
    }
    if (entry.storage) {
        *to.mutable_storage() = to_proto(*entry.storage);
    }
    to.set_owner(entry.ownership.user);
    to.set_class_(entry.ownership.class_name);
    to.set_frozen(entry.frozen);
    return to;
}

v1::DamagedWorld to_proto(const simulation::DamagedWorld& world) {
    v1::DamagedWorld to;
    to.set_name(world.name);
    if (world.run_id) {
        to.set_run_id(to_text(*world.run_id));
    }
    to.set_reason(quotable(public_text(world.reason), 2000));
    return to;
}

namespace {

v1::ColonyStatistics to_proto(const simulation::ColonyStatistics& statistics) {
    v1::ColonyStatistics to;
    to.set_first_count(statistics.first_count);
    to.set_lowest_count(statistics.lowest_count);
    to.set_count_mean(statistics.count_mean);
    to.set_born_count(statistics.born_count);
    to.set_refused_count(statistics.refused_count);
    to.set_without_room_count(statistics.without_room_count);
    to.set_eaten_count(statistics.eaten_count);
    to.set_old_count(statistics.old_count);
    to.set_died_count(statistics.died_count);
    to.set_children_mean(statistics.children_mean);
    to.set_children_variance(statistics.children_variance);
    to.set_age_mean_s(statistics.age_mean_s);
    return to;
}

} // namespace

v1::GenerationStatistics to_proto(const simulation::GenerationStatistics& statistics) {
    v1::GenerationStatistics to;
    to.set_generation(statistics.generation);
    to.set_island(statistics.island);
    to.set_end_tick(statistics.end_tick);
    to.set_organism_count(statistics.organism_count);
    to.set_fitness_best(statistics.fitness_best);
    to.set_fitness_mean(statistics.fitness_mean);
    to.set_fitness_median(statistics.fitness_median);
    to.set_fitness_worst(statistics.fitness_worst);
    to.set_fitness_deviation(statistics.fitness_deviation);
    for (std::size_t i = 0; i < statistics.genes.size(); ++i) {
        const simulation::GeneStatistics& gene = statistics.genes[i];
        auto& to_gene = *to.add_genes();
        to_gene.set_mean(gene.mean);
        to_gene.set_deviation(gene.deviation);
        to_gene.set_min(gene.min);
        to_gene.set_max(gene.max);
        if (!statistics.account) {
            continue;
        }
        const evolution::GeneAccount& account = (*statistics.account)[i];
        auto& to_account = *to_gene.mutable_account();
        to_account.set_selection(account.selection);
        to_account.set_transmission(account.transmission);
        to_account.set_migration(account.migration);
        to_account.set_change(account.change);
    }
    to.set_diversity(statistics.diversity);
    to.set_alive_count(statistics.alive_count);
    to.set_starved_count(statistics.starved_count);
    to.set_poisoned_count(statistics.poisoned_count);
    to.set_food_eaten(statistics.food_eaten);
    to.set_poison_eaten(statistics.poison_eaten);
    to.set_clamp_count(statistics.clamp_count);
    to.set_too_fast_count(statistics.too_fast_count);
    to.set_speed_limit_count(statistics.speed_limit_count);
    to.set_best_organism(statistics.best_organism);
    to.set_simulated_s(statistics.simulated_s);
    if (statistics.colony) {
        *to.mutable_colony() = to_proto(*statistics.colony);
    }
    if (!statistics.predators.empty()) {
        *to.mutable_predators() = to_proto(statistics.predators.front());
    }
    return to;
}

v1::LiveStatistics to_proto(const simulation::LiveStatistics& statistics, std::uint32_t island) {
    v1::LiveStatistics to;
    to.set_island(island);
    to.set_organism_count(statistics.organism_count);
    to.set_alive_count(statistics.alive_count);
    to.set_health_mean(statistics.health_mean);
    to.set_food_eaten(statistics.food_eaten);
    to.set_poison_eaten(statistics.poison_eaten);
    to.set_starved_count(statistics.starved_count);
    to.set_poisoned_count(statistics.poisoned_count);
    to.set_eaten_count(statistics.eaten_count);
    to.set_old_count(statistics.old_count);
    to.set_born_count(statistics.born_count);
    to.set_predator_count(statistics.predator_count);
    return to;
}

namespace {

void set_brain(const evolution::BrainLayout& layout, const simulation::Activations& activations, v1::Brain& to) {
    for (const evolution::BrainInput input : layout.inputs) {
        to.add_input_names(std::string{evolution::brain_input_names[static_cast<std::size_t>(input)]});
    }
    for (const std::string_view name : layout.output_names) {
        to.add_output_names(std::string{name});
    }
    to.mutable_inputs()->Assign(activations.inputs.begin(), activations.inputs.end());
    to.mutable_hidden()->Assign(activations.hidden.begin(), activations.hidden.end());
    to.mutable_outputs()->Assign(activations.outputs.begin(), activations.outputs.end());
    to.set_has_bias(layout.has_bias);
}

} // namespace

namespace {

/// Sets what only organisms of colonies have.
void set_colony(const simulation::World& world, const simulation::Island& island, std::uint32_t id,
                const simulation::Intention& intention, v1::OrganismInfo& to) {
    const double tick_s = world.parameters().active.tick_s;
    const auto tick = static_cast<std::uint32_t>(world.moment().generation_tick);
    if (island.species_of(id) == simulation::Species::Predator) {
        to.set_species(v1::SPECIES_PREDATOR);
    }
    to.set_flees_predator(intention.flees_predator);
    if (island.has_births()) {
        to.set_number(island.number_of(id));
        to.set_age_s(island.age_ticks(id, tick) * tick_s);
        to.set_children(island.life_records().children[id]);
    }
    if (const auto body = island.body_of(id)) {
        const std::uint32_t hunts_from = island.living().hunts_from[*body], next = tick + 1;
        to.set_handling_s(hunts_from > next ? (hunts_from - next) * tick_s : 0);
    }
}

} // namespace

evolution::Parents shown_parents(const simulation::Island& island, std::uint32_t id) {
    const std::vector<evolution::Parents>& bred = island.born().parents;
    return id >= island.bred_count() ? island.parents_of_child(id)
           : bred.empty()            ? simulation::Island::no_parents
                                     : bred[id];
}

v1::OrganismInfo organism_info(const simulation::World& world, const simulation::Island& island, std::uint32_t id) {
    const auto& parameters = world.parameters().active;
    const auto& born = island.born();
    EVOD_ASSERT(id < born.genes.cols());
    v1::OrganismInfo to;
    to.set_id(id);
    to.set_island(island.index());
    to.set_generation(world.moment().generation);
    for (const float gene : evolution::column(born.genes, id)) {
        to.add_genes(gene);
    }
    if (id >= island.bred_count()) { // it was placed or born
        to.set_placed_tick(island.placed_tick(id));
    }
    const evolution::Parents parents = shown_parents(island, id);
    if (parents != simulation::Island::no_parents) {
        to.add_parents(parents.first);
        if (parents.second != parents.first) {
            to.add_parents(parents.second);
        }
    }
    const auto body = island.body_of(id);
    to.set_alive(body.has_value() || !world.has_bodies());
    if (!world.has_bodies()) {
        return to;
    }

    const auto shape = simulation::body_shape(born.genes(evolution::BodySize, id), parameters);
    to.set_radius_px(shape.radius_px);
    to.set_mass_kg(shape.mass_kg);
    const simulation::Intention intention = world.intentions(island, {id, id + 1}).front();
    to.set_choice(static_cast<v1::Choice>(intention.choice));
    to.set_force_x(intention.force_x);
    to.set_force_y(intention.force_y);
    to.set_target_x_px(physics::to_px(intention.target_x));
    to.set_target_y_px(physics::to_px(intention.target_y));
    if (const auto activations = world.activations(island, id)) {
        set_brain(island.brain(), *activations, *to.mutable_brain());
    }
    if (island.is_colony()) {
        set_colony(world, island, id, intention, to);
    }
    const simulation::LifeRecords& life_records = island.life_records();
    to.set_food_eaten(life_records.food_eaten[id]);
    to.set_poison_eaten(life_records.poison_eaten[id]);
    if (body) {
        const physics::Circles& bodies = island.bodies();
        to.set_x_px(physics::to_px(bodies.x[*body]));
        to.set_y_px(physics::to_px(bodies.y[*body]));
        to.set_velocity_x_px_s(bodies.velocity_x[*body]);
        to.set_velocity_y_px_s(bodies.velocity_y[*body]);
        to.set_health(island.living().health[*body]);
        if (island.living().has_brains()) {
            to.set_heading(island.living().heading[*body]);
        }
        to.set_lived_s(static_cast<double>(world.moment().generation_tick - island.placed_tick(id)) *
                       parameters.tick_s);
    } else {
        to.set_lived_s(static_cast<double>(life_records.lived_ticks[id]) * parameters.tick_s);
        to.set_cause_of_death(static_cast<v1::CauseOfDeath>(life_records.cause[id]));
    }
    return to;
}

} // namespace evod::protocol
