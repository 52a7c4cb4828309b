// The registry of all parameters of a world: the fitness function and the parameters of the genetic algorithm
// (evolution/ga_parameters.h), and the parameters of the model, one line each below.
//
// Macros generate the struct, its defaults and the registry from these lines. Validation, JSON files, the protocol,
// evoctl's help and docs/PARAMETERS.md use the registry, so a new parameter needs one new line, here or in
// evolution/ga_parameters.h, below the heading (TOPIC) under which people look for it.
#pragma once

#include "server/base/parameter.h"
#include "server/base/result.h"
#include "server/evolution/ga_parameters.h"

#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

namespace evod::parameters {

using evolution::FitnessFunction;
enum class FleeRule { Nearer, Always };
enum class IntegratorChoice { SymplecticEuler, ExplicitEuler, BackwardEuler };
enum class Reproduction { Generations, Births };
enum class Births { Sexual, Asexual };

} // namespace evod::parameters

EVOD_CHOICE_NAMES(evod::parameters::FleeRule, "nearer", "always")
EVOD_CHOICE_NAMES(evod::parameters::IntegratorChoice, "symplectic_euler", "explicit_euler", "backward_euler")
EVOD_CHOICE_NAMES(evod::parameters::Reproduction, "generations", "births")
EVOD_CHOICE_NAMES(evod::parameters::Births, "sexual", "asexual")

