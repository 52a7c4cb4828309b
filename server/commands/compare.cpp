#include "server/commands/compare.h"

#include "proto/command_line/command.h"
#include "server/commands/common_options.h"
#include "server/commands/curves_picture.h"
#include "server/commands/interrupt.h"
#include "server/commands/progress_line.h"
#include "server/commands/run.h"
#include "server/experiments/comparison.h"
#include "server/experiments/controls.h"
#include "server/experiments/experiment_file.h"
#include "server/experiments/trials.h"
#include "server/experiments/verdict.h"
#include "server/replay/table.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <iostream>

namespace evod::commands {
namespace {

using namespace experiments;

/// All that was asked for, found to be good.
struct Plan {
    std::vector<Arm> arms;         // that are run; the first is the world
    std::vector<Control> controls; // of the first; empty: other experiments are compared with it
    base::Seed seed;
    std::uint32_t generations;
};

base::Result<Plan> plan_of(const CompareOptions& options) {
    if (options.controls && options.experiments.size() > 1) {
        return refusal(base::RefusalCode::InvalidArgument,
                       "--controls are those of one experiment; got " + std::to_string(options.experiments.size()));
    }
    if (!options.controls && options.experiments.size() < 2) {
        return refusal(base::RefusalCode::InvalidArgument, "give --controls, or two experiments or more");
    }
    std::vector<parameters::Experiment> experiments;
    std::vector<std::string> names;
    for (const std::string& path : options.experiments) {
        const auto loaded = load_experiment(path);
        if (!loaded) {
            return loaded.error();
        }
        experiments.push_back(*loaded);
        const std::string name = world_name(path);
        names.push_back(std::ranges::count(names, name) == 0 ? name : name + "_" + std::to_string(names.size() + 1));
    }
    if (experiments.empty()) {
        experiments.emplace_back();
        names.emplace_back("default");
    }
    const std::uint32_t limit = experiments[0].parameters.generation_limit;
    const std::uint32_t generations = options.generations.value_or(limit > 0 ? limit : default_generations);
    if (generations < 2) {
        return base::Refusal{.code = base::RefusalCode::InvalidArgument,
                             .message = "nothing rises in so few generations; see --generations",
                             .violations = {{"generation_limit", "at least 2", std::to_string(generations)}}};
    }
    Plan plan{.arms = {},
              .controls = {},
              .seed = options.seed ? base::Seed{*options.seed} : experiments[0].seed.value_or(options.drawn_seed),
              .generations = generations};
    for (std::size_t i = 0; i < experiments.size(); ++i) {
        auto experiment = with_changes(experiments[i], options.changes);
        if (!experiment) {
            return experiment.error();
        }
        experiment->parameters = of_fixed_length(experiment->parameters, generations);
        experiment->schedule = of_fixed_length(experiment->schedule);
        if (auto fits = fit_schedule(*experiment); !fits) {
            return fits.error();
        }
        plan.arms.push_back({names[i], experiment->parameters, experiment->schedule});
    }
    if (options.controls) {
        const Arm world = plan.arms[0];
        for (const ControlKind kind : all_controls) {
            plan.controls.push_back(control_of(world.parameters, kind));
            if (matters(world.schedule, kind)) {
                plan.controls.back().cannot_differ.clear();
            }
            if (const Control& control = plan.controls.back(); control.cannot_differ.empty()) {
                plan.arms.push_back({control.name, control.parameters, schedule_of(world.schedule, kind)});
            }
        }
    }
    return plan;
}

/// Whether a file can be made or written there; leaves what there was.
bool can_be_written(const std::string& path) {
    std::error_code error;
    const bool was_there = std::filesystem::exists(path, error);
    const bool good = std::ofstream{path, std::ios::app}.good();
    if (good && !was_there) {
        std::filesystem::remove(path, error);
    }
    return good;
}

void write_csv(std::ostream& out, const Plan& plan, std::span<const std::vector<Course>> courses) {
    replay::Table table{
        out,
        replay::Table::Format::Csv,
        {"arm", "replicate", "seed", "generation", "fitness_mean", "fitness_best", "organism_count", "alive_count"}};
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
                    .number(generation.alive_count)
                    .end_row();
            }
        }
    }
}

std::string picture_of(const Plan& plan, std::span<const std::vector<Course>> courses) {
    std::vector<Curve> curves;
    for (std::size_t arm = 0; arm < courses.size(); ++arm) {
        Curve& curve = curves.emplace_back();
        curve.name = plan.arms[arm].name;
        for (std::uint32_t i = 0; i < plan.generations; ++i) {
            std::vector<double> means;
            for (const Course& course : courses[arm]) {
                means.push_back(course[i].mean);
            }
            const Interval interval = student_interval(means);
            curve.points.push_back({i + 1.0, mean_of(means), interval.low, interval.high});
        }
    }
    const bool lives = plan.arms[0].parameters.fitness == parameters::FitnessFunction::Life;
    return curves_picture({.title = plan.arms[0].name + (plan.controls.empty() ? " and others" : " and its controls"),
                           .subtitle = "mean fitness of " + std::to_string(courses[0].size()) +
                                       " runs with the same seeds; bands: 95 % confidence interval of that mean",
                           .x_label = "generation",
                           .y_label = lives ? "mean fitness (seconds lived + health at the end)" : "mean fitness"},
                          curves);
}

