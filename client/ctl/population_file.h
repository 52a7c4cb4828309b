// Population files: the CSV that `evod export --what population` writes, for a world to begin with.
#pragma once

#include "client/ctl/registry.h"

#include <istream>
#include <vector>

namespace evod::ctl {

/// One entry per island. Only what the request could not say is checked here, the order of rows and columns; the rest
/// is the server's to judge.
Checked<std::vector<v1::IslandPopulation>> read_population(std::istream& in);

} // namespace evod::ctl
