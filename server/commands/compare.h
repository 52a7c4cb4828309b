// `evod compare`: a world beside its controls, or beside others, with the same seeds.
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

struct CompareOptions {
    std::vector<std::string> experiments; // paths; with controls at most one, none: the defaults of the registry
    bool controls = false;
    std::uint32_t replicates = 20;            // >= 2
    std::optional<std::uint32_t> generations; // >= 2; otherwise generation_limit of the first, or default_generations
    std::optional<std::uint64_t> seed;        // otherwise the first experiment's, or
    base::Seed drawn_seed;                    // one by chance
    std::size_t jobs = 1;                     // >= 1
    std::vector<std::string> changes;         // "name=value", of all experiments
    std::string csv, picture;                 // paths; empty: none
};

constexpr std::uint32_t default_generations = 60;
/// With fewer the command warns.
constexpr std::uint32_t replicates_advised = 20;
/// As many as the picture has colours and room for.
constexpr int compared_max = 12;

/// What they come to, to stdout; progress and errors to stderr. Exit status 0, 1 (error) or 130 (SIGINT or SIGTERM:
/// then nothing is told or written).
int compare(const CompareOptions& options);

void add_compare_command(command_line::Command& app, std::size_t jobs, base::Seed drawn_seed);

} // namespace evod::commands
