// `evod sweep`: many runs of an experiment with other parameters, on all cores, on one machine or on many.
#pragma once

#include "server/simulation/commands.h"

#include <cstddef>
#include <functional>
#include <optional>
#include <string>

namespace evod::command_line {
class Command;
}

namespace evod::commands {

struct SweepOptions {
    std::string file;                       // path of the sweep file
    std::string out;                        // folder; empty: called like the file, without its ending
    std::size_t jobs = 1;                   // runs at a time, >= 1
    bool run_files = false;                 // a run file for each run, too
    std::optional<std::size_t> array_index; // this cell alone
    bool gather = false;                    // runs.csv, from what is there
    bool dry_run = false;                   // say what would be run
    std::function<simulation::RunId()> draw_run_id;
};

/// Exit statuses of `evod sweep`.
enum SweepStatus : int {
    SweepDone = 0,
    SweepError = 1,         // refused; or, to be gathered, some runs are not there yet
    SweepInterrupted = 130, // by SIGINT or SIGTERM; the same command goes on
};

/// What is done to stdout, progress and errors to stderr.
int sweep(const SweepOptions& options);

void add_sweep_command(command_line::Command& app, std::size_t jobs, std::function<simulation::RunId()> draw_run_id);

} // namespace evod::commands
