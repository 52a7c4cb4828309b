// `evod sweep`: runs an experiment many times with different parameters and seeds, on one or several machines.
#include "proto/command_line/command.h"
#include "server/base/packing.h"
#include "server/commands/agreement.h"
#include "server/commands/commands.h"
#include "server/commands/common_options.h"
#include "server/commands/interrupt.h"
#include "server/commands/json_lines.h"
#include "server/commands/progress_line.h"
#include "server/experiments/sweep_file.h"
#include "server/experiments/sweep_folder.h"
#include "server/experiments/sweep_runner.h"
#include "server/parameters/warnings.h"
#include "server/runtime/processes.h"
#include "server/runtime/random_ids.h"
#include "server/simulation/model_version.h"

#include <boost/json/array.hpp>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <ctime>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <map>
#include <mutex>
#include <numeric>
#include <optional>
#include <string>
#include <vector>

namespace evod::commands {
namespace {

using base::Refusal;
using base::Result;
using experiments::Sweep;
using experiments::SweepFolder;
using Clock = std::chrono::steady_clock;

struct SweepOptions {
    std::string file; // path of the sweep file
    // Folder for the results; empty: the name of the sweep file without its extension.
    std::string out;
    std::optional<std::uint32_t> jobs;      // number of simultaneous runs of a process, >= 1
    bool run_files = false;                 // also write a run file for each run
    std::optional<std::size_t> array_index; // run only this cell
    bool gather = false;                    // only write runs.csv
    bool dry_run = false;                   // only print cells and seeds
    std::optional<std::size_t> run;         // execute only this run, and write its rows into `part`
    std::string part;                       // path of a file
    bool json = false;
};

/// Prints the progress of all runs to stderr. The threads of the runner call it.
class Progress {
  public:
    /// work  total work of the runs; nullopt: unknown, so progress is measured by the number of finished runs.
    Progress(std::size_t runs, std::optional<double> work, bool json) : runs_{runs}, work_{work}, line_{json} {}

    void generation_done(double work) {
        const std::scoped_lock lock{mutex_};
        done_ += work;
        show();
    }
    void run_done(double work) {
        const std::scoped_lock lock{mutex_};
        ++runs_done_;
        done_ += work;
        show();
    }
    void clear() const { line_.clear(); }
    double seconds() const { return std::chrono::duration<double>(Clock::now() - start_).count(); }

  private:
    void show() {
        const double share = work_ ? done_ / *work_ : static_cast<double>(runs_done_) / static_cast<double>(runs_);
        line_.show(share, [&] {
            const double s = seconds();
            const double rate = static_cast<double>(runs_done_) / s;
            char text[96];
            std::snprintf(text, sizeof text, "%zu of %zu runs, %.3g runs/%s", runs_done_, runs_,
                          rate < 1 ? 60 * rate : rate, rate < 1 ? "min" : "s");
            // The line contains no remaining time in the first two seconds, because an estimate would be unreliable.
            return std::string{text} + (s > 2 && share > 0 ? ", " + time_left(share, s) : "");
        });
    }

