#include "server/parameters/model_parameters.h"

#include "proto/text/number_text.h"
#include "proto/text/suggestion.h"
#include "server/base/elementary.h"
#include "server/base/exact_number.h"
#include "server/base/overloaded.h"
#include "server/evolution/brain_layout.h"
#include "server/evolution/gene_layout.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdlib>
#include <iterator>
#include <optional>
#include <utility>

namespace evod::parameters {
namespace {

using base::Effect;
using base::Overloaded;
using text::number_text;

// The parameters that users change most often.
constexpr std::string_view most_used[] = {
    "food_count", "poison_count", "population_size", "selection", "tournament_size", "mutation_chance", "mutation_step",
};

// clang-format off
#define EVOD_TOPIC_LINE(title) topic = title;
#define EVOD_REAL_LINE(name, value, least, greatest, unit, effect, help)                                               \
    add(#name, unit, help, Effect::effect, RealParameter{{least, greatest},                                            \
        [](const Parameters& p) { return p.name; }, [](Parameters& p, double v) { p.name = v; }});
#define EVOD_COUNT_LINE(name, value, least, greatest, unit, effect, help)                                              \
    add(#name, unit, help, Effect::effect, CountParameter{{least, greatest},                                           \
        [](const Parameters& p) { return p.name; }, [](Parameters& p, std::uint32_t v) { p.name = v; }});
#define EVOD_FLAG_LINE(name, value, effect, help)                                                                      \
    add(#name, "", help, Effect::effect, FlagParameter{                                                                \
        [](const Parameters& p) { return p.name; }, [](Parameters& p, bool v) { p.name = v; }});
#define EVOD_CHOICE_LINE(name, Type, value, effect, help)                                                              \
    add(#name, "", help, Effect::effect, ChoiceParameter{base::ChoiceNames<Type>::names,                               \
        [](const Parameters& p) { return static_cast<std::size_t>(p.name); },                                          \
        [](Parameters& p, std::size_t v) { p.name = static_cast<Type>(v); }});
// clang-format on

std::vector<ParameterDescription> make_registry() {
    using namespace evolution; // for the names of enumerations in the lists
    using base::count_max;
    std::vector<ParameterDescription> registry;
    std::string_view topic;
    const auto add = [&](std::string_view name, std::string_view unit, std::string_view help, Effect effect,
                         decltype(ParameterDescription::kind) kind) {
        const bool is_most_used = std::ranges::find(most_used, name) != std::end(most_used);
        registry.push_back({name, unit, help, topic, is_most_used, effect, std::move(kind)});
    };
    EVOD_FITNESS_PARAMETERS(EVOD_TOPIC_LINE, EVOD_REAL_LINE, EVOD_COUNT_LINE, EVOD_FLAG_LINE, EVOD_CHOICE_LINE)
    EVOD_MODEL_PARAMETERS(EVOD_TOPIC_LINE, EVOD_REAL_LINE, EVOD_COUNT_LINE, EVOD_FLAG_LINE, EVOD_CHOICE_LINE)
    EVOD_EVOLUTION_PARAMETERS(EVOD_TOPIC_LINE, EVOD_REAL_LINE, EVOD_COUNT_LINE, EVOD_FLAG_LINE, EVOD_CHOICE_LINE)
    return registry;
}

/// Returns a value that is not allowed, for a message. The name of a choice is shown without quotation marks.
std::string quoted_unless_choice(const ParameterDescription& description, std::string_view text) {
    const bool is_choice = std::holds_alternative<ChoiceParameter>(description.kind);
    return is_choice ? std::string{text} : '"' + std::string{text} + '"';
}

