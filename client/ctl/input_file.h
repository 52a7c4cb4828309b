// Input files: reads the files that commands send to the server.
//
// Threads      none.
#pragma once

#include "proto/codec/population_csv.h"

#include <string>

namespace evod::ctl {

/// The largest file with values of organisms. A request, which is smaller, contains them as numbers.
constexpr std::size_t organisms_bytes_max = 64 << 20;

/// Returns the contents of a regular file. Throws Stop if it is a pipe or a device, too large, or cannot be read.
///
/// kind  what the file should contain, for the error message: "an experiment file".
std::string text_in(const std::string& path, std::string_view kind, std::size_t bytes_max);

/// Reads a population file; throws Stop if it is not one.
///
/// list  of the free genes of the world for which it is
codec::Population population_in(const std::string& path, const v1::FreeGeneList& list);

/// Returns the free genes of an experiment that are choices. The server checks the experiment.
v1::FreeGeneList choices_in(const std::string& experiment_json);

} // namespace evod::ctl
