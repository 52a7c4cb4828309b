#include "server/commands/sweep.h"

#include "proto/command_line/command.h"
#include "server/base/inline_executor.h"
#include "server/commands/common_options.h"
#include "server/commands/interrupt.h"
#include "server/commands/progress_line.h"
#include "server/experiments/new_file.h"
#include "server/experiments/run_writer.h"
#include "server/experiments/sweep_file.h"
#include "server/experiments/sweep_folder.h"
#include "server/experiments/trials.h"
#include "server/replay/columns.h"
#include "server/simulation/world.h"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cstdio>
#include <ctime>
#include <filesystem>
#include <iostream>
#include <iterator>
#include <mutex>
#include <numeric>
#include <sstream>
#include <utility>

namespace evod::commands {
namespace {

using namespace experiments;

using base::Refusal;
using base::Result;
using parameters::Parameters;
using Clock = std::chrono::steady_clock;

/// What a generation of a run costs, in organism-ticks, were nobody to die.
double work_of_generation(const Parameters& parameters) {
    return static_cast<double>(parameters.population_size) * parameters.island_count * parameters.generation_s /
           parameters.tick_s;
}

/// The same of a run, if it goes on to its generation_limit; nothing if it has none.
std::optional<double> work_of(const Parameters& parameters) {
    if (parameters.generation_limit == 0) {
        return std::nullopt;
    }
    return work_of_generation(parameters) * parameters.generation_limit;
}

/// How far the runs are. Called by all threads.
class Progress {
  public:
    /// work  that there is to do; nothing: nobody knows how long runs last, and runs are counted.
    Progress(std::size_t runs, std::optional<double> work) : runs_{runs}, work_{work} {}

    void generation_done(double work) {
        const std::unique_lock lock{mutex_};
        done_ += work;
        show();
    }
    /// unspent  what was expected of it, and did not come.
    void run_done(double unspent) {
        const std::unique_lock lock{mutex_};
        ++runs_done_;
        done_ += unspent;
        show();
    }
    std::size_t runs_done() {
        const std::unique_lock lock{mutex_};
        return runs_done_;
    }
    void clear() const { line_.clear(); }
    double seconds() const { return std::chrono::duration<double>(Clock::now() - start_).count(); }

  private:
    void show() {
        line_.show([&] {
            const double s = seconds();
            const double share = work_ ? done_ / *work_ : static_cast<double>(runs_done_) / static_cast<double>(runs_);
            const double rate = static_cast<double>(runs_done_) / s;
            char text[96];
            std::snprintf(text, sizeof text, "%zu of %zu runs, %.3g runs/%s", runs_done_, runs_,
                          rate < 1 ? 60 * rate : rate, rate < 1 ? "min" : "s");
            // Before, it is a guess.
            return std::string{text} + (s > 2 && share > 0 ? ", " + time_left(share, s) : "");
        });
    }

    const Clock::time_point start_ = Clock::now();
    const std::size_t runs_;
    const std::optional<double> work_;
    std::mutex mutex_; // guards what follows
    std::size_t runs_done_ = 0;
    double done_ = 0;
    ProgressLine line_;
};

class Runs {
  public:
    Runs(const Sweep& sweep, const SweepFolder& folder, const SweepOptions& options)
        : sweep_{sweep}, folder_{folder}, options_{options} {}

