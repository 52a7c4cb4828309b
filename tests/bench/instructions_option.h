// The option --instructions of programs that measure: which of the processor's vector instructions evod's kernels use.
#pragma once

#include "server/base/instructions.h"

#include <CLI/CLI.hpp>

#include <string>
#include <vector>

namespace evod::bench {

/// Puts what is given into use; otherwise evod's choice.
inline void add_instructions_option(CLI::App& app) {
    const auto available = base::available_instructions();
    app.add_option_function<std::string>(
           "--instructions", [](const std::string& name) { base::use_instructions(name); },
           "vector instructions; those that evod chooses unless given")
        ->check(CLI::IsMember(std::vector<std::string>{available.begin(), available.end()}));
}

} // namespace evod::bench
