// Input files: reads the files that commands send to the server.
//
// Threads      none.
#pragma once

#include "proto/codec/population_csv.h"

#include <fstream>
#include <string>
#include <vector>

namespace evod::ctl {

/// Opens a file for reading; throws Stop if this fails.
///
/// what  kind of the file, for the error message: "experiment".
std::ifstream open_file(const std::string& what, const std::string& path);

/// Reads a population file; throws Stop if it is not one.
codec::Population population_in(const std::string& path);

} // namespace evod::ctl
