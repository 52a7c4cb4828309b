// `evod run`: one experiment from beginning to end, without a network.
#pragma once

#include "server/base/random.h"

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace evod::command_line {
class Command;
}

namespace evod::commands {

struct RunOptions {
    std::string experiment; // path; empty: the defaults of the registry
    std::string population; // path; empty: the first generation is drawn
    std::optional<std::uint64_t> seed;
    base::Seed drawn_seed;                    // by chance, for an experiment that has none
    std::optional<std::uint32_t> generations; // takes the place of generation_limit
    std::size_t threads = 1;
    std::vector<std::string> changes; // "name=value"
    std::string csv;                  // path; empty: none
    bool ask = false;
};

/// Exit statuses of `evod run`, by outcome.
enum RunStatus : int {
    LimitOrTargetReached = 0,
    RunError = 1,
    WrongArguments = 2,
    Stagnated = 3,
    Extinct = 4,
    Interrupted = 130, // by SIGINT or SIGTERM, after the summary
};

/// Runs until a termination criterion holds or a signal comes; statistics to stdout, progress and errors to stderr.
int run(const RunOptions& options);

void add_run_command(command_line::Command& app, std::size_t threads, base::Seed drawn_seed);

} // namespace evod::commands
