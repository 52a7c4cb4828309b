// `evod export`: what a run file holds, as rows for other programs.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>

namespace evod::command_line {
class Command;
}

namespace evod::commands {

struct ExportOptions {
    std::string run;                         // path of a run file
    std::string bundle;                      // folder to make instead; empty: none
    std::string what;                        // as run_tables.h names them
    std::string of;                          // "GENERATION:ISLAND:ORGANISM", of the lineage; empty: everyone
    std::optional<std::uint64_t> generation; // of the population; otherwise the last that has begun
    std::string format = "csv";              // or "jsonl"
    std::string output;                      // path; empty: stdout
    std::size_t threads = 1;                 // that simulate again what is not held
};

/// Returns the exit status: 0, or 1 with a sentence on stderr if the file cannot be read or is damaged, or the output
/// cannot be written; what was written until then stays.
int export_run(const ExportOptions& options);

void add_export_command(command_line::Command& app, std::size_t threads);

} // namespace evod::commands
