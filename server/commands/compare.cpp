// `evod compare`: runs several worlds, or a world and its controls, with the same seeds, and tests the differences.
#include "proto/command_line/command.h"
#include "proto/files/unfinished_file.h"
#include "server/commands/colony_report.h"
#include "server/commands/commands.h"
#include "server/commands/common_options.h"
#include "server/commands/comparison_report.h"
#include "server/commands/interrupt.h"
#include "server/commands/json_lines.h"
#include "server/commands/plot_program.h"
#include "server/commands/progress_line.h"
#include "server/experiments/comparison_plan.h"
#include "server/runtime/random_ids.h"

#include <boost/json/array.hpp>

#include <unistd.h>

#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iostream>

namespace evod::commands {
namespace {

using experiments::ComparisonPlan;
using experiments::Course;

struct CompareOptions {
    experiments::ComparisonRequest request;
    std::uint32_t replicates = 20; // >= 2
    std::size_t jobs = default_thread_count();
    std::string csv, plot; // paths; empty: write no such file
    bool json = false;
};

constexpr std::uint32_t replicates_advised = 20;
constexpr int compared_max = 12; // maximum number of curves that a plot can show clearly

/// Whether the file can be created or written to. Does not change its contents.
bool can_be_written(const std::string& path) {
    std::error_code error;
    const bool existed = std::filesystem::exists(path, error);
    const bool writable = std::ofstream{path, std::ios::app}.good();
    if (writable && !existed) {
        std::filesystem::remove(path, error);
    }
    return writable;
}

/// Checks that all files that the options name can be written, so that a comparison of several minutes does not fail at
/// its end.
base::Result<void> check_outputs(const CompareOptions& options) {
    for (const auto& [option, path] : {std::pair{"--csv", &options.csv}, {"--plot", &options.plot}}) {
        if (!path->empty() && !can_be_written(*path)) {
            return refusal(base::RefusalCode::Unavailable, std::string{option} + ": cannot write " + *path);
        }
    }
    if (options.plot.empty()) {
        return {};
    }
    if (const auto checked = check_plot_program(); !checked) {
        return refusal(base::RefusalCode::FailedPrecondition, "--plot: " + to_text(checked.error()));
    }
    return {};
}

std::optional<std::vector<std::vector<Course>>> run(const ComparisonPlan& plan, const CompareOptions& options) {
    ProgressLine line{options.json};
    const auto start = std::chrono::steady_clock::now();
    experiments::RunsWanted wanted{.seed = plan.seed, .replicates = options.replicates, .jobs = options.jobs};
    wanted.progress = [&](double share) {
        line.show(share, [&] {
            const std::chrono::duration<double> gone = std::chrono::steady_clock::now() - start;
            char text[64];
            std::snprintf(text, sizeof text, "%3.0f %% of all generations, ", std::floor(share * 100));
            return text + time_left(share, gone.count());
        });
    };
    wanted.stopped = interrupted;
    auto courses = experiments::run_arms(plan.arms, wanted);
    line.clear();
    return courses;
}

/// Writes a file. If that fails, prints an error and returns false.
bool write_file(const std::string& option, const std::string& path, const auto& write) {
    files::UnfinishedFile file{path};
    write(file.stream());
    if (file.finish()) {
        return true;
    }
    fail(option + ": cannot write " + path + ": the disk may be full");
    return false;
}

/// A temporary file. The destructor deletes it.
class TemporaryFile {
  public:
    TemporaryFile() : path_{(std::filesystem::temp_directory_path() / "evod-curves-XXXXXX").string()} {
        if (const int file = ::mkstemp(path_.data()); file >= 0) {
            ::close(file);
        }
    }
    TemporaryFile(const TemporaryFile&) = delete;
    TemporaryFile& operator=(const TemporaryFile&) = delete;
    ~TemporaryFile() { ::unlink(path_.c_str()); }
    const std::string& path() const { return path_; }