    /// Makes these runs; returns how many there are now, or what went wrong.
    Result<std::size_t> make(std::vector<std::size_t> runs) {
        put_long_ones_first(runs);
        std::optional<double> all = 0.0;
        for (const std::size_t run : runs) {
            if (const auto work = work_of(sweep_.parameters_of(cell_of(run))); work && all) {
                *all += *work;
            } else {
                all.reset();
            }
        }
        Progress progress{runs.size(), all};
        const std::clock_t cpu = std::clock();
        for_each_trial(
            runs.size(), options_.jobs,
            [&](std::size_t index) {
                if (auto made = make(runs[index], progress); !made) {
                    note(made.error());
                }
            },
            [this] { return stopped(); });
        progress.clear();
        if (failed_) {
            return *trouble_;
        }
        const double seconds = progress.seconds(), busy_s = static_cast<double>(std::clock() - cpu) / CLOCKS_PER_SEC;
        const std::size_t jobs = std::min(options_.jobs, runs.size());
        if (const std::size_t made = progress.runs_done(); made > 0) {
            std::printf("%zu %s in %.2f s, %.3g a second; %zu at a time, each %.1f %% busy\n", made,
                        made == 1 ? "run" : "runs", seconds, static_cast<double>(made) / seconds, jobs,
                        100 * busy_s / (seconds * static_cast<double>(jobs)));
        }
        return progress.runs_done();
    }

  private:
    std::size_t cell_of(std::size_t run) const { return run / sweep_.replicates; }
    bool stopped() const { return interrupted() || failed_; }
    void note(const Refusal& trouble) {
        const std::unique_lock lock{mutex_};
        if (!trouble_) {
            trouble_ = trouble;
        }
        failed_ = true;
    }

    /// So that the last ones are short, and no thread waits long for the others.
    void put_long_ones_first(std::vector<std::size_t>& runs) const {
        std::vector<double> work;
        for (std::size_t cell = 0; cell < sweep_.cells.size(); ++cell) {
            const Parameters parameters = sweep_.parameters_of(cell);
            work.push_back(work_of(parameters).value_or(work_of_generation(parameters)));
        }
        std::ranges::stable_sort(runs, std::ranges::greater{}, [&](std::size_t run) { return work[cell_of(run)]; });
    }

    /// One run from beginning to end; if it is stopped, nothing of it is left.
    Result<void> make(std::size_t run, Progress& progress) {
        const std::size_t cell = cell_of(run), replicate = run % sweep_.replicates;
        const Parameters parameters = sweep_.parameters_of(cell);
        const double work = work_of_generation(parameters);
        const auto expected = work_of(parameters);
        double spent = 0;
        simulation::World world{parameters,
                                replicate_seed(sweep_.seed, static_cast<std::uint32_t>(replicate)),
                                {},
                                sweep_.schedule_of(cell)};
        std::optional<RunWriter> record;
        if (options_.run_files) {
            record.emplace(folder_.run_file_of(run), folder_.name_of(run), options_.draw_run_id(), world);
            if (auto followed = record->follow(world); !followed) {
                return followed;
            }
        }
        NewFile part{folder_.part_of(run)};
        std::ostringstream rows;
        replay::Table table{rows, replay::Table::Format::Csv, sweep_columns(sweep_)};
        rows.str({}); // without the heading
        RunEnd end;
        base::InlineExecutor executor;
        while (world.outcome() == evolution::Outcome::Running && part.trouble().empty()) {
            do {
                if (stopped()) {
                    return {};
                }
                world.advance_tick(executor);
                if (record) {
                    if (auto followed = record->follow(world); !followed) {
                        return followed;
                    }
                }
            } while (!world.generation_over());
            world.take_events();
            for (const simulation::GenerationStatistics& statistics : world.history().back()) {
                table.number(cell).number(replicate).number(world.seed().value);
                for (const parameters::ParameterValue& value : sweep_.cells[cell]) {
                    table.text(parameters::to_text(value));
                }
                replay::write_row(table, statistics);
                ++end.rows;
            }
            part.write(rows.str());
            rows.str({});
            spent += expected ? work : 0;
            progress.generation_done(expected ? work : 0);
        }
        if (record && part.trouble().empty()) {
            if (auto finished = record->finish(); !finished) {
                return finished;
            }
        }
        end.outcome = world.outcome();
        part.write(to_text(end));
        if (auto finished = part.finish(); !finished) {
            return finished;
        }
        progress.run_done(expected.value_or(0) - spent);
        return {};
    }

