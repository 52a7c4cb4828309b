#include "server/experiments/sweep_runner.h"

#include "server/base/inline_executor.h"
#include "server/experiments/atomic_file.h"
#include "server/experiments/run_writer.h"
#include "server/experiments/trials.h"
#include "server/replay/columns.h"
#include "server/simulation/world.h"

#include <algorithm>
#include <sstream>
#include <utility>

namespace evod::experiments {
namespace {

using base::Refusal;
using base::Result;
using parameters::Parameters;

/// Writes the rows of the generation that has just ended, in the format of runs.csv.
void write_generation(replay::Table& table, const Sweep& sweep, std::size_t run, const simulation::World& world) {
    const std::size_t cell = run / sweep.replicates, replicate = run % sweep.replicates;
    static const std::vector<std::string> body_genes = replay::body_gene_names();
    for (const simulation::GenerationStatistics& statistics : world.history().back()) {
        table.number(cell).number(replicate).number(world.seed().value);
        for (const parameters::ParameterValue& value : sweep.cells[cell]) {
            table.text(parameters::to_text(value));
        }
        replay::write_row(table, statistics, body_genes);
    }
}

} // namespace

double work_of_generation(const Parameters& parameters) {
    return static_cast<double>(parameters.population_size) * parameters.island_count * parameters.generation_s /
           parameters.tick_s;
}

std::optional<double> work_of_run(const Parameters& parameters) {
    if (parameters.generation_limit == 0) {
        return std::nullopt;
    }
    return work_of_generation(parameters) * parameters.generation_limit;
}

std::optional<double> SweepRunner::work_of(const std::vector<std::size_t>& runs) const {
    double sum = 0;
    for (const std::size_t run : runs) {
        const auto work = work_of_run(sweep_.parameters_of(cell_of(run)));
        if (!work) {
            return std::nullopt;
        }
        sum += *work;
    }
    return sum;
}

/// Sorts the runs so that the longest begin first. Then all threads are busy until shortly before the end.
void SweepRunner::sort_by_work(std::vector<std::size_t>& runs) const {
    std::vector<double> work;
    for (std::size_t cell = 0; cell < sweep_.cells.size(); ++cell) {
        const Parameters parameters = sweep_.parameters_of(cell);
        work.push_back(work_of_run(parameters).value_or(work_of_generation(parameters)));
    }
    std::ranges::stable_sort(runs, std::ranges::greater{}, [&](std::size_t run) { return work[cell_of(run)]; });
}

std::vector<std::size_t> SweepRunner::share_of(std::vector<std::size_t> runs) const {
    sort_by_work(runs); // so that every process gets long and short runs
    std::vector<std::size_t> share;
    for (std::size_t i = options_.rank; i < runs.size(); i += options_.processes) {
        share.push_back(runs[i]);
    }
    return share;
}

Result<std::size_t> SweepRunner::execute(std::vector<std::size_t> runs) {
    sort_by_work(runs);
    std::atomic<std::size_t> finished = 0;
    std::mutex mutex; // guards first_error
    std::optional<Refusal> first_error;
    SweepRunnerOptions of_runs = options_;
    of_runs.stopped = [this] { return is_stopped(); };
    for_each_trial(
        runs.size(), options_.jobs,
        [&](std::size_t index) {
            const std::size_t run = runs[index];
            RunFiles files{.part = folder_.part_of(run)};
            if (options_.run_files) {
                files.run_file = folder_.run_file_of(run);
                files.name = folder_.name_of(run);
            }
            const auto done = execute_run(sweep_, run, files, of_runs);
            if (done) {
                finished += *done ? 1 : 0;
                return;
            }
            const std::scoped_lock lock{mutex};
            if (!first_error) {
                first_error = done.error();
            }
            failed_ = true;
        },
        [this] { return is_stopped(); });
    if (first_error) {
        return *first_error;
    }
    return finished.load();
}

Result<std::optional<RunEnd>> execute_run(const Sweep& sweep, std::size_t run, const RunFiles& files,
                                          const SweepRunnerOptions& options) {
    const std::size_t cell = run / sweep.replicates, replicate = run % sweep.replicates;
    const Parameters parameters = sweep.parameters_of(cell);
    const auto expected = work_of_run(parameters);
    const double generation_work = expected ? work_of_generation(parameters) : 0;
    double done = 0;
    simulation::World world{
        parameters, sweep.seed_of(static_cast<std::uint32_t>(replicate)), {}, sweep.schedule_of(cell)};
    std::optional<RunWriter> writer;
    if (!files.run_file.empty()) {
        writer.emplace(files.run_file, files.name, options.draw_run_id(), world);
        if (auto followed = writer->follow(world); !followed) {
            return followed.error();
        }
    }
    AtomicFile part{files.part};
    std::ostringstream rows;
    replay::Table table{rows, replay::Table::Format::Csv, sweep_columns(sweep)};
    rows.str({}); // removes the heading
    RunEnd end;
    base::InlineExecutor executor;
    while (world.outcome() == evolution::Outcome::Running && part.error().empty()) {
        do {
            if (options.stopped()) {
                return std::optional<RunEnd>{};
            }
            world.advance_tick(executor);
            if (writer) {
                if (auto followed = writer->follow(world); !followed) {
                    return followed.error();
                }
            }
        } while (!world.generation_over());
        world.take_events();
        const bool last = world.outcome() != evolution::Outcome::Running;
        if (last || world.history().back().front().generation % sweep.every == 0) {
            write_generation(table, sweep, run, world);
            end.rows += world.history().back().size();
        }
        part.write(rows.str());
        rows.str({});
        done += generation_work;
        options.on_generation(generation_work);
    }
    if (writer && part.error().empty()) {
        if (auto finished = writer->finish(); !finished) {
            return finished.error();
        }
    }
    end.outcome = world.outcome();
    part.write(to_text(end));
    if (auto finished = part.finish(); !finished) {
        return finished.error();
    }
    options.on_run(expected.value_or(0) - done);
    return std::optional{end};
}

} // namespace evod::experiments
