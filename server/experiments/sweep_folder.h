// Sweep folder: the results of a sweep.
//
//   sweep.txt                          the identity of the sweep and of evod: the comment at the head of runs.csv
//   parts/cell-C-replicate-R.csv       the rows of a finished run, and its outcome
//   run-files/cell-C-replicate-R.evod  its run file, with --run-files
//   runs.csv                           all rows, in order of runs
//
// Every file is atomic (atomic_file.h). A run is finished when its part exists, so a process that starts after a crash,
// or beside others, makes the runs that are missing. Several processes on several machines may use a folder at a time.
// If two of them make the same run, both write the same rows.
//
// Threads  parts may be written on several threads; the rest on one.
#pragma once

#include "server/evolution/termination.h"
#include "server/experiments/sweep_file.h"

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

namespace evod::experiments {

class AtomicFile;

/// How a run ended.
struct RunEnd {
    evolution::Outcome outcome = evolution::Outcome::GenerationLimit;
    std::uint64_t rows = 0;
};
/// The last line of a part.
std::string to_text(const RunEnd& end);
/// "generation_limit", "target_fitness", "stagnation_limit" or "extinction": the criterion that ended the run.
std::string_view name_of(evolution::Outcome outcome);

class SweepFolder {
  public:
    /// Makes the folder, or opens it to resume the sweep. Refused if it contains the results of another sweep, or of
    /// another build of evod.
    ///
    /// sweep  outlives it.
    static base::Result<SweepFolder> open(const std::string& path, const Sweep& sweep);

    /// "cell-07-replicate-2": the name of a run and of its world.
    std::string name_of(std::size_t run) const;
    std::string part_of(std::size_t run) const { return path_ + "/parts/" + name_of(run) + ".csv"; }
    std::string run_file_of(std::size_t run) const { return path_ + "/run-files/" + name_of(run) + ".evod"; }
    std::string table() const { return path_ + "/runs.csv"; }
    /// Makes the folder of run files, if it does not exist.
    base::Result<void> make_run_file_folder() const;

    enum class Wanted { Rows, RowsAndRunFile };
    /// How a run ended; nullopt if a file that is wanted is missing or incomplete.
    std::optional<RunEnd> end_of(std::size_t run, Wanted wanted) const;

    struct Gathered {
        std::uint64_t rows = 0;
        std::map<evolution::Outcome, std::size_t> runs; // number by outcome
    };
    /// Writes runs.csv. Refused if a part is missing or was changed.
    base::Result<Gathered> gather() const;

  private:
    SweepFolder(std::string path, const Sweep& sweep) : path_{std::move(path)}, sweep_{&sweep} {}
    base::Result<void> add_part(std::size_t run, AtomicFile& table, Gathered& gathered) const;
    void remove_temporary_files() const;

    std::string path_;
    const Sweep* sweep_;
};

/// The columns of runs.csv: cell, replicate, seed, the swept parameters, statistics.
std::vector<std::string> sweep_columns(const Sweep& sweep);

} // namespace evod::experiments
