// Parameter sets: the table `parameters` of a run file. Generations and checkpoints refer to its rows by number.
//
// Owner        a RunFile.
#pragma once

#include "server/run_file/records.h"
#include "server/run_file/run_database.h"

#include <optional>

namespace evod::run_file {

class ParameterSets {
  public:
    explicit ParameterSets(RunDatabase& database) : database_{database} {}

    base::Result<parameters::ParameterSet> read(std::int64_t number);
    /// Writes the set, unless it equals the set that was written last.
    ///
    /// returns  the number of the set in the table.
    std::int64_t number_of(const parameters::ParameterSet& set);
    /// Replaces the limit in all sets of the file.
    base::Result<void> set_generation_limit(std::uint32_t limit);

  private:
    void write(std::int64_t number, const parameters::ParameterSet& set);

    struct Numbered {
        std::int64_t number;
        parameters::ParameterSet set;
    };
    RunDatabase& database_;
    // The last set written and the last set read; consecutive generations mostly have the same set.
    std::optional<Numbered> written_, read_;
};

} // namespace evod::run_file
