// World template: files that describe a new world, as fields of a CreateWorld.
//
// Threads      none.
#pragma once

#include "evod/v1/commands.pb.h"

#include <string>

namespace evod::ctl {

/// Adds the text of an experiment file to a request. The server parses it. Throws Stop if the file cannot be read.
void add_experiment(const std::string& path, v1::CreateWorld& command);

/// Adds a population file, for the experiment that the request contains already. Throws Stop if the file is invalid.
void add_population(const std::string& path, v1::CreateWorld& command);

} // namespace evod::ctl
