// Bundle: a run as a folder that can be given away: everything that is known of it, and how to repeat it.
//
//   NAME.evod        a copy of the run file, at one moment though a server writes to it
//   experiment.json  the parameters that the run began with, and its seed
//   population.csv   the organisms that it began with, if they were given
//   generations.csv, organisms.csv, lineage.csv, events.csv
//   REPEAT.md        how to repeat the run, and with what
//   SHA256SUMS       of all these, for `sha256sum --check`
#pragma once

#include "server/replay/run_tables.h"

#include <string>

namespace evod::experiments {

/// folder  is made; refused if there is something of that name. Nothing of it is left if anything else is refused.
base::Result<void> write_bundle(const replay::RunSource& run, const std::string& folder);

} // namespace evod::experiments
