// Backup: a copy of a data folder from which a server can continue. A server may use the folder at the same time.
//
// Consistent   each file is a snapshot between two commits of its run. Runs of different worlds do not depend on each
//              other. A world that is created or deleted during the backup may be in the copy or not.
// Complete     the copy is made in a new folder `FOLDER.partial-…`, checked row by row, written to the disk, and then
//              renamed. A killed backup leaves this folder.
// Threads      one.
#pragma once

#include "server/base/result.h"

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace evod::run_file {

struct Backup {
    std::size_t worlds = 0, ended = 0; // number of copied runs
    bool has_tokens = false, has_classes = false;
    std::uint64_t bytes = 0;
    std::vector<std::string> failures = {}; // why single files could not be copied; the others are in the copy
};

/// Copies the runs, the tokens and the classes of the folder `data` to `folder`, which must be empty or must not exist,
/// and must not be in `data`. A refusal means that there is no copy.
base::Result<Backup> back_up(const std::string& data, const std::string& folder);

} // namespace evod::run_file
