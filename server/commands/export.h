// `evod export`: writes a table of a run file as CSV or JSON lines, or the whole run as a bundle.
//
// Threads  one; `threads` workers simulate the generations that the file does not store in full.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>

namespace evod::commands {

struct ExportOptions {
    std::string run;    // path of a run file
    std::string bundle; // path of a folder to create instead of a table; empty: write a table
    std::string what;   // the table, as --what spells it; empty for a bundle
    // The organism whose lineage is exported: "GENERATION:ISLAND:ORGANISM"; empty: all organisms.
    std::string of;
    std::optional<std::uint64_t> generation; // only for the population; nullopt: the last generation that has begun
    std::string format = "csv";              // "csv" or "jsonl"
    std::string output;                      // path of the output; empty: stdout
    std::size_t threads = 1;
    std::uint32_t every = 1; // of generations and organisms: only every n-th generation, and the last one
};

/// Returns the exit status: 0, or 1 after it has printed an error to stderr. Rows written before an error are kept.
int export_run(const ExportOptions& options);

} // namespace evod::commands
