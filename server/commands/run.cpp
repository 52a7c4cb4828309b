// `evod run`: runs one experiment from beginning to end without a network.
#include "proto/command_line/command.h"
#include "proto/files/unfinished_file.h"
#include "server/commands/colony_report.h"
#include "server/commands/commands.h"
#include "server/commands/common_options.h"
#include "server/commands/interrupt.h"
#include "server/commands/interview.h"
#include "server/commands/json_lines.h"
#include "server/commands/progress_line.h"
#include "server/commands/report.h"
#include "server/commands/shared_worlds.h"
#include "server/experiments/experiment_file.h"
#include "server/experiments/population_file.h"
#include "server/experiments/run_recording.h"
#include "server/experiments/sweep_folder.h"
#include "server/replay/columns.h"
#include "server/runtime/random_ids.h"
#include "server/runtime/worker_pool.h"
#include "server/simulation/founders.h"
#include "server/simulation/world.h"
#include "server/simulation/world_name.h"

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <iostream>
#include <limits>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

namespace evod::commands {
namespace {

using Clock = std::chrono::steady_clock;

struct RunOptions {
    std::string experiment;              // path of an experiment file; empty: use the default world
    std::vector<std::string> population; // paths of CSV files; empty: draw the first generation at random
    bool clone_founders = false;         // fill places without an organism with copies instead of random organisms
    std::uint32_t every = 1;             // print and write only every n-th generation, and the last one
    std::optional<std::uint32_t> wall_s; // interrupt the run after this time
    std::optional<std::uint64_t> seed;
    std::optional<std::uint32_t> generations; // overrides generation_limit
    std::vector<std::string> changes;         // texts of the form "name=value"
    std::string csv;                          // path; empty: write no CSV file
    std::string run_file;                     // path; empty: write no run file
    bool ask = false;
    bool json = false;
    SharingOptions sharing;
};

/// Exit statuses of `evod run`, besides exit_error, exit_interrupted, and 0 for a limit or target that was reached.
constexpr int exit_value_not_allowed = 2, exit_stagnated = 3, exit_extinct = 4;

/// Ticks that processes simulate before they exchange results.
constexpr std::uint64_t ticks_per_slice = 240;

double seconds_since(Clock::time_point start) {
    return std::chrono::duration<double>(Clock::now() - start).count();
}

/// The computation time of a run.
struct ComputationTime {
    double start_s = 0, tick_s = 0, turnover_s = 0;
    double exchange_s = 0; // part of the other two: waiting for the processes of mpirun, and for what they send
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
    return experiment;
}

/// What a run begins with.
struct Beginning {
    parameters::Experiment experiment;
    simulation::FirstPopulation first_population;
};

base::Result<Beginning> beginning_of(const RunOptions& options) {
    auto experiment = experiment_of(options);
    if (!experiment) {
        return experiment.error();
    }
    auto first_population = experiments::load_population(options.population, experiment->parameters);
    if (!first_population) {
        base::Refusal refused = first_population.error();
        refused.message = "--population: " + refused.message;
        refused.code = base::RefusalCode::FailedPrecondition; // a file is at fault, not a value of the command line
        return refused;
    }
    return Beginning{*std::move(experiment), *std::move(first_population)};
}

using Recording = std::unique_ptr<experiments::RunRecording>; // nullptr: the run has no file

/// Opens the file of the run, and sets the seed of the run if it has none: to the stored one, or to a random one.
base::Result<Recording> open_recording(const RunOptions& options, Beginning& beginning) {
    parameters::Experiment& experiment = beginning.experiment;
    Recording recording;
    if (!options.run_file.empty()) {
        auto opened = experiments::RunRecording::open(options.run_file, experiment, beginning.first_population);
        if (!opened) {
            return opened.error();
        }
        recording = *std::move(opened);
        experiment.seed = recording->seed() ? recording->seed() : experiment.seed;
    }
    experiment.seed = experiment.seed.value_or(runtime::draw_seed());
    beginning.first_population =
        recording && recording->stored() != experiments::Stored::Nothing
            ? recording->first_population()
            : simulation::completed(beginning.first_population, experiment.parameters, *experiment.seed,
                                    options.clone_founders ? simulation::Filling::Clones
                                                           : simulation::Filling::FromSeed);
    return recording;
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
    if (cost.exchange_s > 0) {
        std::printf("exchange between processes %.3f s, %.1f %%\n", cost.exchange_s,
                    100 * cost.exchange_s / (cost.tick_s + cost.turnover_s));
    }
}

/// Prints why the run ended. Returns the exit status.
int print_outcome(evolution::Outcome outcome, bool has_births) {
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
        std::puts(has_births ? "ended: a species died out" : "ended: all organisms died");
        return exit_extinct;
    case evolution::Outcome::Running:
        break;
    }
    std::puts("ended: interrupted");
    return exit_interrupted;
}

/// Prints for programs why and how the run ended. Returns the exit status.
///
/// intervals  of a world with births; otherwise empty.
int print_end_as_json(const simulation::World& world, const ComputationTime& cost,
                      std::span<const experiments::SpeciesOfInterval> intervals) {
    const evolution::Outcome outcome = world.outcome();
    const bool is_running = outcome == evolution::Outcome::Running;
    boost::json::object end(
        {{"seed", world.seed().value},
         {"outcome", is_running ? std::string{"interrupted"} : std::string{experiments::name_of(outcome)}},
         {"generations", world.moment().generation - (world.generation_over() ? 0 : 1)},
         {"ticks", world.moment().tick},
         {"simulated_s", world.moment().simulated_s},
         {"state_hash", base::to_text(world.hash())},
         {"start_s", cost.start_s},
         {"tick_s", cost.tick_s},
         {"turnover_s", cost.turnover_s},
         {"exchange_s", cost.exchange_s},
         {"organism_ticks", cost.organism_ticks}});
    if (!intervals.empty()) {
        end["persistence"] = persistence_object(intervals);
    }
    print_json(end);
    return is_running                                  ? exit_interrupted
           : outcome == evolution::Outcome::Stagnation ? exit_stagnated
           : outcome == evolution::Outcome::Extinction ? exit_extinct
                                                       : 0;
}

/// Prints why and how the run ended. Returns the exit status.
///
/// intervals  of a world with births; otherwise empty.
int print_end(const simulation::World& world, const ComputationTime& cost,
              std::span<const experiments::SpeciesOfInterval> intervals) {
    const int status = print_outcome(world.outcome(), parameters::has_births(world.parameters().active));
    std::fputs(persistence_text(intervals).c_str(), stdout);
    print_summary(world, cost);
    std::fflush(stdout); // an mpirun that was interrupted kills its processes while they leave MPI
    return status;
}

/// The output of a run: the table on stdout, and the CSV file.
class Output {
  public:
    base::Result<void> open(const RunOptions& options, const parameters::Experiment& experiment,
                            const Recording& recording) {
        gene_names_ = replay::gene_names_of(experiment.parameters);
        several_islands_ = experiment.parameters.island_count > 1;
        has_births_ = parameters::has_births(experiment.parameters);
        is_colony_ = simulation::is_colony(experiment.parameters);
        colony_columns_ = replay::colony_columns_of(experiment.parameters);
        csv_path_ = options.csv;
        every_ = options.every;
        json_ = options.json;
        if (auto opened = open_csv(); !opened) {
            return opened;
        }
        if (auto read = read_stored(recording); !read) {
            return read;
        }
        if (json_) {
            return {};
        }
        std::printf("seed %llu\n", static_cast<unsigned long long>(experiment.seed->value));
        if (recording && recording->stored() == experiments::Stored::Whole) {
            std::printf("%s is complete: %llu generations\n", recording->path().c_str(),
                        static_cast<unsigned long long>(recording->continues_at()));
            return {};
        }
        if (recording && recording->stored() == experiments::Stored::Part) {
            std::printf("continues at generation %llu\n", static_cast<unsigned long long>(recording->continues_at()));
        }
        std::puts(table_heading(several_islands_, is_colony_).c_str());
        std::fflush(stdout);
        return {};
    }
    /// Writes the rows of a generation.
    ///
    /// last  whether the run ends with this generation.
    base::Result<void> write(const simulation::GenerationRows& rows, bool last) {
        follow_species(rows);
        if (!last && rows.front().generation % every_ != 0) {
            return {};
        }
        for (const simulation::GenerationStatistics& statistics : rows) {
            if (!json_) {
                std::puts(table_row(statistics, several_islands_, is_colony_).c_str());
            }
        }
        std::fflush(stdout);
        add_to_csv(rows);
        return flush_csv();
    }

