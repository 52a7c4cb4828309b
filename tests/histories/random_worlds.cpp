#include "tests/histories/random_worlds.h"

#include "server/protocol/commands.h"
#include "server/protocol/parameters.h"
#include "server/protocol/populations.h"
#include "tests/histories/random_parameters.h"

#include <algorithm>
#include <cstdint>
#include <memory>
#include <string_view>
#include <utility>
#include <vector>

namespace evod::histories {
namespace {

using parameters::ParameterValue;

class Assignments {
  public:
    explicit Assignments(v1::CreateWorld& create) : create_{create} {}
    /// Sets a parameter, unless it has been set.
    void set(std::string_view name, const ParameterValue& value) {
        const bool is_set = std::ranges::any_of(create_.parameters(), [&](const auto& a) { return a.name() == name; });
        if (!is_set) {
            v1::ParameterAssignment& added = *create_.add_parameters();
            added.set_name(std::string{name});
            *added.mutable_value() = protocol::to_proto(value);
        }
    }
    void draw(std::string_view name, Draws& draws) {
        set(name, random_value(*parameters::find_parameter(name), draws));
    }

  private:
    v1::CreateWorld& create_;
};

/// Sets what colonies depend on: worlds with births, and worlds with predators.
void add_colony(Assignments& assignments, Draws& draws) {
    if (draws.chance(0.7)) {
        assignments.set("reproduction", "births");
        assignments.set("food_count", draws.count(20, 60));
        assignments.set("generation_s", draws.number(0.5, 1.5));
        for (const char* name : {"births", "birth_health", "birth_cost", "mate_px", "birth_every_s", "lifespan_s",
                                 "population_max", "shuffle_births"}) {
            assignments.draw(name, draws);
        }
    }
    if (draws.chance(0.6)) {
        assignments.set("predator_count", draws.count(1, 15));
        for (const char* name : {"predator_from", "prey_health", "handling_s", "predator_births",
                                 "predator_birth_health", "predator_lifespan_s", "predator_population_max"}) {
            assignments.draw(name, draws);
        }
    }
}

void add_kind_of_world(Assignments& assignments, Draws& draws) {
    const std::uint64_t kind = draws.below(12);
    if (kind >= 10) {
        add_colony(assignments, draws);
    } else if (kind < 3) {
        assignments.set("fitness", "external");
        assignments.set("external_bodies", draws.chance(0.6));
        assignments.set("objectives", draws.count(1, 3));
    } else if (kind == 3) {
        assignments.set("fitness", draws.chance(0.5) ? "gene_sum" : "rastrigin");
    }
    if (draws.chance(0.35)) {
        assignments.set("controller", "network");
        assignments.draw("locomotion", draws);
        assignments.draw("brain_hidden", draws);
        for (const char* sense : {"sense_speed", "sense_health", "sense_wall", "sense_bearing_only", "brain_bias"}) {
            assignments.draw(sense, draws);
        }
    }
    if (draws.chance(0.3)) {
        assignments.draw("free_genes", draws);
    }
    if (draws.chance(0.5)) {
        assignments.draw("island_count", draws);
        assignments.draw("migration", draws);
        assignments.draw("migration_epoch", draws);
        assignments.draw("migrant_count", draws);
    }
}

void add_schedule(v1::CreateWorld& create, Draws& draws) {
    for (std::uint32_t values = draws.count(1, 4); values > 0; --values) {
        const auto& description = draws.one_of(parameters::parameter_registry());
        if (parameters::can_be_scheduled(description)) {
            v1::ScheduledValue& value = *create.add_schedule();
            value.set_name(std::string{description.name});
            value.set_generation(draws.count(2, 6));
            *value.mutable_value() = protocol::to_proto(random_value(description, draws));
        }
    }
}

v1::Request drawn_world(const std::string& name, Draws& draws) {
    v1::Request request;
    request.set_client_key("test");
    v1::CreateWorld& create = *request.mutable_create_world();
    create.set_name(name);
    create.set_seed(draws.below(1000));
    Assignments assignments{create};
    add_kind_of_world(assignments, draws);
    assignments.draw("population_size", draws);
    assignments.set("generation_s", draws.number(0.03, 1.5));
    assignments.set("food_count", draws.chance(0.3) ? 0U : draws.count(1, 40));
    assignments.set("poison_count", draws.count(0, 30));
    if (draws.chance(0.4)) {
        assignments.set("health_loss_per_s", draws.number(0, 150));
    }
    for (std::uint32_t more = draws.count(0, 5); more > 0; --more) {
        const auto& description = draws.one_of(parameters::parameter_registry());
        assignments.set(description.name, random_value(description, draws));
    }
    if (draws.chance(0.35)) {
        add_schedule(create, draws);
    }
    return request;
}

/// Adds a first population, other than the one that the seed of the world would draw.
void add_population(v1::CreateWorld& create, const parameters::Parameters& parameters, Draws& draws) {
    std::vector<evolution::GeneMatrix> islands;
    for (std::uint32_t island = 0; island < parameters.island_count; ++island) {
        islands.push_back(evolution::initial_population(parameters.population_size, parameters,
                                                        base::Seed{1000 + draws.below(1000)}, island));
    }
    protocol::add_population(create, std::make_shared<const std::vector<evolution::GeneMatrix>>(std::move(islands)));
}

} // namespace

v1::Request random_world(const std::string& name, Draws& draws) {
    for (;;) {
        v1::Request request = drawn_world(name, draws);
        const auto command = protocol::to_command(request, {});
        if (!command) {
            continue; // the values do not fit together
        }
        if (draws.chance(0.3)) {
            add_population(*request.mutable_create_world(), std::get<simulation::CreateWorld>(*command).parameters,
                           draws);
        }
        return request;
    }
}

} // namespace evod::histories
