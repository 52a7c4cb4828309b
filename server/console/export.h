// `evod export`: what a run file holds, as rows for other programs.
//
//   generations  statistics, one row per generation and island, as `evod run --csv` writes them
//   organisms    one row per organism of the generations that are held whole: parents, genes, fitness, death
//   events       the journal: one row per command that was applied
//
// Rows are written as they are read, a generation at a time.
#pragma once

#include <string>

namespace evod::console {

struct ExportOptions {
    std::string run; // path of a run file
    std::string what;
    std::string format = "csv"; // or "jsonl"
    std::string output;         // path; empty: stdout
};

/// Returns the exit status: 0, or 1 with a sentence on stderr if the file cannot be read or is damaged, or the output
/// cannot be written; what was written until then stays.
int export_run(const ExportOptions& options);

} // namespace evod::console