    /// The species of every interval of the run, if the world has births.
    std::span<const experiments::SpeciesOfInterval> intervals() const { return intervals_; }

    /// Gives the CSV file its name. Called at the end of the run, also of one that was interrupted.
    base::Result<void> finish() {
        return !csv_ || csv_->finish() ? base::Result<void>{} : cannot_write_csv(std::strerror(errno));
    }

  private:
    base::Result<void> open_csv() {
        if (csv_path_.empty()) {
            return {};
        }
        csv_.emplace(csv_path_);
        if (!csv_->stream()) {
            return cannot_write_csv(std::strerror(errno));
        }
        errno = 0;
        table_.emplace(csv_->stream(), replay::Table::Format::Csv,
                       replay::statistics_columns(gene_names_, colony_columns_));
        return csv_->stream().flush() ? base::Result<void>{} : cannot_write_csv(std::strerror(errno));
    }
    /// Writes the rows of the stored generations to the CSV file.
    base::Result<void> read_stored(const Recording& recording) {
        if (!recording || (!table_ && !has_births_)) {
            return {};
        }
        auto read = recording->read_statistics([&](const std::vector<simulation::GenerationStatistics>& generation) {
            follow_species(generation);
            if (generation.front().generation % every_ == 0 || is_last_stored(*recording, generation)) {
                add_to_csv(generation);
            }
        });
        return read ? flush_csv() : read;
    }
    void follow_species(const std::vector<simulation::GenerationStatistics>& generation) {
        if (has_births_) {
            intervals_.push_back(experiments::species_of(
                generation, intervals_.empty() ? experiments::SpeciesOfInterval{} : intervals_.back()));
        }
    }
    /// Whether a whole run ends with this generation.
    static bool is_last_stored(const experiments::RunRecording& recording,
                               const std::vector<simulation::GenerationStatistics>& generation) {
        return recording.stored() == experiments::Stored::Whole &&
               generation.front().generation == recording.continues_at();
    }
    void add_to_csv(const std::vector<simulation::GenerationStatistics>& generation) {
        for (const simulation::GenerationStatistics& statistics : generation) {
            if (table_) {
                replay::write_row(*table_, statistics, gene_names_, colony_columns_);
            }
        }
    }
    base::Result<void> flush_csv() {
        return !table_ || csv_->stream().flush() ? base::Result<void>{} : cannot_write_csv("the disk may be full");
    }
    base::Refusal cannot_write_csv(const std::string& why) const {
        return refusal(base::RefusalCode::FailedPrecondition, "--csv: cannot write " + csv_path_ + ": " + why);
    }