    const Sweep& sweep_;
    const SweepFolder& folder_;
    const SweepOptions& options_;
    std::atomic<bool> failed_ = false;
    std::mutex mutex_; // guards what follows
    std::optional<Refusal> trouble_;
};

std::string counted(std::size_t count, const std::string& what) {
    return std::to_string(count) + " " + what + (count == 1 ? "" : "s");
}

std::string plan_text(const SweepOptions& options, const Sweep& sweep) {
    return options.file + ": " + counted(sweep.cells.size(), "cell") + " of " + counted(sweep.replicates, "replicate") +
           ", " + counted(sweep.run_count(), "run") + ", seed " + std::to_string(sweep.seed.value);
}

std::string seed_text(const Sweep& sweep, std::uint32_t replicate) {
    return std::to_string(replicate_seed(sweep.seed, replicate).value);
}

/// Which runs there would be, as rows with tabs between.
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
    constexpr std::uint32_t told_max = 10;
    std::string text = "seeds of the replicates:";
    for (std::uint32_t replicate = 0; replicate < std::min(sweep.replicates, told_max); ++replicate) {
        text += " " + seed_text(sweep, replicate);
    }
    std::puts((text + (sweep.replicates > told_max ? " …; all of them with --dry-run" : "")).c_str());
}

/// Writes runs.csv and says what is in it.
Result<void> gather(const SweepFolder& folder) {
    const auto gathered = folder.gather();
    if (!gathered) {
        return gathered.error();
    }
    std::string ends;
    for (const auto& [outcome, runs] : gathered->runs) {
        ends += (ends.empty() ? "" : ", ") + std::string{name_of(outcome)} + " " + std::to_string(runs);
    }
    std::printf("%s: %llu rows; runs by what ended them: %s\n", folder.table().c_str(),
                static_cast<unsigned long long>(gathered->rows), ends.c_str());
    return {};
}

/// Those among `runs` that are not there yet.
std::vector<std::size_t> missing_among(const std::vector<std::size_t>& runs, const SweepFolder& folder,
                                       SweepFolder::Wanted wanted) {
    std::vector<std::size_t> missing;
    std::ranges::copy_if(runs, std::back_inserter(missing),
                         [&](std::size_t run) { return !folder.end_of(run, wanted); });
    return missing;
}

Refusal not_all_there(const std::vector<std::size_t>& missing, const Sweep& sweep, const SweepFolder& folder) {
    constexpr std::size_t told_max = 20;
    std::string names;
    for (std::size_t i = 0; i < std::min(missing.size(), told_max); ++i) {
        names += (i == 0 ? "" : ", ") + folder.name_of(missing[i]);
    }
    return refusal(base::RefusalCode::FailedPrecondition,
                   std::to_string(missing.size()) + " of " + counted(sweep.run_count(), "run") +
                       " are not there yet: " + names + (missing.size() > told_max ? ", …" : ""));
}

Result<SweepStatus> done(const SweepOptions& options) {
    const auto sweep = load_sweep(options.file);
    if (!sweep) {
        return sweep.error();
    }
    if (options.array_index && *options.array_index >= sweep->cells.size()) {
        return refusal(base::RefusalCode::InvalidArgument,
                       "--array-index: got " + std::to_string(*options.array_index) + ", allowed 0 to " +
                           std::to_string(sweep->cells.size() - 1));
    }
    if (options.dry_run) {
        print_cells(options, *sweep);
        return SweepDone;
    }
    const std::string out = options.out.empty() ? std::filesystem::path{options.file}.stem().string() : options.out;
    if (std::error_code error; options.gather && !std::filesystem::exists(out, error)) {
        return refusal(base::RefusalCode::NotFound, out + ": there is no such folder, so nothing to gather");
    }
    const auto folder = SweepFolder::open(out, *sweep);
    if (!folder) {
        return folder.error();
    }

    std::vector<std::size_t> all(sweep->run_count());
    std::iota(all.begin(), all.end(), std::size_t{0});
    if (options.gather) {
        if (const auto missing = missing_among(all, *folder, SweepFolder::Wanted::Rows); !missing.empty()) {
            return not_all_there(missing, *sweep, *folder);
        }
        if (auto gathered = gather(*folder); !gathered) {
            return gathered.error();
        }
        return SweepDone;
    }

    std::vector<std::size_t> wanted = all;
    if (options.array_index) {
        wanted.resize(sweep->replicates);
        std::iota(wanted.begin(), wanted.end(), *options.array_index * sweep->replicates);
    }
    if (options.run_files) {
        if (auto made = folder->make_place_for_run_files(); !made) {
            return made.error();
        }
    }
    const std::vector<std::size_t> missing = missing_among(
        wanted, *folder, options.run_files ? SweepFolder::Wanted::RowsAndRunFile : SweepFolder::Wanted::Rows);
    std::printf("%s%s%s; into %s\n", plan_text(options, *sweep).c_str(),
                options.array_index ? (", cell " + std::to_string(*options.array_index) + " alone").c_str() : "",
                missing.size() < wanted.size()
                    ? (", " + std::to_string(wanted.size() - missing.size()) + " there already").c_str()
                    : "",
                out.c_str());
    print_seeds(*sweep);
    std::fflush(stdout);

    mind_interrupts();
    if (!missing.empty()) {
        const auto made = Runs{*sweep, *folder, options}.make(missing);
        if (!made) {
            return made.error();
        }
        if (*made < missing.size()) {
            std::printf("stopped: %s to go; the same command goes on with them\n",
                        counted(missing.size() - *made, "run").c_str());
            return SweepInterrupted;
        }
    }
    if (options.array_index) {
        std::printf("cell %zu is done; with --gather, once all are, %s is written\n", *options.array_index,
                    folder->table().c_str());
        return SweepDone;
    }
    if (auto gathered = gather(*folder); !gathered) {
        return gathered.error();
    }
    return SweepDone;
}

} // namespace

