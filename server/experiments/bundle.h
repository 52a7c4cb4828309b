// Bundle: a folder with everything that another person needs to check and repeat a run.
//
//   NAME.evod        a copy of the run file, consistent even if a server writes to the original
//   experiment.json  the initial parameters and the seed of the run
//   population.csv   the initial organisms, if a population was given
//   generations.csv, organisms.csv, lineage.csv, events.csv, notes.csv
//   REPEAT.md        instructions to repeat the run, and the version of evod that they need
//   SHA256SUMS       checksums of all files, for `sha256sum --check`
#pragma once

#include "server/replay/run_tables.h"

#include <string>

namespace evod::experiments {

/// Writes the bundle into a folder with the ending `.part`, and renames it to `folder` when it is complete. Refused if
/// `folder` exists. After any other refusal, neither folder exists. A `.part` folder that an ended program left is
/// replaced.
base::Result<void> write_bundle(const replay::RunSource& run, const std::string& folder);

} // namespace evod::experiments