/// Sets one parameter, or returns what is wrong with the value.
std::optional<base::Violation> set_value(const ParameterDescription& description, const ParameterValue& value,
                                         Parameters& parameters, std::string field) {
    const bool done =
        std::visit(Overloaded{[&](const RealParameter& real) {
                                  double number;
                                  if (const auto* given = std::get_if<double>(&value)) {
                                      number = *given;
                                  } else if (const auto* whole = std::get_if<std::uint32_t>(&value)) {
                                      number = *whole;
                                  } else {
                                      return false;
                                  }
                                  if (!(number >= real.range.min && number <= real.range.max)) { // a NaN is in no range
                                      return false;
                                  }
                                  real.set(parameters, number);
                                  return true;
                              },
                              [&](const CountParameter& count) {
                                  const auto* given = std::get_if<std::uint32_t>(&value);
                                  if (given == nullptr || *given < count.range.min || *given > count.range.max) {
                                      return false;
                                  }
                                  count.set(parameters, *given);
                                  return true;
                              },
                              [&](const FlagParameter& flag) {
                                  const auto* given = std::get_if<bool>(&value);
                                  if (given != nullptr) {
                                      flag.set(parameters, *given);
                                  }
                                  return given != nullptr;
                              },
                              [&](const ChoiceParameter& choice) {
                                  const auto* given = std::get_if<std::string>(&value);
                                  if (given == nullptr) {
                                      return false;
                                  }
                                  const auto found = std::find(choice.names.begin(), choice.names.end(), *given);
                                  if (found == choice.names.end()) {
                                      return false;
                                  }
                                  choice.set(parameters, static_cast<std::size_t>(found - choice.names.begin()));
                                  return true;
                              }},
                   description.kind);
    if (done) {
        return std::nullopt;
    }
    const auto* text = std::get_if<std::string>(&value);
    const bool number_as_text = text != nullptr && !std::holds_alternative<ChoiceParameter>(description.kind) &&
                                parse_value(description, *text);
    return base::Violation{std::move(field),
                           description.allowed() + (number_as_text ? "; write it without quotation marks" : ""),
                           text != nullptr ? quoted_unless_choice(description, *text) : to_text(value)};
}

/// Returns an upper bound on the share of an island in which the centre of a new body cannot be placed, if every
/// organism has the maximum size. Bodies of the same kind as the new body count only with their own area.
double covered_share(const Parameters& p, const IslandPlan& plan) {
    const auto square = [](double x) { return x * x; };
    const double radius = p.body_size_max * p.radius_per_unit_px;
    const double crate = p.crate_size_px, obstacle = p.obstacle_size_px;
    const auto share_of_room = [&](double covered, double half_size) {
        const double margin = std::max(half_size, p.spawn_margin_px);
        const double width = plan.width_px - 2 * margin, height = plan.height_px - 2 * margin;
        return width <= 0 || height <= 0 ? 1 : covered / (width * height);
    };
    const auto around_obstacles = [&](double half_size) { return p.obstacle_count * square(obstacle + 2 * half_size); };
    double share = share_of_room(around_obstacles(p.item_radius_px), p.item_radius_px);
    if (p.obstacle_count > 0) {
        share = std::max(share, share_of_room(0, obstacle / 2));
    }
    if (p.crate_count > 0) {
        share = std::max(share, share_of_room(p.crate_count * square(crate) + around_obstacles(crate / 2), crate / 2));
    }
    const double organisms = static_cast<double>(p.population_size) + p.predator_count;
    return std::max(share, share_of_room(organisms * base::pi * square(radius) +
                                             p.crate_count * square(crate + 2 * radius) + around_obstacles(radius),
                                         radius));
}

} // namespace

ParameterValue ParameterDescription::get(const Parameters& parameters) const {
    return std::visit(
        Overloaded{[&](const RealParameter& p) -> ParameterValue { return p.get(parameters); },
                   [&](const CountParameter& p) -> ParameterValue { return p.get(parameters); },
                   [&](const FlagParameter& p) -> ParameterValue { return p.get(parameters); },
                   [&](const ChoiceParameter& p) -> ParameterValue { return std::string{p.names[p.get(parameters)]}; }},
        kind);
}

void ParameterDescription::copy(const Parameters& from, Parameters& to) const {
    std::visit([&](const auto& parameter) { parameter.set(to, parameter.get(from)); }, kind);
}

