// Bundle: a folder with everything about a run that another person needs to check and repeat it.
//
//   NAME.evod        a copy of the run file, consistent even if a server writes to it
//   experiment.json  the initial parameters and the seed of the run
//   population.csv   the initial organisms, if they were given
//   generations.csv, organisms.csv, lineage.csv, events.csv
//   REPEAT.md        how to repeat the run, and which evod can
//   SHA256SUMS       checksums of all files, for `sha256sum --check`
#pragma once

#include "server/replay/run_tables.h"

#include <string>

namespace evod::experiments {

/// folder  is made; refused if it exists. After another refusal it does not exist.
base::Result<void> write_bundle(const replay::RunSource& run, const std::string& folder);

} // namespace evod::experiments
