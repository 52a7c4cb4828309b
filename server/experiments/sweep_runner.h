// Sweep runner: executes the runs of a sweep and writes the results into the sweep folder.
//
// Threads      `jobs` threads. Each run is executed by one thread, with its own world (trials.h). Several threads may
//              call a callback at the same time.
// Determinism  the files of a run depend only on its number, not on `jobs` and not on the runs that already exist.
#pragma once

#include "server/experiments/sweep_folder.h"
#include "server/simulation/commands.h"

#include <atomic>
#include <cstddef>
#include <functional>
#include <mutex>
#include <optional>
#include <vector>

namespace evod::experiments {

/// The work of one generation in organism-ticks, if no organism dies early.
double work_of_generation(const parameters::Parameters& parameters);
/// The work of a run up to its generation_limit; nullopt without a generation_limit, because other criteria end the run
/// at an unknown time.
std::optional<double> work_of_run(const parameters::Parameters& parameters);

struct SweepRunnerOptions {
    std::size_t jobs = 1;                                 // >= 1
    std::uint32_t rank = 0, processes = 1;                // several processes that execute a sweep together
    bool run_files = false;                               // used by SweepRunner::execute()
    std::function<simulation::RunId()> draw_run_id = {};  // for run files
    std::function<bool()> stopped = [] { return false; }; // whether to stop; called in every tick
    /// The runner calls this function at the end of each generation, with the expected work of the generation.
    std::function<void(double work)> on_generation = [](double) {};
    /// The runner calls this function at the end of a run. `work` is the expected work that was saved because the run
    /// ended before its generation_limit.
    std::function<void(double work)> on_run = [](double) {};
};

/// The files of a run.
struct RunFiles {
    std::string part;
    std::string run_file = {}, name = {}; // empty: no run file is written
};
/// Executes one run from beginning to end on this thread. Returns nullopt if options.stopped() returned true; then
/// there are no files.
base::Result<std::optional<RunEnd>> execute_run(const Sweep& sweep, std::size_t run, const RunFiles& files,
                                                const SweepRunnerOptions& options);

class SweepRunner {
  public:
    /// sweep, folder  must outlive the runner.
    SweepRunner(const Sweep& sweep, const SweepFolder& folder, SweepRunnerOptions options)
        : sweep_{sweep}, folder_{folder}, options_{std::move(options)} {}

    /// Returns the runs that this process executes. All processes of the sweep must pass the same runs.
    std::vector<std::size_t> share_of(std::vector<std::size_t> runs) const;

    /// Executes these runs; the runs with the most work begin first. Returns the number of finished runs, which is
    /// less than runs.size() if stopped() returned true. After the first error, no further run begins. A stopped run
    /// leaves no files.
    base::Result<std::size_t> execute(std::vector<std::size_t> runs);

    /// The total work of these runs; nullopt if the work of any run is unknown.
    std::optional<double> work_of(const std::vector<std::size_t>& runs) const;

  private:
    std::size_t cell_of(std::size_t run) const { return run / sweep_.replicates; }
    bool is_stopped() const { return failed_ || options_.stopped(); }
    void sort_by_work(std::vector<std::size_t>& runs) const;

    const Sweep& sweep_;
    const SweepFolder& folder_;
    const SweepRunnerOptions options_;
    std::atomic<bool> failed_ = false;
};

} // namespace evod::experiments
