// Sweep folder: the folder with the results of a sweep.
//
//   sweep.txt                          identifies the sweep and the build of evod; also the first comment of runs.csv
//   parts/cell-C-replicate-R.csv       the rows of a finished run, and its outcome
//   run-files/cell-C-replicate-R.evod  the run file of a finished run, with --run-files
//   runs.csv                           all rows, in order of runs
//
// Every file is atomic (atomic_file.h). A run is finished if its part exists. So a process that starts after a crash,
// or while other processes run, executes only the missing runs. Several processes on several machines may use a folder
// at the same time. If two of them execute the same run, both write the same rows.
//
// Threads  parts may be written by several threads; all other functions are called by one thread.
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

/// The version and the build of evod, as sweep.txt contains them.
std::string version_and_build();

/// How a run ended.
struct RunEnd {
    evolution::Outcome outcome = evolution::Outcome::GenerationLimit;
    std::uint64_t rows = 0;
};
/// Formats the end of a run as the last line of its part.
std::string to_text(const RunEnd& end);
/// The criterion that ended the run: "generation_limit", "target_fitness", "stagnation_limit" or "extinction".
std::string_view name_of(evolution::Outcome outcome);

class SweepFolder {
  public:
    /// Whether a sweep may continue the finished runs of a smaller one: the same experiment and seeds, whose cells and
    /// replicates are the first ones of the larger sweep.
    enum class Extension {
        Allowed, // only for one process at a time, because finished parts may be renamed
        Refused,
    };
    /// Creates the folder, or opens it to resume or extend the sweep. Refused if it contains results of another sweep,
    /// or of another build of evod.
    ///
    /// sweep  must outlive the SweepFolder.
    static base::Result<SweepFolder> open(const std::string& path, const Sweep& sweep,
                                          Extension extension = Extension::Allowed);

    /// The name of a run and of its world: "cell-07-replicate-2".
    std::string name_of(std::size_t run) const;
    std::string part_of(std::size_t run) const { return path_ + "/parts/" + name_of(run) + ".csv"; }
    std::string run_file_of(std::size_t run) const { return path_ + "/run-files/" + name_of(run) + ".evod"; }
    std::string table() const { return path_ + "/runs.csv"; }
    /// Creates the folder for run files, if it does not exist.
    base::Result<void> create_run_file_folder() const;

    enum class Wanted { Rows, RowsAndRunFile };
    /// How a run ended; nullopt if one of the requested files is missing or incomplete.
    std::optional<RunEnd> end_of(std::size_t run, Wanted wanted) const;

    struct Gathered {
        std::uint64_t rows = 0;
        std::map<evolution::Outcome, std::size_t> runs; // number of runs by outcome
    };
    /// Writes runs.csv. Refused if a part is missing or has been changed.
    base::Result<Gathered> gather() const;

  private:
    SweepFolder(std::string path, const Sweep& sweep) : path_{std::move(path)}, sweep_{&sweep} {}
    base::Result<void> add_part(std::size_t run, AtomicFile& table, Gathered& gathered) const;
    void remove_temporary_files() const;
    base::Result<void> extend(const Sweep& smaller) const;

    std::string path_;
    const Sweep* sweep_;
};

/// The columns of runs.csv: cell, replicate, seed, the swept parameters, and the statistics.
std::vector<std::string> sweep_columns(const Sweep& sweep);

} // namespace evod::experiments
