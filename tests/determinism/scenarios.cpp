#include "tests/determinism/scenarios.h"

#include "server/base/assert.h"
#include "server/parameters/experiment.h"

#include <ostream>

namespace evod::scenarios {

void PrintTo(const Scenario& scenario, std::ostream* out) {
    *out << scenario.name;
}

const std::vector<Scenario>& all() {
    static const std::vector<Scenario> scenarios = {
        {"default_world", R"({"generation_s": 6})", base::Seed{42}, 1000, {}},

        {"classic",
         R"({"population_size": 20, "food_count": 65, "steering_lookahead_s": 0, "flee_rule": "always",
             "mutate_survivors": true, "generation_s": 4})",
         base::Seed{43},
         600,
         {}},

        {"crates_and_obstacles_explicit_euler",
         R"({"integrator": "explicit_euler", "obstacle_count": 15, "crate_count": 12, "crate_mass_kg": 1.5,
             "respawn_s": 1.5, "generation_s": 5, "selection": "tournament", "crossover": "single_point"})",
         base::Seed{44},
         700,
         {}},

        {"dense_backward_euler", // organisms touch all the time; another tick length
         R"({"integrator": "backward_euler", "population_size": 160, "island_width_px": 960, "island_height_px": 660,
             "damping": 0.98, "restitution": 1, "tick_s": 0.025, "food_count": 60, "poison_count": 60,
             "crate_count": 5, "generation_s": 6, "selection": "truncation", "max_speed_px_s": 60})",
         base::Seed{45},
         500,
         {}},

        {"ring_of_four",
         R"({"island_count": 4, "population_size": 30, "migration": "ring", "migration_epoch": 1, "migrant_count": 2,
             "generation_s": 2, "selection": "stochastic_universal", "fitness_scaling": "linear_ranking",
             "crossover": "multi_point", "rearranging": "inversion", "elite_count": 2})",
         base::Seed{46},
         600,
         {}},

        {"trade_offs_dying_out", // islands die out one after another, and generations end early
         R"({"island_count": 3, "population_size": 24, "health_loss_per_s": 40, "respawn": false, "food_count": 40,
             "normal_speed_cost": 0.1, "impulse_cost": 0.2, "base_health_cost": 0.5, "food_radius_cost": 0.1,
             "poison_radius_cost": 0.1, "health_cap_per_size": 3, "migration": "fully_connected",
             "migration_epoch": 2, "immigrants_replace": "random", "population_model": "steady_state",
             "replaced_count": 9})",
         base::Seed{47},
         900,
         {}},

        {"changes_while_it_runs",
         R"({"island_count": 2, "generation_s": 1.5, "scale_with_population": true})",
         base::Seed{48},
         900,
         {{40, R"({"population_size": 90, "food_health": 40, "flee_rule": "always"})"},
          {100, R"({"obstacle_count": 5, "crate_count": 4, "steering_lookahead_s": 0.1, "selection": "truncation"})"},
          {190, R"({"integrator": "explicit_euler", "tick_s": 0.02, "restitution": 0.5, "creep": "gaussian"})"},
          {260, R"({"population_size": 15, "population_model": "generational", "crossover": "none"})"},
          {355, R"({"respawn_s": 0.5, "poison_harm": 90, "bit_flip_chance": 0.02, "body_size_max": 90})"},
          {430, R"({"poison_harm": 5, "flee_certain_impulse": 50})"},
          {500, R"({"population_size": 60, "migration": "random", "migration_epoch": 1, "emigrants": "random"})"},
          {640, R"({"island_width_px": 700, "integrator": "backward_euler", "damping": 0.99})"},
          {700, R"({"reset_chance": 0.1, "rearranging": "scramble", "fitness_scaling": "windowing"})"}}},

        {"three_thousand", // every loop is cut into several pieces
         R"({"population_size": 3000, "scale_with_population": true, "reference_population": 50, "obstacle_count": 30,
             "crate_count": 30, "generation_s": 2, "tournament_size": 4, "selection": "tournament",
             "tournament_replacement": false})",
         base::Seed{49},
         150,
         {}},

        {"twenty_thousand", // one island is divided: every loop of a tick, meals, deaths and the order in memory
         R"({"population_size": 20000, "scale_with_population": true, "reference_population": 50, "generation_s": 0.75,
             "item_radius_px": 20, "food_count": 100, "poison_harm": 100, "base_health_min": 20, "crate_count": 40,
             "health_loss_per_s": 60})",
         base::Seed{52},
         75,
         {}},

        {"far_corner", // coordinates near the maximum
         R"({"island_width_px": 500000, "island_height_px": 500000, "population_size": 400, "food_count": 3000,
             "poison_count": 3000, "generation_s": 2})",
         base::Seed{50},
         200,
         {}},

        {"rastrigin", // a generation is one tick
         R"({"fitness": "rastrigin", "population_size": 2500, "island_count": 3, "migration": "ring",
             "fitness_scaling": "exponential_ranking", "creep": "gaussian", "mutation_step": 4,
             "rearranging": "swap", "reset_chance": 0.01, "bit_flip_chance": 0.01, "crossover": "multi_point",
             "crossover_cuts": 3, "migration_epoch": 3})",
         base::Seed{51},
         40,
         {}},

        {"shuffled_fitness", // decides which organisms survive, breed, migrate and are replaced
         R"({"island_count": 3, "population_size": 30, "generation_s": 2, "shuffle_fitness": true, "elite_count": 2,
             "migration": "ring", "migration_epoch": 1, "migrant_count": 2, "selection": "tournament"})",
         base::Seed{53},
         480,
         {}},

        {"weighted_fitness", // eaten items are part of the state; the weights change while it runs
         R"({"island_count": 2, "population_size": 40, "generation_s": 2, "food_count": 60, "fitness_per_second": 0,
             "fitness_per_health": 0.5, "fitness_per_food": 10, "selection": "truncation"})",
         base::Seed{55},
         480,
         {{150, R"({"fitness_per_second": -1, "fitness_per_food": 0, "fitness_per_poison": -20})"}}},

        {"blend", // also of survivors, on several islands
         R"({"island_count": 3, "population_size": 30, "generation_s": 2, "crossover": "blend", "crossover_chance": 0.9,
             "mutate_survivors": true, "elite_count": 2, "migration": "ring", "migration_epoch": 1,
             "fitness_scaling": "windowing"})",
         base::Seed{56},
         480,
         {}},

        {"nsga2", // survivors are the best, and parents are selected among them
         R"({"island_count": 2, "population_size": 30, "generation_s": 2, "population_model": "nsga2",
             "selection": "tournament", "tournament_size": 2, "elite_count": 1, "migration": "ring",
             "migration_epoch": 2})",
         base::Seed{59},
         480,
         {}},

        {"simulated_binary", // with polynomial creep, and genes that are reflected at their bounds
         R"({"island_count": 2, "population_size": 30, "generation_s": 2, "crossover": "simulated_binary",
             "creep": "polynomial", "out_of_bounds": "reflect", "scale_chance": 0.8, "scale_range": 1,
             "mutate_survivors": true, "migration": "ring", "migration_epoch": 1})",
         base::Seed{58},
         480,
         {{200, R"({"creep": "uniform", "mutation_step": 120, "out_of_bounds": "redraw"})"}}},

        {"scale_mutation", // together with the other mutations
         R"({"population_size": 40, "generation_s": 2, "scale_chance": 0.6, "scale_range": 0.4, "reset_chance": 0.02,
             "bit_flip_chance": 0.01, "mutate_survivors": true, "selection": "tournament"})",
         base::Seed{57},
         480,
         {}},

        {"crowded_migration", // more arrive than an island holds
         R"({"fitness": "gene_sum", "island_count": 4, "population_size": 5, "migration": "fully_connected",
             "migration_epoch": 2, "migrant_count": 3})",
         base::Seed{54},
         40,
         {}},

        {"newtonian_networks", // every sense; sorted in memory as they move
         R"({"controller": "network", "sense_speed": true, "sense_health": true, "sense_wall": true, "brain_hidden": 8,
             "population_size": 1500, "scale_with_population": true, "reference_population": 50, "crate_count": 5,
             "generation_s": 4})",
         base::Seed{55},
         600,
         {}},

        {"kinematic_networks",
         R"({"controller": "network", "locomotion": "kinematic", "sense_poison": false, "sense_bearing_only": true,
             "brain_bias": false, "crossover": "blend", "spawn_margin_px": 100, "generation_s": 4,
             "mutate_group": "brain"})",
         base::Seed{56},
         600,
         {}},

        {"sexual_births", // births, old age, migrants and changes of the rules
         R"({"reproduction": "births", "island_count": 2, "population_size": 60, "food_count": 120, "respawn_s": 1,
             "generation_s": 2, "birth_health": 90, "birth_cost": 5, "mate_px": 150, "lifespan_s": 6,
             "food_health": 60, "population_max": 90, "crate_count": 3, "migration": "ring", "migration_epoch": 1,
             "migrant_count": 2, "scale_chance": 0.3, "crossover": "blend"})",
         base::Seed{60},
         900,
         {{200, R"({"birth_every_s": 0.1, "population_max": 40, "mate_px": 400})"},
          {500, R"({"births": "asexual", "health_cap_per_size": 2.5, "body_size_cost": 0.3,
                    "birth_health": 120})"}}},

        {"predators_and_prey", // with births; they arrive late, and two islands exchange them
         R"({"reproduction": "births", "births": "asexual", "island_count": 2, "population_size": 80, "food_count": 150,
             "respawn_s": 1, "generation_s": 2, "birth_health": 110, "birth_cost": 5, "lifespan_s": 8,
             "predator_count": 12, "predator_from": 2, "handling_s": 0.5, "prey_health": 40,
             "predator_birth_health": 130, "predator_births": "sexual", "predator_mate_px": 500,
             "migration": "ring", "migration_epoch": 2})",
         base::Seed{61},
         900,
         {{300, R"({"predator_births": "asexual", "predator_lifespan_s": 4, "handling_s": 1})"},
          {600, R"({"shuffle_births": false, "flee_certain_impulse": 50})"}}},

        {"predators_with_generations", // both species are bred, each with its own operators
         R"({"island_count": 2, "population_size": 50, "predator_count": 10, "predator_from": 3, "generation_s": 2,
             "handling_s": 0.5, "predator_selection": "tournament", "predator_elite_count": 1,
             "predator_mutation_chance": 0.5, "selection": "truncation", "migration": "ring", "migration_epoch": 1})",
         base::Seed{62},
         900,
         {}},

        {"births_of_unselected_parents", // of networks, which predators hunt
         R"({"reproduction": "births", "controller": "network", "population_size": 120, "food_count": 150,
             "generation_s": 2, "birth_health": 80, "birth_cost": 0, "mate_px": 200, "shuffle_births": true,
             "predator_count": 10, "handling_s": 0.4})",
         base::Seed{63},
         480,
         {}},

        {"colony_of_thousands", // every loop is cut into several pieces
         R"({"reproduction": "births", "births": "asexual", "population_size": 5000, "scale_with_population": true,
             "reference_population": 50, "generation_s": 1, "birth_health": 100, "birth_cost": 0, "lifespan_s": 2,
             "predator_count": 600, "handling_s": 0.3, "health_loss_per_s": 20})",
         base::Seed{64},
         150,
         {}},
    };
    return scenarios;
}