    const Clock::time_point start_ = Clock::now();
    const std::size_t runs_;
    const std::optional<double> work_;
    std::mutex mutex_; // guards the members below
    std::size_t runs_done_ = 0;
    double done_ = 0;
    ProgressLine line_;
};

std::string counted(std::size_t count, const std::string& what) {
    return std::to_string(count) + " " + what + (count == 1 ? "" : "s");
}

std::string plan_text(const SweepOptions& options, const Sweep& sweep) {
    return options.file + ": " + counted(sweep.cells.size(), "cell") + " of " + counted(sweep.replicates, "replicate") +
           ", " + counted(sweep.run_count(), "run") + ", seed " + std::to_string(sweep.seed.value);
}

std::string seed_text(const Sweep& sweep, std::uint32_t replicate) {
    return std::to_string(sweep.seed_of(replicate).value);
}

/// Prints the runs of the sweep as two tables with tab-separated columns: seeds by replicate, and values by cell.
void print_cells(const SweepOptions& options, const Sweep& sweep) {
    std::printf("%s\n\nreplicate\tseed\n", plan_text(options, sweep).c_str());
    for (std::uint32_t replicate = 0; replicate < sweep.replicates; ++replicate) {
        std::printf("%u\t%s\n", replicate, seed_text(sweep, replicate).c_str());
    }
    std::string heading = "\ncell";
    for (const parameters::ParameterDescription* parameter : sweep.swept) {
        heading += "\t" + std::string{parameter->name};
    }
    std::puts(heading.c_str());
    for (std::size_t cell = 0; cell < sweep.cells.size(); ++cell) {
        std::string row = std::to_string(cell);
        for (const parameters::ParameterValue& value : sweep.cells[cell]) {
            row += "\t" + parameters::to_text(value);
        }
        std::puts(row.c_str());
    }
}

void print_seeds(const Sweep& sweep) {
    constexpr std::uint32_t printed_max = 10;
    std::string text = "seeds of the replicates:";
    for (std::uint32_t replicate = 0; replicate < std::min(sweep.replicates, printed_max); ++replicate) {
        text += " " + seed_text(sweep, replicate);
    }
    std::puts((text + (sweep.replicates > printed_max ? " …; --dry-run prints all of them" : "")).c_str());
}

/// The runs of the sweep for programs.
boost::json::object plan_object(const Sweep& sweep) {
    boost::json::array seeds, parameters, cells;
    for (std::uint32_t replicate = 0; replicate < sweep.replicates; ++replicate) {
        seeds.push_back(sweep.seed_of(replicate).value);
    }
    for (const parameters::ParameterDescription* parameter : sweep.swept) {
        parameters.emplace_back(std::string{parameter->name});
    }
    for (const std::vector<parameters::ParameterValue>& values : sweep.cells) {
        boost::json::array& cell = cells.emplace_back(boost::json::array{}).as_array();
        for (const parameters::ParameterValue& value : values) {
            cell.emplace_back(parameters::to_text(value));
        }
    }
    return {{"evod", experiments::version_and_build()},
            {"model", simulation::model_version},
            {"seed", sweep.seed.value},
            {"seeds", std::move(seeds)},
            {"parameters", std::move(parameters)},
            {"cells", std::move(cells)}};
}

boost::json::object run_object(const Sweep& sweep, std::size_t run) {
    const std::size_t replicate = run % sweep.replicates;
    return {{"run", run},
            {"cell", run / sweep.replicates},
            {"replicate", replicate},
            {"seed", sweep.seed_of(static_cast<std::uint32_t>(replicate)).value}};
}

/// Writes runs.csv. Prints its number of rows, and how many runs ended by which criterion.
Result<void> gather(const SweepFolder& folder, bool json) {
    const auto gathered = folder.gather();
    if (!gathered) {
        return gathered.error();
    }
    if (json) {
        boost::json::object outcomes;
        for (const auto& [outcome, runs] : gathered->runs) {
            outcomes[experiments::name_of(outcome)] = runs;
        }
        print_json({{"table", folder.table()},
                    {"rows", gathered->rows},
                    {"outcomes", std::move(outcomes)},
                    {"missing", boost::json::array{}}});
        return {};
    }
    std::string ends;
    for (const auto& [outcome, runs] : gathered->runs) {
        ends += (ends.empty() ? "" : ", ") + std::string{experiments::name_of(outcome)} + " " + std::to_string(runs);
    }
    std::printf("%s: %llu rows; runs by outcome: %s\n", folder.table().c_str(),
                static_cast<unsigned long long>(gathered->rows), ends.c_str());
    return {};
}

std::vector<std::size_t> missing_runs(const std::vector<std::size_t>& runs, const SweepFolder& folder,
                                      SweepFolder::Wanted wanted) {
    std::vector<std::size_t> missing;
    std::ranges::copy_if(runs, std::back_inserter(missing),
                         [&](std::size_t run) { return !folder.end_of(run, wanted); });
    return missing;
}

Refusal missing_runs_refusal(const std::vector<std::size_t>& missing, const Sweep& sweep, const SweepFolder& folder) {
    constexpr std::size_t printed_max = 20;
    std::string names;
    for (std::size_t i = 0; i < std::min(missing.size(), printed_max); ++i) {
        names += (i == 0 ? "" : ", ") + folder.name_of(missing[i]);
    }
    return refusal(base::RefusalCode::FailedPrecondition,
                   std::to_string(missing.size()) + " of " + counted(sweep.run_count(), "run") +
                       " are missing: " + names + (missing.size() > printed_max ? ", …" : ""));
}

/// Prints the missing runs for programs, with the files that they have to write.
void print_missing_runs(const std::vector<std::size_t>& missing, const Sweep& sweep, const SweepFolder& folder) {
    boost::json::array runs;
    for (const std::size_t run : missing) {
        boost::json::object object = run_object(sweep, run);
        object["part"] = folder.part_of(run);
        runs.push_back(std::move(object));
    }
    print_json({{"missing", std::move(runs)}});
}

/// The results of all processes together.
struct Executed {
    std::size_t runs = 0; // finished
    double busy_s = 0;    // processor time
};

/// Adds up the results of all processes. Returns the same in all of them; after an error in any process, a refusal.
Result<Executed> add_up(const Result<std::size_t>& executed, double busy_s, runtime::Processes& processes) {
    if (auto agreed = agree(executed ? Result<std::string>{""} : executed.error(), processes); !agreed) {
        return agreed.error();
    }
    Executed sum;
    for (const std::string& part : processes.gather(base::pack(Executed{.runs = *executed, .busy_s = busy_s}))) {
        const auto there = base::unpack<Executed>(part);
        sum.runs += there.runs;
        sum.busy_s += there.busy_s;
    }
    return sum;
}

/// Executes the runs and prints their duration. Each process executes some of them. Returns the number of finished
/// runs.
Result<std::size_t> execute_runs(const std::vector<std::size_t>& runs, const Sweep& sweep, const SweepFolder& folder,
                                 const SweepOptions& options, runtime::Processes& processes) {
    const std::size_t jobs =
        options.jobs.value_or(std::max<std::size_t>(default_thread_count() / processes.on_this_machine(), 1));
    std::optional<Progress> progress;
    experiments::SweepRunner runner{sweep,
                                    folder,
                                    {.jobs = jobs,
                                     .rank = processes.rank(),
                                     .processes = processes.size(),
                                     .run_files = options.run_files,
                                     .draw_run_id = runtime::draw_run_id,
                                     .stopped = interrupted,
                                     .on_generation = [&](double work) { progress->generation_done(work); },
                                     .on_run = [&](double work) { progress->run_done(work); }}};
    const std::vector<std::size_t> share = runner.share_of(runs);
    progress.emplace(share.size(), runner.work_of(share), options.json);
    const std::clock_t cpu = std::clock();
    const auto executed = runner.execute(share);
    const auto all = add_up(executed, static_cast<double>(std::clock() - cpu) / CLOCKS_PER_SEC, processes);
    progress->clear();
    if (!all) {
        return all.error();
    }
    if (processes.rank() == 0 && all->runs > 0 && !options.json) {
        const double seconds = progress->seconds();
        const std::size_t at_once = std::min(jobs * processes.size(), runs.size());
        std::printf("%s in %.2f s, %.3g per second; %zu at a time, each %.1f %% busy\n",
                    counted(all->runs, "run").c_str(), seconds, static_cast<double>(all->runs) / seconds, at_once,
                    100 * all->busy_s / (seconds * static_cast<double>(at_once)));
    }
    return all->runs;
}

Result<Sweep> load(const SweepOptions& options) {
    auto sweep = experiments::load_sweep(options.file);
    if (sweep && options.array_index && *options.array_index >= sweep->cells.size()) {
        return refusal(base::RefusalCode::InvalidArgument,
                       "--array-index: got " + std::to_string(*options.array_index) + ", allowed 0 to " +
                           std::to_string(sweep->cells.size() - 1));
    }
    if (sweep && options.run && *options.run >= sweep->run_count()) {
        return refusal(base::RefusalCode::InvalidArgument, "--run: got " + std::to_string(*options.run) +
                                                               ", allowed 0 to " +
                                                               std::to_string(sweep->run_count() - 1));
    }
    return sweep;
}

/// The numbers of all runs of the sweep, or of one cell.
std::vector<std::size_t> run_numbers(const Sweep& sweep, std::optional<std::size_t> cell) {
    std::vector<std::size_t> runs(cell ? sweep.replicates : sweep.run_count());
    std::iota(runs.begin(), runs.end(), cell.value_or(0) * sweep.replicates);
    return runs;
}

/// Returns what rank 0 passes, in all processes.
std::vector<std::size_t> of_rank_0(const std::vector<std::size_t>& runs, runtime::Processes& processes) {
    return base::unpack<std::vector<std::size_t>>(processes.gather(base::pack(runs)).front());
}

/// Prints which cells were left out, which cannot evolve, and which seeds R rounds. A warning names one cell.
void print_warnings(const Sweep& sweep) {
    constexpr std::size_t printed_max = 10;
    for (std::size_t i = 0; i < std::min(sweep.skipped.size(), printed_max); ++i) {
        warn("left out, because it is impossible: " + sweep.skipped[i]);
    }
    if (sweep.skipped.size() > printed_max) {
        warn(counted(sweep.skipped.size() - printed_max, "more cell") + " left out, because they are impossible");
    }
    std::map<std::string, std::vector<std::size_t>> cells; // by warning
    for (std::size_t cell = 0; cell < sweep.cells.size(); ++cell) {
        for (const std::string& warning : parameters::warnings_of(sweep.parameters_of(cell))) {
            cells[warning].push_back(cell);
        }
    }
    for (const auto& [warning, of] : cells) {
        const std::string more = of.size() > 1 ? " and " + counted(of.size() - 1, "more cell") : "";
        warn((of.size() == sweep.cells.size() ? "all cells" : "cell " + std::to_string(of[0]) + more) + ": " + warning);
    }
    for (std::uint32_t replicate = 0; replicate < sweep.replicates; ++replicate) {
        if (const auto warning = warning_about(sweep.seed_of(replicate))) {
            warn(*warning);
            break;
        }
    }
}

/// Executes the runs that are still missing. Returns the exit status.
Result<int> execute_missing_runs(const SweepOptions& options, const Sweep& sweep, const SweepFolder& folder,
                                 const std::string& out, runtime::Processes& processes) {
    if (options.run_files) {
        if (auto created = folder.create_run_file_folder(); !created) {
            return created.error();
        }
    }
    const std::vector<std::size_t> wanted = run_numbers(sweep, options.array_index);
    // While one process looks for missing runs, another may already finish some; so all use the list of rank 0.
    const std::vector<std::size_t> missing =
        of_rank_0(missing_runs(wanted, folder,
                               options.run_files ? SweepFolder::Wanted::RowsAndRunFile : SweepFolder::Wanted::Rows),
                  processes);
    if (processes.rank() == 0 && !options.json) {
        const std::string cell = options.array_index ? ", only cell " + std::to_string(*options.array_index) : "";
        const std::size_t found = wanted.size() - missing.size();
        std::printf("%s%s%s; into %s\n", plan_text(options, sweep).c_str(), cell.c_str(),
                    found > 0 ? (", " + std::to_string(found) + " finished before").c_str() : "", out.c_str());
        print_seeds(sweep);
        std::fflush(stdout);
    }

    catch_interrupts();
    if (missing.empty()) {
        return 0;
    }
    const auto executed = execute_runs(missing, sweep, folder, options, processes);
    if (!executed) {
        return executed.error();
    }
    if (*executed < missing.size()) {
        if (processes.rank() == 0 && !options.json) {
            std::printf("interrupted: %s left; the same command resumes the sweep\n",
                        counted(missing.size() - *executed, "run").c_str());
            std::fflush(stdout); // an mpirun that was interrupted kills its processes while they leave MPI
        }
        return exit_interrupted;
    }
    return 0;
}

/// Executes one run, and writes its rows into a file without a folder of the sweep. Returns the exit status.
Result<int> execute_one_run(const SweepOptions& options, const Sweep& sweep) {
    catch_interrupts();
    Progress progress{1, experiments::work_of_run(sweep.parameters_of(*options.run / sweep.replicates)), options.json};
    experiments::SweepRunnerOptions running;
    running.stopped = interrupted;
    running.on_generation = [&](double work) { progress.generation_done(work); };
    const auto ended = experiments::execute_run(sweep, *options.run, {.part = options.part}, running);
    progress.clear();
    if (!ended) {
        return ended.error();
    }
    if (!*ended) {
        return exit_interrupted;
    }
    boost::json::object object = run_object(sweep, *options.run);
    object["outcome"] = experiments::name_of((*ended)->outcome);
    object["rows"] = (*ended)->rows;
    if (options.json) {
        print_json(object);
    } else {
        std::printf("%s: %llu rows\n", options.part.c_str(), static_cast<unsigned long long>((*ended)->rows));
    }
    return 0;
}

/// Checks that all processes see the same folder: rank 0 creates a file, for which the others look.
Result<void> check_shared(const std::string& folder, runtime::Processes& processes) {
    if (processes.size() == 1) {
        return {};
    }
    const std::string file = folder + "/started-by-rank-0";
    std::error_code error;
    const bool created = processes.rank() > 0 || std::ofstream{file}.good();
    (void)any(!created, processes); // the others look after rank 0 has created the file
    const bool seen = created && std::filesystem::exists(file, error);
    const auto agreed = agree(seen ? Result<std::string>{folder}
                                   : refusal(base::RefusalCode::FailedPrecondition,
                                             folder + " is not the same folder as that of rank 0: name a folder of a "
                                                      "shared file system with --out"),
                              processes);
    if (processes.rank() == 0) {
        std::filesystem::remove(file, error);
    }
    return agreed;
}

/// Executes `evod sweep`. Returns the exit status.
Result<int> run_sweep(const SweepOptions& options, runtime::Processes& processes) {
    if (processes.size() > 1 && (options.dry_run || options.gather || options.array_index || options.run)) {
        return refusal(base::RefusalCode::InvalidArgument,
                       "--dry-run, --gather, --array-index and --run are for one process: start it without mpirun");
    }
    const auto sweep = load(options);
    if (auto agreed = agree(sweep ? Result<std::string>{plan_text(options, *sweep)} : sweep.error(), processes);
        !agreed) {
        return agreed.error();
    }
    if (processes.rank() == 0 && !options.run && !options.gather) {
        print_warnings(*sweep);
    }
    if (options.dry_run) {
        if (options.json) {
            print_json(plan_object(*sweep));
        } else {
            print_cells(options, *sweep);
        }
        return 0;
    }
    if (options.run) {
        return execute_one_run(options, *sweep);
    }
    const std::string out = options.out.empty() ? std::filesystem::path{options.file}.stem().string() : options.out;
    if (std::error_code error; options.gather && !std::filesystem::exists(out, error)) {
        return refusal(base::RefusalCode::NotFound, out + ": no such folder, so there are no results to gather");
    }
    // Only rank 0 extends the sweep in a folder; the others then find it extended.
    if (processes.size() > 1) {
        Result<std::string> opened{out};
        if (processes.rank() == 0) {
            if (const auto first = SweepFolder::open(out, *sweep, SweepFolder::Extension::Allowed); !first) {
                opened = first.error();
            }
        }
        if (auto agreed = agree(opened, processes); !agreed) {
            return agreed.error();
        }
    }
    const auto folder = SweepFolder::open(
        out, *sweep, options.array_index ? SweepFolder::Extension::Refused : SweepFolder::Extension::Allowed);
    if (auto agreed = agree(folder ? Result<std::string>{out} : folder.error(), processes); !agreed) {
        return agreed.error();
    }
    if (auto shared = check_shared(out, processes); !shared) {
        return shared.error();
    }
    if (options.gather) {
        const auto missing = missing_runs(run_numbers(*sweep, {}), *folder, SweepFolder::Wanted::Rows);
        if (!missing.empty() && options.json) {
            print_missing_runs(missing, *sweep, *folder);
            return 0;
        }
        if (!missing.empty()) {
            return missing_runs_refusal(missing, *sweep, *folder);
        }
    } else {
        const auto status = execute_missing_runs(options, *sweep, *folder, out, processes);
        if (!status || *status != 0) {
            return status;
        }
    }
    if (options.array_index && options.json) {
        print_json({{"cell", *options.array_index}});
        return 0;
    }
    if (options.array_index) {
        std::printf("cell %zu is done; after all cells, --gather writes %s\n", *options.array_index,
                    folder->table().c_str());
        return 0;
    }
    if (processes.rank() == 0) {
        if (auto gathered = gather(*folder, options.json); !gathered) {
            return gathered.error();
        }
    }
    return 0;
}

/// A process of a sweep waits for the others only at the end, when they may have much more work left.
constexpr std::chrono::hours others_patience{24 * 365};

} // namespace

void add_sweep_command(command_line::Command& app) {
    auto& command = app.add_command("sweep", "Run an experiment many times with different parameters and seeds")
                        .group("Experiments");
    auto& options = command.keep(SweepOptions{});
    command
        .add_option("sweep", &options.file,
                    "Sweep file (JSON): an experiment, and a grid, list or Latin hypercube of parameter values")
        .required();
    command.add_option(
        "--out", &options.out,
        "Folder for the results, in which the same command resumes an interrupted sweep; default: the name "
        "of the sweep file without its extension");
    const auto with_jobs =
        command
            .add_option(
                "--jobs", &options.jobs,
                "Number of simultaneous runs, each on one thread; default: the number of processors, divided by "
                "the number of processes that mpirun has started on this machine")
            .check(thread_count);
    const auto with_run_files =
        command.add_flag("--run-files", &options.run_files, "Also write a run file for each run, in FOLDER/run-files");
    const auto with_array_index =
        command
            .add_option("--array-index", &options.array_index,
                        "Run only the cell with this index, from 0, as one task of a job array; when all tasks have "
                        "ended, use --gather")
            .check(any_number);
    const auto with_gather =
        command
            .add_flag("--gather", &options.gather,
                      "Only write FOLDER/runs.csv from the finished runs, or list the runs that are missing")
            .excludes(with_jobs)
            .excludes(with_run_files)
            .excludes(with_array_index);
    const auto with_dry_run =
        command.add_flag("--dry-run", &options.dry_run, "Only print cells and seeds; run nothing and write no file")
            .excludes(with_gather)
            .excludes(with_jobs)
            .excludes(with_run_files)
            .excludes(with_array_index);
    const auto with_part =
        command.add_option("--part", &options.part, "File for the rows of --run, as in the folder parts of a sweep");
    const auto with_run =
        command
            .add_option("--run", &options.run,
                        "Run only the run with this index, from 0: cell × replicates + replicate; it needs no folder")
            .check(any_number)
            .needs(with_part)
            .excludes(with_gather)
            .excludes(with_jobs)
            .excludes(with_run_files)
            .excludes(with_array_index)
            .excludes(with_dry_run);
    with_part.needs(with_run);
    add_json_option(command, options.json);
    command.footer(
        "docs/CLUSTER.md describes sweep files and job arrays. Exit status: 0 all runs are done, 1 error or "
        "--gather found missing runs (with --json, 0: they are its result), 130 interrupted: the same command resumes "
        "the sweep.");
    command.action([&] {
        const auto processes = runtime::join_processes(others_patience);
        if (!processes) {
            return fail(processes.error());
        }
        const Result<int> status = run_sweep(options, **processes);
        return status ? *status : (*processes)->rank() == 0 ? fail(status.error()) : exit_error;
    });
}

} // namespace evod::commands
