#include "server/experiments/comparison_plan.h"

#include "server/experiments/experiment_file.h"
#include "server/experiments/trials.h"
#include "server/replay/table.h"

#include <algorithm>
#include <ostream>

namespace evod::experiments {
namespace {

using base::RefusalCode;
using base::Result;

struct NamedExperiment {
    std::string name;
    parameters::Experiment experiment;
};

/// Loads the experiments and names them after their files. If a name occurs twice, the second one gets a number.
Result<std::vector<NamedExperiment>> load_named(const std::vector<std::string>& paths) {
    std::vector<NamedExperiment> named;
    for (const std::string& path : paths) {
        const auto loaded = load_experiment(path);
        if (!loaded) {
            return loaded.error();
        }
        const std::string name = world_name(path);
        const bool is_taken = std::ranges::count(named, name, &NamedExperiment::name) > 0;
        named.push_back({is_taken ? name + "_" + std::to_string(named.size() + 1) : name, *loaded});
    }
    if (named.empty()) {
        named.push_back({"default", {}});
    }
    return named;
}

Result<Arm> arm_of(const NamedExperiment& named, const std::vector<std::string>& changes, std::uint32_t generations) {
    auto experiment = with_changes(named.experiment, changes);
    if (!experiment) {
        return experiment.error();
    }
    experiment->parameters = of_fixed_length(experiment->parameters, generations);
    experiment->schedule = of_fixed_length(experiment->schedule);
    if (auto fits = match_schedule_to_parameters(*experiment); !fits) {
        return fits.error();
    }
    if (auto fault = fault_without_network(experiment->parameters)) {
        return base::Refusal{.code = RefusalCode::InvalidArgument,
                             .message = named.name + " cannot be compared",
                             .violations = {*std::move(fault)}};
    }
    return Arm{named.name, experiment->parameters, experiment->schedule};
}

void add_controls(ComparisonPlan& plan) {
    const Arm world = plan.arms[0];
    const std::span<const ControlKind> kinds = plan.has_births() ? std::span<const ControlKind>{controls_of_births}
                                                                 : std::span<const ControlKind>{all_controls};
    for (const ControlKind kind : kinds) {
        Control control = control_of(world.parameters, kind);
        if (schedule_affects(world.schedule, kind)) {
            control.cannot_differ.clear();
        }
        if (control.cannot_differ.empty()) {
            plan.arms.push_back({control.name, control.parameters, schedule_of(world.schedule, kind)});
        }
        plan.controls.push_back(std::move(control));
    }
}

} // namespace

Result<ComparisonPlan> plan_comparison(const ComparisonRequest& request) {
    if (request.controls && request.experiments.size() > 1) {
        return refusal(RefusalCode::InvalidArgument,
                       "--controls: got " + std::to_string(request.experiments.size()) +
                           " experiments, allowed one: the controls are variants of that world");
    }
    if (!request.controls && request.experiments.size() < 2) {
        return refusal(RefusalCode::InvalidArgument, "give --controls, or two or more experiments");
    }
    const auto named = load_named(request.experiments);
    if (!named) {
        return named.error();
    }
    const parameters::Experiment& first = named->front().experiment;
    const std::uint32_t limit = first.parameters.generation_limit;
    const std::uint32_t generations = request.generations.value_or(limit > 0 ? limit : default_generations);
    if (generations < 2) {
        return base::Refusal{.code = RefusalCode::InvalidArgument,
                             .message = "fitness cannot rise in one generation; see --generations",
                             .violations = {{"generation_limit", "at least 2", std::to_string(generations)}}};
    }
    ComparisonPlan plan{.arms = {},
                        .controls = {},
                        .seed = request.seed ? base::Seed{*request.seed} : first.seed.value_or(request.drawn_seed),
                        .generations = generations};
    for (const NamedExperiment& experiment : *named) {
        const auto arm = arm_of(experiment, request.changes, generations);
        if (!arm) {
            return arm.error();
        }
        if (!plan.arms.empty() && parameters::has_births(arm->parameters) != plan.has_births()) {
            return refusal(RefusalCode::InvalidArgument,
                           experiment.name + ": reproduction differs from that of " + plan.arms[0].name +
                               ": worlds with births are compared by the intervals that their species live, other "
                               "worlds by the rise of fitness");
        }
        plan.arms.push_back(*arm);
    }
    if (request.controls) {
        add_controls(plan);
    }
    return plan;
}

void write_courses(std::ostream& out, const ComparisonPlan& plan, std::span<const std::vector<Course>> courses) {
    std::vector<std::string> columns{"arm",          "replicate",    "seed",           "generation",
                                     "fitness_mean", "fitness_best", "organism_count", "alive_count"};
    if (plan.has_births()) {
        for (const std::string species : {"prey", "predators"}) {
            for (const char* column : {"_alive", "_mean", "_lowest", "_born"}) {
                columns.push_back(species + column);
            }
        }
    }
    replay::Table table{out, replay::Table::Format::Csv, columns};
    for (std::size_t arm = 0; arm < courses.size(); ++arm) {
        for (std::size_t replicate = 0; replicate < courses[arm].size(); ++replicate) {
            for (std::size_t i = 0; i < courses[arm][replicate].size(); ++i) {
                const GenerationFitness& generation = courses[arm][replicate][i];
                table.text(plan.arms[arm].name)
                    .number(replicate)
                    .number(replicate_seed(plan.seed, static_cast<std::uint32_t>(replicate)).value)
                    .number(i + 1)
                    .number(generation.mean)
                    .number(generation.best)
                    .number(generation.organism_count)
                    .number(generation.alive_count);
                for (const SpeciesInterval& species : generation.species) {
                    if (plan.has_births()) {
                        table.number(species.alive_count)
                            .number(species.count_mean)
                            .number(species.lowest_count)
                            .number(species.born_count);
                    }
                }
                table.end_row();
            }
        }
    }
}

void write_curves(std::ostream& out, const ComparisonPlan& plan, std::span<const std::vector<Course>> courses) {
    replay::Table table{out, replay::Table::Format::Csv, {"arm", "generation", "mean", "low", "high"}};
    for (std::size_t arm = 0; arm < courses.size(); ++arm) {
        for (std::uint32_t i = 0; i < plan.generations; ++i) {
            std::vector<double> values;
            for (const Course& course : courses[arm]) {
                values.push_back(!plan.has_births()  ? course[i].mean
                                 : i < course.size() ? course[i].species[0].count_mean
                                                     : 0.0);
            }
            const Interval interval = student_interval(values);
            table.text(plan.arms[arm].name)
                .number(i + 1)
                .number(mean_of(values))
                .number(interval.low)
                .number(interval.high)
                .end_row();
        }
    }
}

} // namespace evod::experiments
