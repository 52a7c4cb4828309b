// Sweep files: many runs of one experiment with other parameters, as JSON. What may stand in one: docs/CLUSTER.md.
//
// A cell is one set of values; a run is one replicate of a cell. Cells, replicates and runs are numbered from 0, and a
// run's number is cell × replicates + replicate.
//
// Determinism  cells follow from the text and the experiment alone, be they drawn or not.
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

    std::string text;                  // of the file
    parameters::Parameters parameters; // of the experiment
    parameters::Schedule schedule;     // of the experiment, but for what is swept
    base::Seed seed{1};
    std::uint32_t replicates = 1;
    std::vector<const parameters::ParameterDescription*> swept; // in the order in which the file names them
    std::vector<std::vector<parameters::ParameterValue>> cells; // shape (cells, swept)

    std::size_t run_count() const { return cells.size() * replicates; }
    /// Valid, and with a criterion that ends the run.
    parameters::Parameters parameters_of(std::size_t cell) const;
    /// In which faults_of() finds nothing.
    parameters::Schedule schedule_of(std::size_t cell) const;
};

using LoadExperiment = std::function<base::Result<parameters::Experiment>(const std::string& path)>;

/// Reads the text of a sweep file. Violations name the field with its line, "grid.mutation_chance[2] (line 4)", and of
/// values that do not go together the cell; no more than violations_max are told.
///
/// load  called for an experiment that is given by its path.
base::Result<Sweep> parse_sweep(std::string_view text, const LoadExperiment& load);
constexpr std::size_t violations_max = 100;

/// Reads a file, and the experiment that it names, whose path begins where the file is; the refusal's message begins
/// with the path.
base::Result<Sweep> load_sweep(const std::string& path);

} // namespace evod::experiments
