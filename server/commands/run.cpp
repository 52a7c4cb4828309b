// `evod run`: runs one experiment from beginning to end without a network.
#include "proto/command_line/command.h"
#include "server/commands/commands.h"
#include "server/commands/common_options.h"
#include "server/commands/interrupt.h"
#include "server/commands/interview.h"
#include "server/commands/progress_line.h"
#include "server/commands/report.h"
#include "server/experiments/experiment_file.h"
#include "server/experiments/population_file.h"
#include "server/network/random_ids.h"
#include "server/replay/columns.h"
#include "server/runtime/worker_pool.h"
#include "server/simulation/world.h"

#include <cerrno>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstring>
#include <fstream>
#include <iostream>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace evod::commands {
namespace {

using Clock = std::chrono::steady_clock;

struct RunOptions {
    std::string experiment; // path of an experiment file; empty: use the default world
    std::string population; // path of a CSV file; empty: draw the first generation at random
    std::optional<std::uint64_t> seed;
    std::optional<std::uint32_t> generations; // overrides generation_limit
    std::size_t threads = default_thread_count();
    std::vector<std::string> changes; // texts of the form "name=value"
    std::string csv;                  // path; empty: write no CSV file
    bool ask = false;
};

/// Exit statuses of `evod run`, besides exit_error, exit_interrupted, and 0 for a limit or target that was reached.
constexpr int exit_value_not_allowed = 2, exit_stagnated = 3, exit_extinct = 4;

double seconds_since(Clock::time_point start) {
    return std::chrono::duration<double>(Clock::now() - start).count();
}

/// The computation time of a run.
struct ComputationTime {
    double start_s = 0, tick_s = 0, turnover_s = 0;
    std::uint64_t organism_ticks = 0; // sum of the organisms alive at the start of each tick
};

base::Result<parameters::Experiment> experiment_of(const RunOptions& options) {
    parameters::Experiment experiment;
    if (!options.experiment.empty()) {
        const auto loaded = experiments::load_experiment(options.experiment);
        if (!loaded) {
            return loaded.error();
        }
        experiment = *loaded;
    }
    auto changed = experiments::with_changes(std::move(experiment), options.changes);
    if (!changed) {
        return changed.error();
    }
    experiment = *std::move(changed);
    if (options.ask) {
        // An answer of the user replaces the schedule of its parameter; an empty answer keeps the schedule.
        const parameters::Parameters proposed = experiment.parameters;
        const auto answers = interview(proposed, std::cin, std::cout);
        if (!answers) {
            return answers.error();
        }
        experiment.parameters = *answers;
        for (const parameters::ParameterDescription* description :
             parameters::parameters_that_differ(experiment.parameters, proposed)) {
            experiment.schedule.remove(description->name);
        }
    }
    if (options.generations) {
        experiment.parameters.generation_limit = *options.generations;
        experiment.schedule.remove("generation_limit");
    }
    if (auto fits = experiments::match_schedule_to_parameters(experiment); !fits) {
        return fits.error();
    }
    if (auto fault = experiments::fault_without_network(experiment.parameters)) {
        return base::Refusal{.code = base::RefusalCode::InvalidArgument,
                             .message = "the experiment cannot be run without a network",
                             .violations = {*std::move(fault)}};
    }
    if (options.seed) {
        experiment.seed = base::Seed{*options.seed};
    }
    if (!experiment.seed) {
        experiment.seed = network::draw_seed();
    }
    return experiment;
}

std::string progress_of(const simulation::World& world) {
    char text[96];
    std::snprintf(text, sizeof text, "generation %llu  %.1f s  %llu alive",
                  static_cast<unsigned long long>(world.moment().generation),
                  static_cast<double>(world.moment().generation_tick) * world.parameters().active.tick_s,
                  static_cast<unsigned long long>(world.alive_count()));
    return text;
}

void print_summary(const simulation::World& world, const ComputationTime& cost) {
    std::printf("%llu generations, %llu ticks, %.1f simulated s; state %s\n",
                static_cast<unsigned long long>(world.moment().generation - (world.generation_over() ? 0 : 1)),
                static_cast<unsigned long long>(world.moment().tick), world.moment().simulated_s,
                base::to_text(world.hash()).c_str());
    if (cost.tick_s > 0) {
        std::printf("%.2f M organism-ticks/s, %s (%.2f s in ticks)\n",
                    static_cast<double>(cost.organism_ticks) / cost.tick_s / 1e6,
                    real_time_text(world.moment().simulated_s / cost.tick_s).c_str(), cost.tick_s);
    }
    std::printf("start-up %.3f s, turnover of generations %.3f s\n", cost.start_s, cost.turnover_s);
}

int status_of(evolution::Outcome outcome) {
    switch (outcome) {
    case evolution::Outcome::TargetFitness:
        std::puts("ended: target_fitness was reached");
        return 0;
    case evolution::Outcome::GenerationLimit:
        std::puts("ended: generation_limit was reached");
        return 0;
    case evolution::Outcome::Stagnation:
        std::puts("ended: the best fitness did not improve for stagnation_limit generations");
        return exit_stagnated;
    case evolution::Outcome::Extinction:
        std::puts("ended: all organisms died");
        return exit_extinct;
    case evolution::Outcome::Running:
        break;
    }
    std::puts("ended: interrupted");
    return exit_interrupted;
}

/// Prints statistics to stdout, progress and errors to stderr. Returns the exit status.
int run(const RunOptions& options) {
    const auto experiment = experiment_of(options);
    if (!experiment) {
        const int status = fail(experiment.error());
        return experiment.error().code == base::RefusalCode::InvalidArgument ? exit_value_not_allowed : status;
    }
    auto first_population = experiments::load_population(options.population, experiment->parameters);
    if (!first_population) {
        return fail("--population: " + base::to_text(first_population.error()));
    }
    const std::vector<std::string> gene_names = replay::gene_names_of(experiment->parameters);
    std::ofstream csv;
    std::optional<replay::Table> table;
    if (!options.csv.empty()) {
        errno = 0;
        csv.open(options.csv);
        table.emplace(csv, replay::Table::Format::Csv, replay::statistics_columns(gene_names));
        if (!csv.flush()) {
            return fail("--csv: cannot write " + options.csv + ": " + std::strerror(errno));
        }
    }
    catch_interrupts();

    ComputationTime cost;
    const auto start = Clock::now();
    const std::unique_ptr<base::Executor> executor = runtime::make_executor(options.threads);
    simulation::World world{experiment->parameters, *experiment->seed, *std::move(first_population),
                            experiment->schedule};
    cost.start_s = seconds_since(start);

    const bool several_islands = world.islands().size() > 1;
    std::printf("seed %llu\n%s\n", static_cast<unsigned long long>(world.seed().value),
                table_heading(several_islands).c_str());
    ProgressLine progress;
    while (!interrupted() && world.outcome() == evolution::Outcome::Running) {
        auto began = Clock::now();
        world.turn_over(*executor);
        cost.turnover_s += seconds_since(began);
        began = Clock::now();
        do {
            cost.organism_ticks += world.has_bodies() ? world.alive_count() : 0;
            world.advance_tick(*executor);
            progress.show([&] { return progress_of(world); });
        } while (!interrupted() && !world.generation_over());
        cost.tick_s += seconds_since(began);
        world.take_events();
        if (!world.generation_over()) {
            break;
        }
        progress.clear();
        for (const simulation::GenerationStatistics& statistics : world.history().back()) {
            std::puts(table_row(statistics, several_islands).c_str());
            if (table) {
                replay::write_row(*table, statistics, gene_names);
            }
        }
        std::fflush(stdout);
        if (table && !csv.flush()) {
            return fail("--csv: cannot write " + options.csv + ": the disk may be full");
        }
    }
    progress.clear();
    const int status = status_of(world.outcome());
    print_summary(world, cost);
    return status;
}

} // namespace