parameters::Parameters parameters_of(std::string_view experiment) {
    auto parsed = parameters::parse_experiment(experiment);
    if (!parsed) {
        std::fputs(to_text(parsed.error()).c_str(), stderr);
    }
    EVOD_ASSERT(parsed.has_value());
    return parsed->parameters;
}

Play::Play(const Scenario& scenario, base::Seed seed) : scenario_{scenario} {
    auto created = laboratory_.apply(simulation::CreateWorld{
        .name = "w", .parameters = parameters_of(scenario.experiment), .seed = seed, .run_id = {}});
    EVOD_ASSERT(created.has_value());
    EVOD_ASSERT(laboratory_.apply(simulation::Run{.world = "w", .generations = {}}).has_value());
}

void Play::advance(base::Executor& executor) {
    simulation::Entry& entry = *laboratory_.entries().front();
    for (const Change& change : scenario_.changes) {
        if (change.tick != entry.world.moment().tick + 1) {
            continue;
        }
        // Assigns the parameters that the text names, even those with their default value.
        std::vector<parameters::Assignment> assignments;
        const parameters::Parameters values = parameters_of(change.parameters);
        for (const parameters::ParameterDescription& description : parameters::parameter_registry()) {
            if (change.parameters.find("\"" + std::string{description.name} + "\":") != std::string_view::npos) {
                assignments.push_back({std::string{description.name}, description.get(values)});
            }
        }
        auto changed = laboratory_.apply(simulation::SetParameters{
            .world = "w", .assignments = assignments, .dry_run = false, .expected_revision = {}});
        if (!changed) {
            std::fputs(to_text(changed.error()).c_str(), stderr);
        }
        EVOD_ASSERT(changed.has_value());
    }
    EVOD_ASSERT(entry.wants_tick());
    laboratory_.advance(entry, executor);
    laboratory_.take_events();
}

} // namespace evod::scenarios