/// Writes it whole, or says why not.
bool write_file(const std::string& option, const std::string& path, const auto& write) {
    std::ofstream file{path, std::ios::binary};
    write(file);
    if (file.flush()) {
        return true;
    }
    std::cerr << "evod compare: " << option << ": cannot write " << path << ", the disk may be full\n";
    return false;
}

template <class... Values>
std::string formatted(const char* format, Values... values) {
    char text[256];
    std::snprintf(text, sizeof text, format, values...);
    return text;
}

int columns_of(const Plan& plan) {
    std::size_t width = 16;
    for (const Arm& arm : plan.arms) {
        width = std::max(width, arm.name.size());
    }
    return static_cast<int>(width);
}

std::string interval_text(const Interval& interval, int decimals) {
    return signed_text(interval.low, decimals) + " to " + signed_text(interval.high, decimals);
}

void print_rises(const Plan& plan, std::span<const std::vector<Course>> courses, int decimals) {
    const int name_width = columns_of(plan);
    std::printf("%-*s %9s %9s %9s  %-20s %7s  %s\n", name_width, "world", "first", "last", "rise", "95 % interval",
                "extinct", "what is changed");
    for (std::size_t arm = 0; arm < courses.size(); ++arm) {
        std::vector<double> first, last, rises;
        std::size_t extinct = 0; // generations in which everyone died
        for (const Course& course : courses[arm]) {
            first.push_back(course.front().mean);
            last.push_back(course.back().mean);
            rises.push_back(rise_of(course));
            extinct += static_cast<std::size_t>(std::ranges::count(course, 0u, &GenerationFitness::alive_count));
        }
        if (plan.arms[arm].parameters.fitness != parameters::FitnessFunction::Life) {
            extinct = 0;
        }
        std::string line =
            formatted("%-*s %9.*f %9.*f %9s  %-20s %7zu  ", name_width, plan.arms[arm].name.c_str(), decimals,
                      mean_of(first), decimals, mean_of(last), signed_text(mean_of(rises), decimals).c_str(),
                      interval_text(student_interval(rises), decimals).c_str(), extinct) +
            changes_between(plan.arms[0].parameters, plan.arms[arm].parameters);
        line.erase(line.find_last_not_of(' ') + 1);
        std::puts(line.c_str());
    }
    for (const Control& control : plan.controls) {
        if (!control.cannot_differ.empty()) {
            std::printf("%-*s is not run: %s\n", name_width, control.name.c_str(), control.cannot_differ.c_str());
        }
    }
}

void print_findings(const Plan& plan, std::span<const Finding> findings, int decimals) {
    const int name_width = columns_of(plan);
    std::printf("\nrise of %s less that of the other, seed by seed\n%-*s %10s  %-20s %7s %9s %9s\n",
                plan.arms[0].name.c_str(), name_width, "other", "difference", "95 % interval", "g", "p", "adjusted");
    for (std::size_t i = 0; i < findings.size(); ++i) {
        const Finding& finding = findings[i];
        std::printf("%-*s %10s  %-20s %7s %9.2g %9.2g\n", name_width, plan.arms[i + 1].name.c_str(),
                    signed_text(finding.mean, decimals).c_str(), interval_text(finding.interval, decimals).c_str(),
                    finding.effect_size ? signed_text(*finding.effect_size, 2).c_str() : "-", finding.p,
                    finding.adjusted_p);
    }
}

/// As many as tell the numbers of a comparison apart.
int decimals_for(std::span<const std::vector<Course>> courses) {
    double greatest = 0;
    for (const std::vector<Course>& of_arm : courses) {
        for (const Course& course : of_arm) {
            greatest = std::max({greatest, std::abs(course.front().mean), std::abs(course.back().mean)});
        }
    }
    return greatest >= 20 ? 1 : greatest >= 2 ? 2 : 4;
}

/// What is to be said of others than controls.
std::string sentence_of(const Arm& world, const Arm& other, const Finding& finding, std::size_t tests, int decimals) {
    const std::string by = signed_text(std::abs(finding.mean), decimals).substr(finding.mean != 0 ? 1 : 0);
    const std::string p = formatted(" (adjusted p = %.2g).", finding.adjusted_p);
    switch (judge(finding, tests)) {
    case Judgement::Above:
        return world.name + " rises further than " + other.name + ", by " + by + p;
    case Judgement::Below:
        return world.name + " rises less far than " + other.name + ", by " + by + p;
    case Judgement::CannotBeShown:
        return "Whether " + world.name + " and " + other.name + " differ cannot be told with so few replicates.";
    case Judgement::NotShown:
        break;
    }
    return "That " + world.name + " and " + other.name + " differ is not shown" + p;
}

