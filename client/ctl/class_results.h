// Class results: what the worlds of a class have come to, as tables, and as files in a folder.
#pragma once

#include "client/ctl/caller.h"

#include <string>

namespace evod::ctl {

struct CompareOptions {
    std::string name;
    bool csv = false, summary = false;
};
struct CollectOptions {
    std::string name, folder;
};

/// Prints the statistics of the worlds with which the members began.
void compare_class(const Common& common, const CompareOptions& options);

/// Writes a run file for each world of a class, notes.csv and students.csv. Each file appears complete or not at all.
/// After a world that cannot be exported, goes on with the others; throws Stop at the end.
void collect_class(const Common& common, const CollectOptions& options);

} // namespace evod::ctl
