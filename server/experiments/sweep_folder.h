// Sweep folder: where the results of a sweep lie, finished and unfinished.
//
//   sweep.txt                          which sweep it is, of which evod: the comment at the head of runs.csv
//   parts/cell-C-replicate-R.csv       the rows of a run that is over, and how it ended
//   run-files/cell-C-replicate-R.evod  its run file, if they were asked for
//   runs.csv                           all rows, in order of runs
//
// Every file is there whole or not at all, and a run is over when its part is there: whoever comes after a kill, or
// beside others, does what is missing. Several processes, on several machines, may use a folder at a time; at worst two
// make the same run, which has the same rows.
#pragma once

#include "server/evolution/termination.h"
#include "server/experiments/sweep_file.h"

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

namespace evod::experiments {

class NewFile;

/// A run that is over.
struct RunEnd {
    evolution::Outcome outcome = evolution::Outcome::GenerationLimit;
    std::uint64_t rows = 0;
};
/// The line that ends a part.
std::string to_text(const RunEnd& end);
/// "generation_limit", as the parameter is called that ended it; "target_fitness", "stagnation_limit", "extinction".
std::string_view name_of(evolution::Outcome outcome);

class SweepFolder {
  public:
    /// Makes the folder, or goes on with one; refused where it holds another sweep, or the same of another evod.
    ///
    /// sweep  outlives it.
    static base::Result<SweepFolder> open(const std::string& path, const Sweep& sweep);

    /// "cell-07-replicate-2": of a run, and of its world.
    std::string name_of(std::size_t run) const;
    std::string part_of(std::size_t run) const { return path_ + "/parts/" + name_of(run) + ".csv"; }
    std::string run_file_of(std::size_t run) const { return path_ + "/run-files/" + name_of(run) + ".evod"; }
    std::string table() const { return path_ + "/runs.csv"; }
    /// The folder of run files is there from now on.
    base::Result<void> make_place_for_run_files() const;

    enum class Wanted { Rows, RowsAndRunFile };
    /// How a run ended, if what is wanted of it is there.
    std::optional<RunEnd> end_of(std::size_t run, Wanted wanted) const;

    struct Gathered {
        std::uint64_t rows = 0;
        std::map<evolution::Outcome, std::size_t> runs; // by how they ended
    };
    /// Writes runs.csv from the parts, all of which are there.
    base::Result<Gathered> gather() const;

  private:
    SweepFolder(std::string path, const Sweep& sweep) : path_{std::move(path)}, sweep_{&sweep} {}
    base::Result<void> add_part(std::size_t run, NewFile& table, Gathered& gathered) const;
    void tidy() const;

    std::string path_;
    const Sweep* sweep_;
};

/// The columns of runs.csv: cell, replicate, seed, what is swept, statistics.
std::vector<std::string> sweep_columns(const Sweep& sweep);

} // namespace evod::experiments