void print_verdict(const Plan& plan, std::span<const std::vector<Course>> courses, std::span<const Finding> findings,
                   int decimals) {
    std::puts("");
    if (plan.controls.empty()) {
        for (std::size_t i = 0; i < findings.size(); ++i) {
            std::puts(sentence_of(plan.arms[0], plan.arms[i + 1], findings[i], findings.size(), decimals).c_str());
        }
        return;
    }
    std::vector<Weighed> weighed;
    std::size_t run = 0;
    for (const Control& control : plan.controls) {
        weighed.push_back(
            {control, control.cannot_differ.empty() ? std::optional{findings[run++]} : std::optional<Finding>{}});
    }
    std::vector<double> rises;
    for (const Course& course : courses[0]) {
        rises.push_back(rise_of(course));
    }
    for (const std::string& sentence : verdict(mean_of(rises), student_interval(rises), weighed, decimals)) {
        std::puts(sentence.c_str());
    }
}

} // namespace

int compare(const CompareOptions& options) {
    const auto plan = plan_of(options);
    if (!plan) {
        std::cerr << "evod compare: " << base::to_text(plan.error()) << '\n';
        return RunError;
    }
    for (const auto& [option, path] : {std::pair{"--csv", &options.csv}, {"--picture", &options.picture}}) {
        if (!path->empty() && !can_be_written(*path)) {
            std::cerr << "evod compare: " << option << ": cannot write " << *path << '\n';
            return RunError;
        }
    }
    if (options.replicates < replicates_advised) {
        std::cerr << "evod compare: --replicates: with fewer than " << replicates_advised
                  << " only large differences can be told from chance\n";
    }
    mind_interrupts();

    std::printf("%s: %u replicates of %u generations, from seed %llu\n", plan->arms[0].name.c_str(), options.replicates,
                plan->generations, static_cast<unsigned long long>(plan->seed.value));
    std::printf("rise: mean fitness of generation %u less that of generation 1\n\n", plan->generations);
    std::fflush(stdout);
    ProgressLine line;
    const auto start = std::chrono::steady_clock::now();
    RunsWanted wanted{.seed = plan->seed, .replicates = options.replicates, .jobs = options.jobs};
    wanted.progress = [&](double share) {
        line.show([&] {
            const std::chrono::duration<double> gone = std::chrono::steady_clock::now() - start;
            return formatted("%3.0f %% of all generations, ", std::floor(share * 100)) + time_left(share, gone.count());
        });
    };
    wanted.stopped = interrupted;
    const auto courses = run_arms(plan->arms, wanted);
    line.clear();
    if (!courses) {
        std::puts("interrupted: nothing is told of what was done");
        return Interrupted;
    }
    const int decimals = decimals_for(*courses);
    print_rises(*plan, *courses, decimals);
    std::vector<Finding> findings;
    if (plan->arms.size() > 1) {
        findings = find_differences(*courses, plan->seed);
        print_findings(*plan, findings, decimals);
    }
    print_verdict(*plan, *courses, findings, decimals);
    bool written = true;
    if (!options.csv.empty()) {
        written &= write_file("--csv", options.csv, [&](std::ostream& out) { write_csv(out, *plan, *courses); });
    }
    if (!options.picture.empty()) {
        written &=
            write_file("--picture", options.picture, [&](std::ostream& out) { out << picture_of(*plan, *courses); });
    }
    return written ? 0 : RunError;
}

void add_compare_command(command_line::Command& app, std::size_t jobs, base::Seed drawn_seed) {
    auto& command = app.add_command(
        "compare", "Did evolution do it? A world beside its controls, or beside other worlds, with the same seeds");
    auto& options = command.keep(CompareOptions{});
    options.drawn_seed = drawn_seed;
    options.jobs = jobs;
    command
        .add_option("experiments", &options.experiments,
                    "JSON files: one with --controls, without it the default world; or the first against each other")
        .count(0, compared_max);
    command.add_flag("--controls", &options.controls,
                     "Beside random selection, mutation off, harmless poison and shuffled fitness");
    command.add_option("--replicates", &options.replicates, "Runs of each world, a seed each")
        .range(2, 10'000)
        .show_default();
    command
        .add_option("--generations", &options.generations,
                    "Of each run; otherwise the first file's generation_limit, or " +
                        std::to_string(default_generations) + ". No other criterion ends a run")
        .range(2, 1'000'000);
    command.add_option("--seed", &options.seed, "That the seeds follow from; otherwise the file's, or by chance")
        .check(any_number);
    command.add_option("--jobs", &options.jobs, "Runs at a time; nothing that is told depends on it")
        .range(1, 1024)
        .show_default();
    command.add_option("--set", &options.changes, "name=value of a parameter, for all of them");
    command.add_option("--csv", &options.csv, "File for the fitness of every run and generation");
    command.add_option("--picture", &options.picture, "File for the curves, as SVG");
    command.footer("Exit status: 0 compared, 130 interrupted, 1 error.");
    command.action([&] { return compare(options); });
}

} // namespace evod::commands
