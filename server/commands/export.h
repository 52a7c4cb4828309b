// `evod export`: writes the contents of a run file as rows for other programs, or the run as a bundle.
//
// Threads  one; `threads` workers simulate the generations that the file does not contain in full.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>

namespace evod::commands {

struct ExportOptions {
    std::string run;                         // path of a run file
    std::string bundle;                      // folder to make instead of a table; empty: none
    std::string what;                        // which table, as --what spells it; empty with a bundle
    std::string of;                          // "GENERATION:ISLAND:ORGANISM": its lineage alone; empty: all organisms
    std::optional<std::uint64_t> generation; // of the population; nullopt: the last that has begun
    std::string format = "csv";              // or "jsonl"
    std::string output;                      // path; empty: stdout
    std::size_t threads = 1;
};

/// Returns the exit status: 0, or 1 after an error on stderr. What was written before the error stays.
int export_run(const ExportOptions& options);

} // namespace evod::commands
