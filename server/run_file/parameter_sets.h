// Parameter sets: the table `parameters` of a run file, to which generations and checkpoints refer by number.
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
    /// Writes the set unless it equals the one that was written last.
    ///
    /// returns  its number.
    std::int64_t number_of(const parameters::ParameterSet& set);

  private:
    struct Numbered {
        std::int64_t number;
        parameters::ParameterSet set;
    };
    RunDatabase& database_;
    std::optional<Numbered> written_, read_; // the last ones; most generations have the set of the one before
};

} // namespace evod::run_file