std::string ParameterDescription::allowed() const {
    return std::visit(
        Overloaded{[](const RealParameter& p) { return number_text(p.range.min) + " to " + number_text(p.range.max); },
                   [](const CountParameter& p) {
                       return "a whole number, " + std::to_string(p.range.min) + " to " + std::to_string(p.range.max);
                   },
                   [](const FlagParameter&) { return std::string{"true or false"}; },
                   [](const ChoiceParameter& p) {
                       std::string names;
                       for (const std::string_view choice : p.names) {
                           names += (names.empty() ? "" : ", ") + std::string{choice};
                       }
                       return names;
                   }},
        kind);
}

std::string to_text(const ParameterValue& value) {
    return std::visit(
        Overloaded{[](double v) { return number_text(v); }, [](std::uint32_t v) { return std::to_string(v); },
                   [](bool v) { return std::string{v ? "true" : "false"}; }, [](const std::string& v) { return v; }},
        value);
}

std::span<const ParameterDescription> parameter_registry() {
    static const std::vector<ParameterDescription> registry = make_registry();
    return registry;
}

const ParameterDescription* find_parameter(std::string_view name) {
    const auto registry = parameter_registry();
    const auto found = std::find_if(registry.begin(), registry.end(), [&](const auto& d) { return d.name == name; });
    return found == registry.end() ? nullptr : &*found;
}

std::vector<std::string> similar_parameter_names(std::string_view name) {
    std::vector<std::string_view> names;
    for (const ParameterDescription& description : parameter_registry()) {
        names.push_back(description.name);
    }
    return text::nearest(name, names);
}

namespace {

/// Applies one assignment, or returns what is wrong with it.
std::optional<base::Violation> assign_one(const Assignment& assignment, std::string_view field_prefix,
                                          Parameters& parameters) {
    std::string field = std::string{field_prefix} + assignment.name;
    if (const ParameterDescription* description = find_parameter(assignment.name)) {
        return set_value(*description, assignment.value, parameters, std::move(field));
    }
    std::string allowed = "a parameter of the registry";
    for (const std::string& name : similar_parameter_names(assignment.name)) {
        allowed += (allowed.back() == 'y' ? "; did you mean " : ", ") + name;
    }
    return base::Violation{std::move(field), std::move(allowed), base::unknown_name};
}

} // namespace

std::optional<base::Violation> fault_of(const Assignment& assignment, std::string_view field_prefix) {
    Parameters ignored;
    return assign_one(assignment, field_prefix, ignored);
}

base::Result<Parameters> assign(Parameters parameters, std::span<const Assignment> assignments,
                                std::string_view field_prefix) {
    base::Refusal refusal{
        .code = base::RefusalCode::InvalidArgument, .message = "invalid parameter values", .violations = {}};
    if (const std::size_t most = parameter_registry().size(); assignments.size() > most) {
        // There may be very many assignments. Checking each of them would take too long.
        const std::string field =
            field_prefix.empty() ? "parameters" : std::string{field_prefix.substr(0, field_prefix.size() - 1)};
        refusal.violations.push_back(
            {field, "at most " + std::to_string(most) + ", each parameter once", std::to_string(assignments.size())});
        return refusal;
    }
    std::vector<std::string_view> seen;
    for (const Assignment& assignment : assignments) {
        if (std::find(seen.begin(), seen.end(), assignment.name) != seen.end()) {
            refusal.violations.push_back({std::string{field_prefix} + assignment.name, "given once", "given twice"});
        } else if (auto violation = assign_one(assignment, field_prefix, parameters)) {
            refusal.violations.push_back(std::move(*violation));
        }
        seen.push_back(assignment.name);
    }
    if (refusal.violations.empty()) {
        refusal.violations = validate(parameters, field_prefix);
    }
    if (!refusal.violations.empty()) {
        return refusal;
    }
    return parameters;
}

base::Result<RequestedParameters> assign(const RequestedParameters& requested, std::span<const Assignment> assignments,
                                         std::string_view field_prefix) {
    const base::Result<Parameters> assigned = assign(requested.values, assignments, field_prefix);
    if (!assigned) {
        return assigned.error();
    }
    return RequestedParameters{*assigned};
}

