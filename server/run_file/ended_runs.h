// Ended runs: the files NAME.RUNID.evod that resets and deleted worlds leave in a data folder. Deletes old ones, and
// measures the folder.
//
// Threads  any; no state. A server may use the folder: it does not need these files, and readers of a deleted file can
//          continue.
#pragma once

#include "server/base/result.h"

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace evod::run_file {

struct EndedRun {
    std::string world, path;
    std::uint64_t bytes;
    std::filesystem::file_time_type ended;
};

/// The ended runs that are not among the newest `keep` of their world, the oldest first. Only files whose names contain
/// the id of a run count.
///
/// world  only of this world; empty: of all.
base::Result<std::vector<EndedRun>> surplus_runs(const std::string& folder, std::uint64_t keep,
                                                 const std::string& world = {});

struct Pruned {
    std::vector<EndedRun> deleted;
    std::vector<std::string> failures; // why the others could not be deleted
};

/// Deletes the surplus runs. Refused if the folder cannot be read.
base::Result<Pruned> prune(const std::string& folder, std::uint64_t keep, const std::string& world = {});

/// Bytes of a run file and the SQLite files next to it.
std::uint64_t bytes_of_run(const std::string& path);
/// Bytes of all files in a folder, without its subfolders.
std::uint64_t bytes_of_folder(const std::string& folder);

} // namespace evod::run_file
