#include "server/protocol/ratings.h"

#include "proto/text/number_text.h"
#include "server/protocol/commands.h"

#include <cmath>
#include <string>

namespace evod::protocol {

simulation::SetFitness command_of(const v1::SetFitness& request, std::vector<base::Violation>& violations) {
    simulation::SetFitness command{.world = lookup_name(request.world()),
                                   .generation = request.generation(),
                                   .island = request.island(),
                                   .first_organism = request.first_organism(),
                                   .fitness = {request.fitness().begin(), request.fitness().end()},
                                   .genes = {request.genes().begin(), request.genes().end()}};
    if (command.fitness.empty()) {
        violations.push_back({"set_fitness.fitness", "at least one number", "none"});
    }
    for (std::size_t i = 0; i < command.fitness.size() && violations.size() < simulation::faults_max; ++i) {
        if (!(std::abs(command.fitness[i]) <= simulation::given_fitness_max)) { // also true for NaN
            violations.push_back({"set_fitness.fitness[" + std::to_string(i) + "]", "-1e100 to 1e100",
                                  text::number_text(command.fitness[i])});
        }
    }
    return command;
}

void add_awaited_islands(const simulation::World& world, google::protobuf::RepeatedField<std::uint32_t>& islands) {
    if (!world.awaits_fitness()) {
        return;
    }
    for (std::uint32_t island = 0; island < world.island_count(); ++island) {
        if (!world.is_rated(island)) {
            islands.Add(island);
        }
    }
}

} // namespace evod::protocol