base::Result<ParameterValue> parse_value(const ParameterDescription& description, std::string_view text) {
    const char* end = text.data() + text.size();
    const auto refused = [&]() -> base::Result<ParameterValue> {
        const bool is_number = std::holds_alternative<RealParameter>(description.kind) ||
                               std::holds_alternative<CountParameter>(description.kind);
        return base::Refusal{
            .code = base::RefusalCode::InvalidArgument,
            .message = "cannot read the value of " + std::string{description.name},
            .violations = {{std::string{description.name}, description.allowed() + text::value_hint(text, is_number),
                            quoted_unless_choice(description, text)}}};
    };
    return std::visit(Overloaded{[&](const RealParameter&) -> base::Result<ParameterValue> {
                                     double value;
                                     const auto read = std::from_chars(text.data(), end, value);
                                     if (read.ec != std::errc{} || read.ptr != end) {
                                         return refused();
                                     }
                                     return ParameterValue{value};
                                 },
                                 [&](const CountParameter&) -> base::Result<ParameterValue> {
                                     double value; // 30.0 and 1e3 are whole numbers, too
                                     const auto read = std::from_chars(text.data(), end, value);
                                     if (read.ec != std::errc{} || read.ptr != end) {
                                         return refused();
                                     }
                                     const auto whole = base::whole_number_of(value);
                                     return whole ? ParameterValue{*whole} : refused();
                                 },
                                 [&](const FlagParameter&) -> base::Result<ParameterValue> {
                                     if (text != "true" && text != "false") {
                                         return refused();
                                     }
                                     return ParameterValue{text == "true"};
                                 },
                                 [&](const ChoiceParameter& choice) -> base::Result<ParameterValue> {
                                     if (std::find(choice.names.begin(), choice.names.end(), text) ==
                                         choice.names.end()) {
                                         return refused();
                                     }
                                     return ParameterValue{std::string{text}};
                                 }},
                      description.kind);
}

IslandPlan island_plan(const Parameters& p) {
    IslandPlan plan{p.island_width_px, p.island_height_px, p.food_count, p.poison_count};
    if (p.scale_with_population) {
        const double factor = static_cast<double>(p.population_size) / p.reference_population;
        const double side = std::sqrt(factor);
        const auto scaled = [&](std::uint32_t count) {
            return static_cast<std::uint32_t>(std::min(std::floor(count * factor + 0.5), 4e9));
        };
        plan = {p.island_width_px * side, p.island_height_px * side, scaled(p.food_count), scaled(p.poison_count)};
    }
    return plan;
}

bool has_bodies(const Parameters& parameters) {
    return parameters.fitness == FitnessFunction::Life ||
           (parameters.fitness == FitnessFunction::External && parameters.external_bodies);
}

std::span<const std::string_view> kept_with_births() {
    static constexpr std::string_view names[] = {"island_width_px",      "island_height_px", "scale_with_population",
                                                 "reference_population", "obstacle_count",   "obstacle_size_px",
                                                 "crate_count",          "crate_size_px",    "crate_mass_kg",
                                                 "radius_per_unit_px",   "mass_per_unit_kg", "population_size"};
    return names;
}

base::Effect effect_in(const Parameters& active, const ParameterDescription& description) {
    const auto kept = kept_with_births();
    return has_births(active) && std::ranges::find(kept, description.name) != kept.end() ? Effect::Reset
                                                                                         : description.effect;
}

std::span<const Follower> followers() {
    static constexpr Follower all[] = {{"reference_population", "population_size"},
                                       {"predator_health_loss_per_s", "health_loss_per_s"},
                                       {"predator_initial_gene_min", "initial_gene_min"},
                                       {"predator_initial_gene_max", "initial_gene_max"},
                                       {"predator_selection", "selection"},
                                       {"predator_survivors", "survivors"},
                                       {"predator_elite_count", "elite_count"},
                                       {"predator_crossover", "crossover"},
                                       {"predator_mutation_chance", "mutation_chance"},
                                       {"predator_mutation_step", "mutation_step"},
                                       {"predator_births", "births"},
                                       {"predator_birth_health", "birth_health"},
                                       {"predator_birth_cost", "birth_cost"},
                                       {"predator_mate_px", "mate_px"},
                                       {"predator_lifespan_s", "lifespan_s"},
                                       {"predator_population_max", "population_max"}};
    return all;
}