  private:
    std::string path_;
};

bool write_plot(const std::string& path, const ComparisonPlan& plan, std::span<const std::vector<Course>> courses) {
    const TemporaryFile curves;
    if (!write_file("--plot", curves.path(),
                    [&](std::ostream& out) { experiments::write_curves(out, plan, courses); })) {
        return false;
    }
    const parameters::Parameters& world = plan.arms[0].parameters;
    const bool by_default = world.fitness == parameters::FitnessFunction::Life && world.fitness_per_second == 1 &&
                            world.fitness_per_health == 1 && world.fitness_per_food == 0 &&
                            world.fitness_per_poison == 0;
    const auto drawn = draw_curves(
        curves.path(), plan.arms[0].name + (plan.controls.empty() ? " and others" : " and its controls"),
        (plan.has_births() ? "mean number of prey in " : "mean fitness of ") + std::to_string(courses[0].size()) +
            " runs with the same seeds; bands: 95 % confidence interval of that mean",
        plan.has_births() ? "living prey"
        : by_default      ? "mean fitness (seconds lived + health at the end)"
                          : "mean fitness",
        path);
    if (!drawn) {
        fail("--plot: " + to_text(drawn.error()));
    }
    return drawn.has_value();
}

/// What the comparison prints before its runs.
std::string heading_of(const ComparisonPlan& plan, std::uint32_t replicates) {
    const std::string generations = std::to_string(plan.generations);
    return plan.arms[0].name + ": " + std::to_string(replicates) + " replicates of " + generations +
           (plan.has_births() ? " intervals" : " generations") + ", from seed " + std::to_string(plan.seed.value) +
           (plan.has_births()
                ? "\nlived: intervals at whose end all species lived, mean of the runs\n\n"
                : "\nrise: mean fitness of generation " + generations + " minus that of generation 1\n\n");
}

/// Adds to the result about an arm of worlds with births: the intervals that each run lived, and its species.
void add_persistence(std::span<const Course> courses, boost::json::object& world) {
    boost::json::array lived, species;
    for (const Course& course : courses) {
        lived.push_back(experiments::outcome_of(course));
        species.push_back(persistence_object(experiments::species_of(course)));
    }
    world["lived"] = std::move(lived);
    world["persistence"] = std::move(species);
}

/// The result for programs.
///
/// conclusions, report  the sentences and the whole text that are printed without --json.
boost::json::object result_object(const ComparisonPlan& plan, std::span<const std::vector<Course>> courses,
                                  std::span<const experiments::Finding> findings, const std::string& conclusions,
                                  const std::string& report) {
    boost::json::array worlds, not_run, differences;
    for (std::size_t arm = 0; arm < courses.size(); ++arm) {
        const Rise rise = rise_of_arm(plan.arms[arm], courses[arm]);
        boost::json::object world(
            {{"name", plan.arms[arm].name},
             {"first", rise.first},
             {"last", rise.last},
             {"rise", rise.mean},
             {"rise_low", rise.interval.low},
             {"rise_high", rise.interval.high},
             {"extinct", rise.extinct},
             {"changes", experiments::changes_between(plan.arms[0].parameters, plan.arms[arm].parameters)}});
        if (plan.has_births()) {
            add_persistence(courses[arm], world);
        }
        worlds.push_back(std::move(world));
    }
    for (const experiments::Control& control : plan.controls) {
        if (!control.cannot_differ.empty()) {
            not_run.push_back({{"name", control.name}, {"reason", control.cannot_differ}});
        }
    }
    for (std::size_t i = 0; i < findings.size(); ++i) {
        const experiments::Finding& finding = findings[i];
        differences.push_back({{"other", plan.arms[i + 1].name},
                               {"difference", finding.mean},
                               {"low", finding.interval.low},
                               {"high", finding.interval.high},
                               {"g", finding.effect_size ? boost::json::value(*finding.effect_size) : nullptr},
                               {"p", finding.p},
                               {"adjusted", finding.adjusted_p}});
    }
    return {{"seed", plan.seed.value},
            {"generations", plan.generations},
            {"worlds", std::move(worlds)},
            {"not_run", std::move(not_run)},
            {"differences", std::move(differences)},
            {"conclusions", conclusions},
            {"report", report}};
}

/// Prints results to stdout, and progress and errors to stderr. Returns the exit status. If the comparison is
/// interrupted, it neither prints nor writes results.
int compare(const CompareOptions& options) {
    const auto plan = experiments::plan_comparison(options.request);
    if (!plan) {
        return fail(plan.error());
    }
    if (const auto checked = check_outputs(options); !checked) {
        return fail(checked.error());
    }
    if (options.replicates < replicates_advised) {
        std::cerr << "evod: --replicates: fewer than " << replicates_advised
                  << " replicates can show only large differences\n";
    }
    catch_interrupts();
    const std::string heading = heading_of(*plan, options.replicates);
    if (!options.json) {
        std::fputs(heading.c_str(), stdout);
        std::fflush(stdout);
    }
    const auto courses = run(*plan, options);
    if (!courses) {
        if (!options.json) {
            std::puts("interrupted: there are no results");
        }
        return exit_interrupted;
    }
    const int decimals = decimals_for(*courses);
    std::string text = outcomes_text(*plan, *courses, decimals) + "\n";
    std::vector<experiments::Finding> findings;
    if (plan->arms.size() > 1) {
        findings = experiments::find_differences(*courses, plan->seed);
        text += findings_text(*plan, findings, decimals) + "\n";
    }
    const std::string conclusions = conclusions_text(*plan, *courses, findings, decimals);
    text += conclusions;
    if (options.json) {
        print_json(result_object(*plan, *courses, findings, conclusions, heading + text));
    } else {
        std::fputs(text.c_str(), stdout);
    }
    bool written = true;
    if (!options.csv.empty()) {
        written &= write_file("--csv", options.csv,
                              [&](std::ostream& out) { experiments::write_courses(out, *plan, *courses); });
    }
    if (!options.plot.empty()) {
        written &= write_plot(options.plot, *plan, *courses);
    }
    return written ? 0 : exit_error;
}

} // namespace

void add_compare_command(command_line::Command& app) {
    auto& command =
        app.add_command("compare", "Compare a world with its controls, or with other worlds, using the same seeds")
            .group("Experiments");
    auto& options = command.keep(CompareOptions{});
    auto& request = options.request;
    request.drawn_seed = runtime::draw_seed();
    command
        .add_option("experiments", &request.experiments,
                    "Experiment files (JSON). With --controls: one file, or none for the default world. Otherwise: "
                    "two or more files; the first is compared with each of the others")
        .count(0, compared_max);
    command.add_flag("--controls", &request.controls,
                     "Compare the world with its controls: random selection, no mutation, harmless poison and shuffled "
                     "fitness; a world with births: no mutation and unselected parents");
    command.add_option("--replicates", &options.replicates, "Number of runs of each world, each with its own seed")
        .check(command_line::WholeNumber{2, 10'000})
        .show_default();
    command
        .add_option("--generations", &request.generations,
                    "Number of generations of each run; default: the generation_limit of the first file, or " +
                        std::to_string(experiments::default_generations) +
                        ". No other criterion ends a run, but the extinction of the prey of a world with births")
        .check(command_line::WholeNumber{2, 1'000'000});
    command
        .add_option("--seed", &request.seed,
                    "Seed from which the seeds of all runs are derived; default: the seed of the first file, or a "
                    "random one")
        .check(any_number);
    command.add_option("--jobs", &options.jobs, "Number of simultaneous runs; it does not affect the results")
        .check(thread_count)
        .show_default();
    command.add_option("--set", &request.changes, "NAME=VALUE: set a parameter in all worlds");
    command.add_option("--csv", &options.csv, "CSV file to which the fitness of every run and generation is written");
    command.add_option("--plot,--picture", &options.plot,
                       "SVG, PNG or PDF file to which the curves are drawn; needs the package python3-matplotlib");
    add_json_option(command, options.json);
    command.footer("Exit status: 0 compared, 130 interrupted, 1 error.");
    command.action([&] { return compare(options); });
}

} // namespace evod::commands