int sweep(const SweepOptions& options) {
    const Result<SweepStatus> status = done(options);
    if (status) {
        return *status;
    }
    std::cerr << "evod sweep: " << to_text(status.error()) << '\n';
    return SweepError;
}

void add_sweep_command(command_line::Command& app, std::size_t jobs, std::function<simulation::RunId()> draw_run_id) {
    auto& command = app.add_command("sweep", "Run an experiment many times, with other parameters and seeds");
    auto& options = command.keep(SweepOptions{});
    options.jobs = jobs;
    options.draw_run_id = std::move(draw_run_id);
    command
        .add_option("sweep", &options.file,
                    "JSON file: an experiment, and a grid, a list or a Latin hypercube of parameters")
        .required();
    command.add_option("--out", &options.out,
                       "Folder for the results, which the same command goes on with; otherwise called like the file, "
                       "without its ending");
    const auto with_jobs =
        command.add_option("--jobs", &options.jobs, "Runs at a time, each on one thread").range(1, 1024).show_default();
    const auto with_run_files =
        command.add_flag("--run-files", &options.run_files, "Make a run file of each run, too: FOLDER/run-files");
    const auto with_array_index = command
                                      .add_option("--array-index", &options.array_index,
                                                  "Make the runs of this cell alone, counted from 0: one task of a "
                                                  "job array; then, once: --gather")
                                      .check(any_number);
    const auto with_gather =
        command.add_flag("--gather", &options.gather, "Run nothing: write FOLDER/runs.csv, or say what is missing")
            .excludes(with_jobs)
            .excludes(with_run_files)
            .excludes(with_array_index);
    command.add_flag("--dry-run", &options.dry_run, "Write nothing: print cells and seeds")
        .excludes(with_gather)
        .excludes(with_jobs)
        .excludes(with_run_files)
        .excludes(with_array_index);
    command.footer("Sweep files and job arrays: docs/CLUSTER.md. Exit status: 0 all is there, 1 error, or --gather "
                   "found runs missing, 130 interrupted: the same command goes on.");
    command.action([&] { return sweep(options); });
}

} // namespace evod::commands