Parameters of_predators(Parameters p) {
    p.population_size = p.predator_count;
    p.health_loss_per_s = p.predator_health_loss_per_s;
    p.initial_gene_min = p.predator_initial_gene_min;
    p.initial_gene_max = p.predator_initial_gene_max;
    p.selection = p.predator_selection;
    p.survivors = p.predator_survivors;
    p.elite_count = p.predator_elite_count;
    p.crossover = p.predator_crossover;
    p.mutation_chance = p.predator_mutation_chance;
    p.mutation_step = p.predator_mutation_step;
    p.births = p.predator_births;
    p.birth_health = p.predator_birth_health;
    p.birth_cost = p.predator_birth_cost;
    p.mate_px = p.predator_mate_px;
    p.lifespan_s = p.predator_lifespan_s;
    p.population_max = p.predator_population_max;
    return p;
}

namespace {

/// The greatest number of living organisms on an island, of both species.
double organisms_max(const Parameters& p) {
    const double predators = p.predator_count;
    if (!has_births(p)) {
        return p.population_size + predators;
    }
    return std::max(p.population_size, p.population_max) +
           (predators > 0 ? std::max(p.predator_count, p.predator_population_max) : 0.0);
}

} // namespace

std::uint64_t interval_organisms_max(const Parameters& p) {
    return static_cast<std::uint64_t>(4 * organisms_max(p));
}

namespace {

/// The genes of all organisms together: 4 million organisms with a network of 25 weights, or 1.9 million with 58.
constexpr std::uint64_t genes_max = 124'000'000;

std::string_view group_name(evolution::GeneGroup group) {
    return base::ChoiceNames<evolution::GeneGroup>::names[static_cast<std::size_t>(group)];
}

/// "all, body, free"
std::string groups_with_genes(const Parameters& parameters) {
    using enum evolution::GeneGroup;
    std::string names{group_name(All)};
    for (const evolution::GeneGroup group : {Body, Brain, Free}) {
        if (evolution::genes_of(group, parameters).count > 0) {
            names += ", " + std::string{group_name(group)};
        }
    }
    return names;
}

/// The violations that validate() finds.
class Faults {
  public:
    explicit Faults(std::string_view field_prefix) : prefix_{field_prefix} {}

    void refuse(std::string_view field, std::string allowed, std::string got) {
        found_.push_back({prefix_ + std::string{field}, std::move(allowed), std::move(got)});
    }
    void require_order(std::string_view greater, double max, std::string_view lesser, double min) {
        if (min > max) {
            refuse(greater, "at least " + std::string{lesser} + " (" + number_text(min) + ")", number_text(max));
        }
    }
    std::vector<base::Violation> take() { return std::move(found_); }

