// Sweep files: JSON files that describe many runs of one experiment with different parameters. docs/CLUSTER.md
// documents the format.
//
// A cell is one set of values. A run is one replicate of a cell. Cells, replicates and runs are numbered from 0. The
// number of a run is cell × replicates + replicate.
//
// Threads      none.
// Determinism  the cells depend only on the text and the experiment, even if they are drawn at random.
#pragma once

#include "server/base/random.h"
#include "server/base/result.h"
#include "server/parameters/experiment.h"

#include <cstdint>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

namespace evod::experiments {

struct Sweep {
    static constexpr std::size_t runs_max = 100'000;

    std::string text;                  // text of the file
    parameters::Parameters parameters; // parameters of the experiment
    parameters::Schedule schedule;     // schedule of the experiment, without the swept parameters
    base::Seed seed{1};
    std::uint32_t replicates = 1;
    std::vector<base::Seed> seeds;    // the seed of each replicate; empty: derived from `seed`
    std::uint32_t every = 1;          // the table contains every n-th generation of a run, and its last one
    std::vector<std::string> skipped; // why cells were left out; only if the file has "skip_invalid": true
    std::vector<const parameters::ParameterDescription*> swept; // in the order in which the file names them
    std::vector<std::vector<parameters::ParameterValue>> cells; // shape (cells, swept)

    std::size_t run_count() const { return cells.size() * replicates; }
    base::Seed seed_of(std::uint32_t replicate) const;
    /// The parameters of a cell. They are valid and contain a criterion that ends the run.
    parameters::Parameters parameters_of(std::size_t cell) const;
    /// Returns the schedule of a cell. parse_sweep() has checked that it is valid.
    parameters::Schedule schedule_of(std::size_t cell) const;
};

using LoadExperiment = std::function<base::Result<parameters::Experiment>(const std::string& path)>;

/// Parses the text of a sweep file. Violations name the field with its line, "grid.mutation_chance[2] (line 4)", or the
/// cell whose values contradict each other. Reports at most violations_max violations.
///
/// load  loads the experiment if the file names it by its path.
base::Result<Sweep> parse_sweep(std::string_view text, const LoadExperiment& load);
constexpr std::size_t violations_max = 100;

/// Reads a sweep file and its experiment. The path of the experiment is relative to the folder of the sweep file. The
/// message of a refusal begins with the path of the file.
base::Result<Sweep> load_sweep(const std::string& path);

} // namespace evod::experiments