void add_run_command(command_line::Command& app) {
    auto& command = app.add_command("run", "Run an experiment without a network").group("Experiments");
    auto& options = command.keep(RunOptions{});
    command.add_option("experiment", &options.experiment, "Experiment file (JSON); default: the default world");
    command
        .add_option("--seed", &options.seed,
                    "Seed of the run; default: the seed of the experiment file, or a random one")
        .check(any_number);
    command.add_option(
        "--population", &options.population,
        "CSV file from `evod export --what population`; the run begins with its organisms instead of random "
        "ones");
    command
        .add_option("--generations", &options.generations,
                    "Number of generations, 0: no limit; default: the parameter generation_limit")
        .check(command_line::WholeNumber{.max = std::numeric_limits<std::uint32_t>::max()});
    command.add_option("--threads", &options.threads, "Number of simulation threads")
        .check(thread_count)
        .show_default();
    command.add_option("--set", &options.changes, "NAME=VALUE: set a parameter; evod parameters lists all parameters");
    command.add_option("--csv", &options.csv, "CSV file to which the statistics of every generation are written");
    command.add_flag("--ask", &options.ask,
                     "Prompt for population, food, poison, time and every setting of the genetic algorithm");
    command.footer("Exit status: 0 limit or target reached, 3 stagnation, 4 extinction, 130 interrupted, 1 error, "
                   "2 a value is not allowed.");
    command.action([&] { return run(options); });
}

} // namespace evod::commands