  private:
    const std::string prefix_;
    std::vector<base::Violation> found_;
};

void check_orders(const Parameters& p, Faults& faults) {
    faults.require_order("initial_gene_max", p.initial_gene_max, "initial_gene_min", p.initial_gene_min);
    faults.require_order("predator_initial_gene_max", p.predator_initial_gene_max, "predator_initial_gene_min",
                         p.predator_initial_gene_min);
    faults.require_order("normal_speed_max", p.normal_speed_max, "normal_speed_min", p.normal_speed_min);
    faults.require_order("impulse_max", p.impulse_max, "impulse_min", p.impulse_min);
    faults.require_order("body_size_max", p.body_size_max, "body_size_min", p.body_size_min);
    faults.require_order("base_health_max", p.base_health_max, "base_health_min", p.base_health_min);
    faults.require_order("food_radius_max", p.food_radius_max, "food_radius_min", p.food_radius_min);
    faults.require_order("poison_radius_max", p.poison_radius_max, "poison_radius_min", p.poison_radius_min);
    faults.require_order("free_gene_max", p.free_gene_max, "free_gene_min", p.free_gene_min);
    faults.require_order("tournament_size", p.tournament_size, "tournament_winners", p.tournament_winners);
    if (p.selection == evolution::SelectionMethod::Tournament && !p.tournament_replacement) {
        faults.require_order("population_size", p.population_size, "tournament_size", p.tournament_size);
    }
    if (p.predator_count > 0 && p.predator_selection == evolution::SelectionMethod::Tournament &&
        !p.tournament_replacement) {
        faults.require_order("predator_count", p.predator_count, "tournament_size", p.tournament_size);
    }
}

/// Births leave nothing to the genetic algorithm but mutation and crossover.
void check_births(const Parameters& p, Faults& faults) {
    static constexpr std::string_view without_effect[] = {
        "fitness_per_second",     "fitness_per_health", "fitness_per_food",   "fitness_per_poison",
        "population_model",       "survivors",          "replaced_count",     "elite_count",
        "mutate_survivors",       "shuffle_fitness",    "fitness_scaling",    "ranking_pressure",
        "ranking_decay",          "selection",          "tournament_size",    "tournament_winners",
        "tournament_replacement", "predator_selection", "predator_survivors", "predator_elite_count"};
    if (!has_births(p)) {
        return;
    }
    if (p.fitness != FitnessFunction::Life) {
        faults.refuse("fitness", "life if reproduction is births: fitness is then the number of children",
                      to_text(find_parameter("fitness")->get(p)));
    }
    for (const std::string_view name : without_effect) {
        const ParameterDescription& description = *find_parameter(name);
        if (const ParameterValue value = description.get(p); value != description.default_value()) {
            faults.refuse(name,
                          to_text(description.default_value()) +
                              " if reproduction is births: life and death then select, not this parameter",
                          to_text(value));
        }
    }
    if (p.birth_every_s > p.generation_s) {
        faults.refuse("birth_every_s", "at most generation_s (" + number_text(p.generation_s) + ")",
                      number_text(p.birth_every_s));
    }
}

void check_totals(const Parameters& p, Faults& faults) {
    // Limits for a server with a few gigabytes of memory. The ranges of single parameters do not limit the totals over
    // all islands.
    const double living = p.island_count * organisms_max(p);
    if (living > 4e6) {
        faults.refuse(has_births(p) ? "population_max" : "island_count",
                      "at most 4000000 organisms on all islands together",
                      std::to_string(p.island_count) + " islands with a total of " + number_text(living));
    }
    const double organisms = has_births(p) ? static_cast<double>(p.island_count * interval_organisms_max(p)) : living;
    faults.require_order("brain_weight_limit", p.brain_weight_limit, "brain_weight_initial", p.brain_weight_initial);
    if (p.controller == evolution::Controller::Network && evolution::has_body_genes(p)) {
        if (evolution::brain_layout(p).inputs.empty()) {
            faults.refuse("sense_food",
                          "at least one sense: sense_food, sense_poison, sense_speed, sense_health or sense_wall",
                          "a network without inputs");
        }
        if (p.locomotion == evolution::Locomotion::Kinematic) {
            const auto require_none = [&](std::string_view field, std::uint32_t count) {
                if (count > 0) {
                    faults.refuse(field, "0 if locomotion is kinematic, because bodies then have no contacts",
                                  std::to_string(count));
                }
            };
            require_none("obstacle_count", p.obstacle_count);
            require_none("crate_count", p.crate_count);
        }
    }
    if (const auto genes = static_cast<std::uint64_t>(organisms) * evolution::gene_count(p); genes > genes_max) {
        const unsigned weights = evolution::brain_genes(p).count;
        faults.refuse(weights > p.free_genes ? "brain_hidden" : "free_genes",
                      "at most " + std::to_string(genes_max) + " genes in all organisms together",
                      std::to_string(static_cast<std::uint64_t>(organisms)) + " organisms with a total of " +
                          std::to_string(genes) + " genes");
    }
    if (const std::uint32_t listed = p.listed_genes.gene_count(); listed > 0 && p.free_genes != listed) {
        faults.refuse("free_genes", std::to_string(listed) + ", the number of genes in the list of the free genes",
                      std::to_string(p.free_genes));
    }
    if (evolution::genes_of(p.mutate_group, p).count == 0) {
        faults.refuse("mutate_group",
                      "a group with genes: " + groups_with_genes(p) + "; their number changes at a reset",
                      std::string{group_name(p.mutate_group)});
    }
}

void check_bodies(const Parameters& p, Faults& faults) {
    faults.require_order("generation_s", p.generation_s, "tick_s", p.tick_s);
    if (p.generation_s / p.tick_s > 1e9) {
        faults.refuse("generation_s", "at most 1e9 times tick_s", number_text(p.generation_s));
    }
    if (p.max_speed_px_s * p.tick_s > 5000) {
        faults.refuse("max_speed_px_s", "at most 5000 px per tick (tick_s)", number_text(p.max_speed_px_s));
    }
    const IslandPlan plan = island_plan(p);
    const std::string scaled = p.scale_with_population ? " after scaling with the population" : "";
    if (plan.width_px > 500'000) {
        faults.refuse("island_width_px", "at most 500000" + scaled, number_text(plan.width_px));
    }
    if (plan.height_px > 500'000) {
        faults.refuse("island_height_px", "at most 500000" + scaled, number_text(plan.height_px));
    }
    if (plan.food_count > 20'000'000) {
        faults.refuse("food_count", "at most 20000000" + scaled, std::to_string(plan.food_count));
    }
    if (plan.poison_count > 20'000'000) {
        faults.refuse("poison_count", "at most 20000000" + scaled, std::to_string(plan.poison_count));
    }
    const double items =
        static_cast<double>(p.island_count) * (static_cast<double>(plan.food_count) + plan.poison_count);
    if (items > 4e7) {
        faults.refuse("island_count", "at most 40000000 items on all islands together",
                      std::to_string(p.island_count) + " islands with a total of " + number_text(items));
    }
    if (const double side = std::min(plan.width_px, plan.height_px); 2 * p.spawn_margin_px >= side) {
        faults.refuse("spawn_margin_px", "less than half of the island's shorter side (" + number_text(side / 2) + ")",
                      number_text(p.spawn_margin_px));
        return;
    }
    if (const double share = covered_share(p, plan); share > 0.4) {
        faults.refuse("population_size",
                      "at most 0.4 of an island covered by organisms of the size body_size_max, crates and obstacles",
                      std::to_string(p.population_size) + " organisms, covered share " +
                          number_text(std::round(share * 1000) / 1000));
    }
}

} // namespace