// clang-format off
#define EVOD_MODEL_PARAMETERS(TOPIC, REAL, COUNT, FLAG, CHOICE)                                                        \
    REAL(fitness_per_second, 1, -1000, 1000, "fitness/s", NextGeneration, "Weight of each second lived in the fitness function life.") \
    REAL(fitness_per_health, 1, -1000, 1000, "fitness/health", NextGeneration, "Weight of each unit of health at the end in the fitness function life; the health of dead organisms is 0.") \
    REAL(fitness_per_food, 0, -1000, 1000, "fitness/item", NextGeneration, "Weight of each food item eaten in the fitness function life.") \
    REAL(fitness_per_poison, 0, -1000, 1000, "fitness/item", NextGeneration, "Weight of each poison item eaten in the fitness function life; negative values punish eating poison.") \
    REAL(generation_s, 40, 0.001, 86'400, "s", NextGeneration, "Length of a generation; it ends earlier if every organism dies.") \
    REAL(tick_s, 1.0 / 60, 0.001, 1, "s", NextGeneration, "Simulated time per tick.")                                  \
    TOPIC("Islands")                                                                                                   \
    COUNT(island_count, 1, 1, 4096, "islands", Reset, "Number of islands; they are independent except for migration.") \
    REAL(island_width_px, 1280, 100, 500'000, "px", NextGeneration, "Distance between the left and right walls.")      \
    REAL(island_height_px, 720, 100, 500'000, "px", NextGeneration, "Distance between the upper and lower walls.")     \
    TOPIC("Food and poison")                                                                                           \
    COUNT(food_count, 25, 0, 20'000'000, "items", NextGeneration, "Food items on each island.")                        \
    COUNT(poison_count, 40, 0, 20'000'000, "items", NextGeneration, "Poison items on each island.")                    \
    FLAG(scale_with_population, false, NextGeneration, "Whether the area, food and poison of each island grow in proportion to population_size; the parameters for them then give the values for reference_population organisms.") \
    COUNT(reference_population, 50, 1, 4'000'000, "organisms", NextGeneration, "The population size to which island size, food_count and poison_count apply if scale_with_population is on; in an experiment file, the default is the file's population_size.") \
    REAL(spawn_margin_px, 0, 0, 250'000, "px", NextGeneration, "Organisms, food, poison, obstacles and crates are placed with their centres at least this far from every wall.") \
    TOPIC("Obstacles and crates")                                                                                      \
    COUNT(obstacle_count, 0, 0, 1000, "obstacles", NextGeneration, "Immovable rectangles on each island.")             \
    REAL(obstacle_size_px, 60, 5, 2000, "px", NextGeneration, "Side of an obstacle.")                                  \
    COUNT(crate_count, 0, 0, 1000, "crates", NextGeneration, "Movable rectangles on each island.")                     \
    REAL(crate_size_px, 30, 5, 2000, "px", NextGeneration, "Side of a crate.")                                         \
    REAL(crate_mass_kg, 4, 0.001, 1e6, "kg", NextGeneration, "Mass of a crate.")                                       \
    TOPIC("Items")                                                                                                     \
    REAL(item_radius_px, 4, 0.5, 100, "px", NextGeneration, "Radius of food and poison.")                              \
    FLAG(respawn, true, NextGeneration, "Whether eaten food and poison reappear.")                                     \
    REAL(respawn_s, 0, 0, 86'400, "s", NextGeneration, "Time until an eaten item reappears; 0 means the next tick.")   \
    TOPIC("Health and behaviour")                                                                                      \
    REAL(health_loss_per_s, 6, 0, 10'000, "health/s", NextGeneration, "Health that an organism loses per second of life.") \
    REAL(food_health, 25, 0, 10'000, "health", NextTick, "Health gained from a food item.")                            \
    REAL(poison_harm, 40, 0, 10'000, "health", NextTick, "Health lost to a poison item.")                              \
    REAL(steering_lookahead_s, 0.3, 0, 10, "s", NextTick, "How far ahead an organism compensates for its own velocity when it steers to food; with 0 it orbits the food.") \
    CHOICE(flee_rule, FleeRule, Nearer, NextTick, "When an organism may flee from poison that it sees: nearer, only if the poison is nearer than all food that it sees; always, regardless of food.") \
    REAL(flee_certain_impulse, 200, 1, 10'000, "gene units", NextTick, "Value of the gene impulse at which an organism flees with certainty; below it, the chance is impulse / flee_certain_impulse.") \
    TOPIC("Physics")                                                                                                   \
    REAL(damping, 0.999, 0.01, 1, "share per 1/60 s", NextGeneration, "Share of its velocity that a body keeps after 1/60 s.") \
    REAL(restitution, 0.8, 0, 1, "", NextGeneration, "Speed at which two bodies separate after a collision, as a share of the speed at which they approached.") \
    REAL(max_speed_px_s, 600, 1, 100'000, "px/s", NextGeneration, "Maximum speed of a body.")                         \
    CHOICE(integrator, IntegratorChoice, SymplecticEuler, NextGeneration, "How a tick updates velocities and positions.") \
    TOPIC("From genes to bodies")                                                                                      \
    REAL(radius_per_unit_px, 0.1, 0.001, 10, "px", NextGeneration, "Radius per unit of the gene body_size.")           \
    REAL(mass_per_unit_kg, 0.01, 0.0001, 1000, "kg", NextGeneration, "Mass per unit of the gene body_size.")           \
    REAL(force_per_unit, 1, 0, 1000, "kg px/s²", NextTick, "Force per unit of the genes normal_speed and impulse.")    \
    REAL(turn_rate_max_deg_s, 720, 0, 36'000, "°/s", NextTick, "Turn rate of an organism whose network has 1 at the output turn; −1 turns the other way.") \
    REAL(acceleration_max_px_s2, 100, 0, 100'000, "px/s²", NextTick, "Change of speed per second of an organism whose network has 1 at the output acceleration (kinematic); its speed stays within 0 to max_speed_px_s.") \
    TOPIC("Costs of genes")                                                                                            \
    REAL(normal_speed_cost, 0, 0, 10, "", NextGeneration, "Cost of the gene normal_speed: health loss is multiplied by 1 + the costs of all genes, this one being normal_speed_cost · (normal_speed/100 − 1).")    \
    REAL(impulse_cost, 0, 0, 10, "", NextGeneration, "Cost of the gene impulse, as for normal_speed_cost: impulse_cost · ((impulse/100)² − 1).")           \
    REAL(base_health_cost, 0, 0, 10, "", NextGeneration, "Cost of the gene base_health, as for normal_speed_cost: base_health_cost · (base_health/100 − 1).")      \
    REAL(food_radius_cost, 0, 0, 10, "", NextGeneration, "Cost of the gene food_radius, as for normal_speed_cost: food_radius_cost · ((food_radius/100)² − 1).")   \
    REAL(poison_radius_cost, 0, 0, 10, "", NextGeneration, "Cost of the gene poison_radius, as for normal_speed_cost: poison_radius_cost · ((poison_radius/100)² − 1).") \
    REAL(health_cap_per_size, 0, 0, 1000, "health", NextGeneration, "Upper limit of health after a meal, per unit of the gene body_size; 0 means no limit.") \
    REAL(body_size_cost, 0, -1, 10, "", NextGeneration, "Cost of the gene body_size, as for normal_speed_cost: body_size_cost · (body_size/100 − 1).") \
    TOPIC("Births")                                                                                                    \
    CHOICE(reproduction, Reproduction, Generations, Reset, "How organisms multiply: generations, the genetic algorithm breeds each next generation; births, organisms with enough health have children while they live, and a generation is an interval of statistics, after which the living live on.") \
    CHOICE(births, Births, Sexual, NextGeneration, "Parents of a child, with births: sexual, two organisms near each other; asexual, one.") \
    REAL(birth_health, 120, 0, 10'000, "health", NextTick, "Health from which an organism may have a child.")          \
    REAL(birth_cost, 20, 0, 10'000, "health", NextTick, "Health that a birth costs each parent, in addition to its share of the child's health.") \
    REAL(mate_px, 100, 0, 10'000, "px", NextTick, "Greatest distance of the two parents of a child, centre to centre.") \
    REAL(birth_every_s, 0.25, 0.001, 60, "s", NextGeneration, "Time from one search for parents to the next.")         \
    REAL(lifespan_s, 0, 0, 86'400, "s", NextGeneration, "Age at which an organism dies, with births; 0 means that no age is lethal.") \
    COUNT(population_max, 10'000, 1, 4'000'000, "organisms", NextGeneration, "Living organisms of a species on an island from which there are no further births.") \
    FLAG(shuffle_births, false, Reset, "Whether the genes of children come from parents that are drawn among the latest births, dead or alive: a control for experiments, in which births are as frequent as before but favour no gene.") \
    TOPIC("Predators")                                                                                                 \
    COUNT(predator_count, 0, 0, 4'000'000, "organisms", Reset, "Predators on each island: in every generation, or with births at their arrival. They eat the other organisms, the prey, and no food or poison. 0 means that there is no second species.") \
    COUNT(predator_from, 1, 1, 1'000'000, "generation", Reset, "Generation or interval at whose beginning predators arrive.") \
    REAL(prey_health, 60, 0, 10'000, "health", NextTick, "Health that a predator gains from a prey.")                  \
    REAL(handling_s, 6, 0, 3'600, "s", NextTick, "Time after a meal in which a predator wanders and neither sees nor eats prey.") \
    REAL(predator_health_loss_per_s, 6, 0, 10'000, "health/s", NextGeneration, "health_loss_per_s of predators; in an experiment file, the default is the file's health_loss_per_s.") \
    REAL(predator_initial_gene_min, 80, 0, 10'000, "gene units", Reset, "initial_gene_min of predators; in an experiment file, the default is the file's initial_gene_min.") \
    REAL(predator_initial_gene_max, 120, 0, 10'000, "gene units", Reset, "initial_gene_max of predators; in an experiment file, the default is the file's initial_gene_max.") \
    CHOICE(predator_selection, evolution::SelectionMethod, Roulette, NextTick, "selection of predators; in an experiment file, the default is the file's selection.") \
    REAL(predator_survivors, 0.5, 0, 1, "share", NextTick, "survivors of predators; in an experiment file, the default is the file's survivors.") \
    COUNT(predator_elite_count, 0, 0, 4'000'000, "organisms", NextTick, "elite_count of predators; in an experiment file, the default is the file's elite_count.") \
    CHOICE(predator_crossover, evolution::CrossoverMethod, Uniform, NextTick, "crossover of predators; in an experiment file, the default is the file's crossover.") \
    REAL(predator_mutation_chance, 0.15, 0, 1, "chance", NextTick, "mutation_chance of predators; in an experiment file, the default is the file's mutation_chance.") \
    REAL(predator_mutation_step, 15, 0, 1000, "gene units", NextTick, "mutation_step of predators; in an experiment file, the default is the file's mutation_step.") \
    CHOICE(predator_births, Births, Sexual, NextGeneration, "births of predators; in an experiment file, the default is the file's births.") \
    REAL(predator_birth_health, 120, 0, 10'000, "health", NextTick, "birth_health of predators; in an experiment file, the default is the file's birth_health.") \
    REAL(predator_birth_cost, 20, 0, 10'000, "health", NextTick, "birth_cost of predators; in an experiment file, the default is the file's birth_cost.") \
    REAL(predator_mate_px, 100, 0, 10'000, "px", NextTick, "mate_px of predators; in an experiment file, the default is the file's mate_px.") \
    REAL(predator_lifespan_s, 0, 0, 86'400, "s", NextGeneration, "lifespan_s of predators; in an experiment file, the default is the file's lifespan_s.") \
    COUNT(predator_population_max, 10'000, 1, 4'000'000, "organisms", NextGeneration, "population_max of predators; in an experiment file, the default is the file's population_max.")
// clang-format on

namespace evod::parameters {

/// Every parameter of a world. A set is valid if validate() returns no violations. The core receives only valid sets.
struct Parameters : evolution::Parameters {
    EVOD_MODEL_PARAMETERS(EVOD_NO_FIELD, EVOD_REAL_FIELD, EVOD_COUNT_FIELD, EVOD_FLAG_FIELD, EVOD_CHOICE_FIELD)
};

/// The parameters of the species of predators: `parameters`, with the values of predator_… in the place of the prey's.
/// Whatever computes something of a species takes the parameters of that species.
Parameters of_predators(Parameters parameters);

/// Whether organisms multiply by births; otherwise generations are bred.
inline bool has_births(const Parameters& parameters) {
    return parameters.reproduction == Reproduction::Births;
}
/// With births: if so many organisms of both species, alive or dead, have lived on an island in an interval, there are
/// no births until its end.
std::uint64_t interval_organisms_max(const Parameters& parameters);

/// A parameter value in files, options and messages. A choice is represented by its name.
using ParameterValue = std::variant<double, std::uint32_t, bool, std::string>;

std::string to_text(const ParameterValue& value);

/// Returns whether organisms have bodies and live on islands; false if the fitness needs only their chromosomes.
bool has_bodies(const Parameters& parameters);

struct RealParameter {
    base::RealRange range;
    double (*get)(const Parameters&);
    void (*set)(Parameters&, double);
};
struct CountParameter {
    base::CountRange range;
    std::uint32_t (*get)(const Parameters&);
    void (*set)(Parameters&, std::uint32_t);
};
struct FlagParameter {
    bool (*get)(const Parameters&);
    void (*set)(Parameters&, bool);
};
struct ChoiceParameter {
    std::span<const std::string_view> names;
    std::size_t (*get)(const Parameters&);
    void (*set)(Parameters&, std::size_t);
};

/// One parameter of the registry.
struct ParameterDescription {
    std::string_view name, unit, help;
    std::string_view topic; // heading under which people see the parameter; parameters of a topic are neighbours
    bool is_most_used;      // users change it often, so clients show it first
    base::Effect effect;
    std::variant<RealParameter, CountParameter, FlagParameter, ChoiceParameter> kind;

    ParameterValue get(const Parameters& parameters) const;
    ParameterValue default_value() const { return get(Parameters{}); }
    /// Copies the value of this parameter from `from` to `to`.
    void copy(const Parameters& from, Parameters& to) const;
    std::string allowed() const; // "0 to 1", "true or false", "roulette, tournament, …"
};

/// Parameters that take effect at a reset in worlds with births, whatever their description says: the living keep their
/// places and bodies.
std::span<const std::string_view> kept_with_births();

/// Returns when a change of a parameter takes effect in a world with the parameters `active`.
base::Effect effect_in(const Parameters& active, const ParameterDescription& description);

/// A parameter whose default in an experiment file is the file's value of another one, in generation 1.
struct Follower {
    std::string_view name, followed; // predator_mutation_chance, mutation_chance
};
std::span<const Follower> followers();

/// Returns all parameters in the order of their lists: the fitness function, the model, the genetic algorithm.
std::span<const ParameterDescription> parameter_registry();

/// Returns the parameters whose values differ between `a` and `b`, in the order of the registry.
std::vector<const ParameterDescription*> parameters_that_differ(const Parameters& a, const Parameters& b);

/// Returns the parameter with this name; nullptr if there is none.
const ParameterDescription* find_parameter(std::string_view name);

/// Returns the parameter names that are most similar to `name`.
std::vector<std::string> similar_parameter_names(std::string_view name);

struct Assignment {
    std::string name;
    ParameterValue value;
    friend bool operator==(const Assignment&, const Assignment&) = default;
};

/// Checks one assignment on its own: the name of its parameter, and the kind and range of its value.
std::optional<base::Violation> fault_of(const Assignment& assignment, std::string_view field_prefix = "");

/// Applies every assignment to `parameters`. A whole number is accepted for a real parameter. Refuses unknown and
/// repeated names, wrong kinds, values outside their range (NaN too), and values that do not fit together. Each
/// violation is named `field_prefix` + name.
base::Result<Parameters> assign(Parameters parameters, std::span<const Assignment> assignments,
                                std::string_view field_prefix = "");

/// Parses a value from text: "0.05", "true", "tournament".
base::Result<ParameterValue> parse_value(const ParameterDescription& description, std::string_view text);

/// Checks whether the parameters fit together; each must be within its range. Violations are, for example, a minimum
/// above its maximum, or organisms that do not fit on the island.
std::vector<base::Violation> validate(const Parameters& parameters, std::string_view field_prefix = "");

/// The size and the number of items of each island; scaled with the population if scale_with_population is on.
struct IslandPlan {
    double width_px, height_px;
    std::uint32_t food_count, poison_count;
};
IslandPlan island_plan(const Parameters& parameters);

bool operator==(const Parameters& a, const Parameters& b);

/// Parameters as requested; some may wait for a generation or a reset. The type prevents their use in the place of
/// parameters in effect, and the reverse.
struct RequestedParameters {
    explicit RequestedParameters(const Parameters& requested) : values{requested} {}

    Parameters values;
    friend bool operator==(const RequestedParameters&, const RequestedParameters&) = default;
};

/// The parameters in effect and the requested ones.
struct ParameterSet {
    Parameters active;                           // in effect now
    RequestedParameters requested{Parameters{}}; // in effect after all changes have taken effect
    std::uint64_t revision = 1;                  // increases with every accepted change

    /// Returns a set whose requested parameters are all in effect.
    static ParameterSet all_in_effect(const Parameters& parameters, std::uint64_t revision = 1) {
        return {parameters, RequestedParameters{parameters}, revision};
    }
    friend bool operator==(const ParameterSet&, const ParameterSet&) = default;
};

/// Like assign() above, for requested parameters.
base::Result<RequestedParameters> assign(const RequestedParameters& requested, std::span<const Assignment> assignments,
                                         std::string_view field_prefix = "");

/// Returns `set` after a change to `requested`: values that take effect at once become active, other values are only
/// requested.
ParameterSet after_request(const ParameterSet& set, const RequestedParameters& requested);

/// Returns `active` with the requested values of the parameters that take effect at `reached` or earlier (effect_in()).
Parameters taking_effect(const Parameters& active, const RequestedParameters& requested, base::Effect reached);

} // namespace evod::parameters
