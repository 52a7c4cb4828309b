// Sweep runner: makes the runs of a sweep and writes each into the sweep folder.
//
// Threads      `jobs` threads, each with a world of its own, take whole runs (trials.h). The callbacks are called on
//              those threads, several at once.
// Determinism  the files of a run depend on its number alone: not on `jobs`, and not on which runs exist already.
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

/// The work of one run or generation in organism-ticks, if no organism died.
double work_of_generation(const parameters::Parameters& parameters);
/// Of a run up to its generation_limit; nullopt without one, because other criteria end it at an unknown time.
std::optional<double> work_of_run(const parameters::Parameters& parameters);

struct SweepRunnerOptions {
    std::size_t jobs = 1; // >= 1
    bool run_files = false;
    std::function<simulation::RunId()> draw_run_id = {};            // for run files
    std::function<bool()> stopped = [] { return false; };           // polled every tick
    std::function<void(double work)> on_generation = [](double) {}; // with the work it was expected to be
    /// With the rest of the expected work, which a run that ended before its generation_limit did not need.
    std::function<void(double work)> on_run = [](double) {};
};

class SweepRunner {
  public:
    /// sweep, folder  outlive the runner.
    SweepRunner(const Sweep& sweep, const SweepFolder& folder, SweepRunnerOptions options)
        : sweep_{sweep}, folder_{folder}, options_{std::move(options)} {}

    /// Makes these runs, those with the most work first. Returns how many it made: fewer than `runs` after stopped()
    /// returned true. After the first error no further run begins; a run that is stopped leaves no files.
    base::Result<std::size_t> make(std::vector<std::size_t> runs);

    /// The work of all these runs; nullopt if it is unknown for any of them.
    std::optional<double> work_of(const std::vector<std::size_t>& runs) const;

  private:
    std::size_t cell_of(std::size_t run) const { return run / sweep_.replicates; }
    bool is_stopped() const { return failed_ || options_.stopped(); }
    void sort_by_work(std::vector<std::size_t>& runs) const;
    base::Result<bool> make(std::size_t run) const;

    const Sweep& sweep_;
    const SweepFolder& folder_;
    const SweepRunnerOptions options_;
    std::atomic<bool> failed_ = false;
};

} // namespace evod::experiments