    std::vector<std::string> gene_names_;
    std::vector<experiments::SpeciesOfInterval> intervals_;
    replay::ColonyColumns colony_columns_ = replay::ColonyColumns::None;
    bool several_islands_ = false, json_ = false, has_births_ = false, is_colony_ = false;
    std::uint32_t every_ = 1;
    std::string csv_path_;
    std::optional<files::UnfinishedFile> csv_;
    std::optional<replay::Table> table_;
};

/// A run while it is simulated.
struct Simulation {
    simulation::World world;
    base::Executor& executor;
    experiments::RunRecording* recording; // nullptr: the run has no file
    Output& output;
    ComputationTime& cost;
    std::optional<Clock::time_point> deadline = {}; // when --wall-time is over
    base::Result<void> written = {};                // the first error of a file
    ProgressLine progress{};

    /// Calls write() unless there was an error, and keeps its error.
    template <class Write>
    void try_to(Write&& write) {
        if (written) {
            written = write();
        }
    }
    void follow() {
        if (recording != nullptr) {
            try_to([&] { return recording->follow(world); });
        }
    }
    void breed_next_generation() {
        const auto began = Clock::now();
        world.breed_next_generation(executor);
        cost.turnover_s += seconds_since(began);
    }
    /// The tick up to which the world advances at once.
    std::uint64_t next_stop() const {
        const std::uint64_t tick = world.moment().tick;
        const std::uint64_t slice = recording != nullptr ? run_file::ticks_per_hash : ticks_per_slice;
        return world.is_shared() ? tick - tick % slice + slice : tick + 1;
    }
    void advance_slice() {
        const std::uint64_t before = world.moment().tick, alive = world.has_bodies() ? world.alive_count() : 0;
        world.advance(next_stop(), executor);
        cost.organism_ticks += alive * (world.moment().tick - before);
        follow();
    }
    /// Simulates until the generation ends. Returns whether the run has to stop.
    bool advance() {
        const auto began = Clock::now();
        bool stopped = !written;
        while (!stopped && !world.generation_over()) {
            advance_slice();
            progress.show([&] { return progress_of(world); });
            stopped = has_to_stop();
        }
        cost.tick_s += seconds_since(began);
        world.take_events();
        return stopped;
    }
    /// Stores and prints the results of the generation that has ended, and begins the next one. Returns whether the run
    /// has to stop.
    bool finish_generation() {
        const simulation::GenerationRows ended = world.history().back();
        const bool goes_on = world.outcome() == evolution::Outcome::Running;
        if (goes_on) {
            breed_next_generation();
            const auto began = Clock::now();
            advance_slice(); // a run file contains a generation from its first tick on, as a server writes it
            cost.tick_s += seconds_since(began);
        }
        if (recording != nullptr) {
            try_to([&] { return recording->commit(); });
        }
        progress.clear();
        try_to([&] { return output.write(ended, !goes_on); });
        return !goes_on || has_to_stop();
    }
    bool has_to_stop() const { return interrupted() || !written || (deadline && Clock::now() >= *deadline); }
    /// Simulates until the run ends, is interrupted or cannot be written.
    void run() {
        bool stopped = !written;
        while (!stopped) {
            stopped = advance();
            if (!world.generation_over()) {
                break;
            }
            stopped = finish_generation() || stopped;
        }
        progress.clear();
        if (recording != nullptr) {
            try_to([&] { return recording->close(world); });
        }
    }
};

/// Creates the world of a run, or continues the stored one.
simulation::World make_world(const Beginning& beginning, const Recording& recording, base::Executor& executor,
                             simulation::IslandsMaker* maker) {
    const auto& [experiment, first_population] = beginning;
    if (recording && recording->stored() == experiments::Stored::Part) {
        return recording->continued_world(experiment, first_population, executor, maker);
    }
    return {experiment.parameters, *experiment.seed, first_population, experiment.schedule, maker};
}

base::Result<void> fewer_processes_than_islands(std::uint32_t processes, std::uint32_t islands) {
    if (processes <= islands) {
        return {};
    }
    return refusal(base::RefusalCode::InvalidArgument,
                   std::to_string(processes) + " processes cannot share " + std::to_string(islands) +
                       (islands == 1 ? " island" : " islands") +
                       ": start at most one process per island, or set island_count");
}

/// Returns whether a server that finds the file in its data folder loads it.
bool is_file_of_server(const std::string& run_file) {
    const std::filesystem::path path{run_file};
    return path.extension() == ".evod" && simulation::is_world_name(path.stem().string());
}

/// Prints statistics to stdout, progress and errors to stderr. Returns the exit status.
int run(const RunOptions& options, const SharedWork& shared) {
    if (options.ask && shared.processes.size() > 1) {
        fail("--ask: not possible with several processes; start evod run without mpirun");
        return exit_value_not_allowed;
    }
    if (options.wall_s && shared.processes.size() > 1) {
        fail("--wall-time: not possible with several processes; give mpirun or the batch system the limit");
        return exit_value_not_allowed;
    }
    auto beginning = beginning_of(options);
    base::Result<void> sound =
        beginning ? fewer_processes_than_islands(shared.processes.size(), beginning->experiment.parameters.island_count)
                  : beginning.error();
    if (!sound) {
        const int status = fail(sound.error());
        return sound.error().code == base::RefusalCode::InvalidArgument ? exit_value_not_allowed : status;
    }
    catch_interrupts();
    if (shared.processes.rank() == 0) {
        warn_about(beginning->experiment.parameters, beginning->experiment.seed);
        if (!options.run_file.empty() && !is_file_of_server(options.run_file)) {
            warn(options.run_file + ": a server ignores this file in its folder, because a name of a world has only "
                                    "letters, digits, _ and -, and the file ends with .evod");
        }
    }
    const auto recording = open_recording(options, *beginning);
    if (!recording) {
        return fail(recording.error());
    }

    Output output;
    if (auto opened = output.open(options, beginning->experiment, *recording); !opened) {
        return fail(opened.error());
    }
    if (*recording && (*recording)->stored() == experiments::Stored::Whole) {
        const base::Result<void> finished = output.finish();
        if (finished && options.json) {
            print_json({{"seed", beginning->experiment.seed->value},
                        {"outcome", "complete before"},
                        {"generations", (*recording)->continues_at()}});
        }
        return finished ? 0 : fail(finished.error());
    }
    ComputationTime cost;
    const auto start = Clock::now();
    const std::unique_ptr<base::Executor> executor = runtime::make_executor(shared.threads);
    Simulation simulation{make_world(*beginning, *recording, *executor, shared.maker), *executor, recording->get(),
                          output, cost};
    cost.start_s = seconds_since(start);
    if (options.wall_s) {
        simulation.deadline = start + std::chrono::seconds{*options.wall_s};
    }
    if (*recording) {
        simulation.written = (*recording)->begin(simulation.world, runtime::draw_run_id());
    }
    simulation.run();
    simulation.try_to([&] { return output.finish(); });
    if (!simulation.written) {
        return fail(simulation.written.error());
    }
    cost.exchange_s = shared.processes.exchange_s();
    return options.json ? print_end_as_json(simulation.world, cost, output.intervals())
                        : print_end(simulation.world, cost, output.intervals());
}

/// The options that decide what is computed, as text. share_worlds() compares it between the processes.
std::string text_of(const RunOptions& options) {
    std::string text = "run " + options.experiment + "\n" + (options.clone_founders ? "clones" : "") + "\n" +
                       options.run_file + "\n" + std::to_string(options.seed.value_or(0)) + " " +
                       std::to_string(options.generations.value_or(0));
    for (const std::string& path : options.population) {
        text += "\npopulation " + path;
    }
    for (const std::string& change : options.changes) {
        text += "\n" + change;
    }
    return text;
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
        "ones. Given several times, the run begins with the organisms of all files. Places that are left get random "
        "organisms");
    command.add_flag("--clone-founders", &options.clone_founders,
                     "Fill the places that --population leaves with copies of its organisms, in turn");
    command
        .add_option("--generations", &options.generations,
                    "Number of generations, 0: no limit; default: the parameter generation_limit")
        .check(command_line::WholeNumber{.max = std::numeric_limits<std::uint32_t>::max()});
    add_sharing_options(command, options.sharing);
    command.add_option("--set", &options.changes, "NAME=VALUE: set a parameter; evod parameters lists all parameters");
    command.add_option("--csv", &options.csv,
                       "CSV file for the statistics of every generation; it has the ending .part until the run ends, "
                       "and then replaces a file of this name");
    command
        .add_option("--every", &options.every,
                    "Print and write only generations that this number divides, and the last one")
        .check(command_line::WholeNumber{.min = 1, .max = std::numeric_limits<std::uint32_t>::max()});
    command
        .add_option(
            "--wall-time", &options.wall_s,
            "Seconds after which the run is interrupted, as by Ctrl-C; with --run-file the same command continues "
            "it")
        .check(command_line::WholeNumber{.min = 1, .max = std::numeric_limits<std::uint32_t>::max()});
    command.add_option("--run-file", &options.run_file,
                       "Run file, NAME.evod, in which the run is stored; if it contains a part of this run, the run "
                       "continues at the beginning of the last generation in it");
    const auto with_json = add_json_option(command, options.json);
    command
        .add_flag("--ask", &options.ask,
                  "Prompt for population, food, poison, time and every setting of the genetic algorithm")
        .excludes(with_json);
    command.footer("Exit status: 0 limit or target reached, 3 stagnation, 4 extinction, 130 interrupted, 1 error, "
                   "2 a value is not allowed, 5 a process of mpirun was lost.");
    command.action([&] {
        return share_worlds(text_of(options), options.sharing, false,
                            [&](const SharedWork& shared) { return run(options, shared); });
    });
}

} // namespace evod::commands
