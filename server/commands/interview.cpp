#include "server/commands/interview.h"

#include <istream>
#include <ostream>
#include <string>

namespace evod::commands {
namespace {

using parameters::Parameters;

struct Question {
    const char* name;
    bool (*matters)(const Parameters&); // receives the answers so far; false: the question is not asked
};

constexpr auto always = [](const Parameters&) { return true; };

constexpr Question questions[] = {
    {"population_size", always},
    {"food_count", always},
    {"poison_count", always},
    {"generation_s", always},
    {"generation_limit", always},
    {"population_model", always},
    {"survivors",
     [](const Parameters& p) {
         return p.population_model == evolution::PopulationModel::Hybrid ||
                p.population_model == evolution::PopulationModel::Nsga2;
     }},
    {"replaced_count",
     [](const Parameters& p) { return p.population_model == evolution::PopulationModel::SteadyState; }},
    {"elite_count", always},
    {"mutate_survivors", always},
    {"fitness_scaling", always},
    {"ranking_pressure",
     [](const Parameters& p) { return p.fitness_scaling == evolution::FitnessScaling::LinearRanking; }},
    {"ranking_decay",
     [](const Parameters& p) { return p.fitness_scaling == evolution::FitnessScaling::ExponentialRanking; }},
    {"selection", always},
    {"tournament_size", [](const Parameters& p) { return p.selection == evolution::SelectionMethod::Tournament; }},
    {"tournament_winners", [](const Parameters& p) { return p.selection == evolution::SelectionMethod::Tournament; }},
    {"tournament_replacement",
     [](const Parameters& p) { return p.selection == evolution::SelectionMethod::Tournament; }},
    {"crossover", always},
    {"crossover_cuts", [](const Parameters& p) { return p.crossover == evolution::CrossoverMethod::MultiPoint; }},
    {"crossover_spread_index",
     [](const Parameters& p) { return p.crossover == evolution::CrossoverMethod::SimulatedBinary; }},
    {"crossover_chance", [](const Parameters& p) { return p.crossover != evolution::CrossoverMethod::None; }},
    {"rearranging", always},
    {"rearrange_chance", [](const Parameters& p) { return p.rearranging != evolution::OrderMutationMethod::None; }},
    {"creep", always},
    {"mutation_chance", always},
    {"mutation_step", [](const Parameters& p) { return p.creep != evolution::Creep::Polynomial; }},
    {"mutation_spread_index", [](const Parameters& p) { return p.creep == evolution::Creep::Polynomial; }},
    {"out_of_bounds", always},
    {"reset_chance", always},
    {"scale_chance", always},
    {"scale_range", [](const Parameters& p) { return p.scale_chance > 0; }},
    {"bit_flip_chance", always},
    {"island_count", always},
    {"migration", [](const Parameters& p) { return p.island_count > 1; }},
    {"migration_epoch", [](const Parameters& p) { return p.migration != evolution::Topology::None; }},
    {"migrant_count", [](const Parameters& p) { return p.migration != evolution::Topology::None; }},
    {"emigrants", [](const Parameters& p) { return p.migration != evolution::Topology::None; }},
    {"immigrants_replace", [](const Parameters& p) { return p.migration != evolution::Topology::None; }},
};

} // namespace

base::Result<Parameters> interview(const Parameters& proposed, std::istream& in, std::ostream& out) {
    out << "Enter accepts the value in brackets.\n";
    Parameters answers = proposed;
    for (const Question& question : questions) {
        if (!question.matters(answers)) {
            continue;
        }
        const parameters::ParameterDescription& description = *parameters::find_parameter(question.name);
        while (true) {
            out << description.help << "\n  " << description.name << " (" << description.allowed()
                << (description.unit.empty() ? "" : "; ") << description.unit << ") ["
                << parameters::to_text(description.get(answers)) << "]: " << std::flush;
            std::string line;
            if (!std::getline(in, line)) {
                out << '\n';
                return refusal(base::RefusalCode::FailedPrecondition,
                               "--ask: the input ended before the answer to " + std::string{description.name} +
                                   "; an empty line accepts the value in brackets");
            }
            if (line.empty()) {
                break;
            }
            const auto value = parameters::parse_value(description, line);
            const base::Result<Parameters> changed =
                value ? parameters::assign(answers, {{{std::string{description.name}, *value}}}) : value.error();
            if (changed) {
                answers = *changed;
                break;
            }
            out << base::to_text(changed.error()) << '\n';
        }
    }
    return answers;
}

} // namespace evod::commands