std::vector<base::Violation> validate(const Parameters& p, std::string_view field_prefix) {
    Faults faults{field_prefix};
    check_orders(p, faults);
    check_totals(p, faults);
    check_births(p, faults);
    if (has_bodies(p)) {
        check_bodies(p, faults);
    } else if (p.predator_count > 0) {
        faults.refuse("predator_count", "0 if organisms have no bodies (fitness)", std::to_string(p.predator_count));
    }
    return faults.take();
}

Parameters taking_effect(const Parameters& active, const RequestedParameters& requested, base::Effect reached) {
    Parameters result = active;
    for (const ParameterDescription& description : parameter_registry()) {
        if (effect_in(active, description) <= reached) {
            description.copy(requested.values, result);
        }
    }
    if (reached == base::Effect::Reset) {
        result.listed_genes = requested.values.listed_genes;
    }
    return result;
}

ParameterSet after_request(const ParameterSet& set, const RequestedParameters& requested) {
    return {.active = taking_effect(set.active, requested, base::Effect::NextTick),
            .requested = requested,
            .revision = set.revision + 1};
}

std::vector<const ParameterDescription*> parameters_that_differ(const Parameters& a, const Parameters& b) {
    std::vector<const ParameterDescription*> differing;
    for (const ParameterDescription& description : parameter_registry()) {
        if (description.get(a) != description.get(b)) {
            differing.push_back(&description);
        }
    }
    return differing;
}

bool operator==(const Parameters& a, const Parameters& b) {
    return parameters_that_differ(a, b).empty() && a.listed_genes == b.listed_genes;
}

} // namespace evod::parameters
