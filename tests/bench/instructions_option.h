// The option --instructions of programs that measure: which of the processor's vector instructions evod's kernels use.
#pragma once

#include "server/base/instructions.h"

#include <CLI/CLI.hpp>

#include <map>
#include <string>

namespace evod::bench {

inline const std::map<std::string, base::Instructions> instructions_by_name = {
    {"baseline", base::Instructions::Baseline}, {"avx2", base::Instructions::Avx2}};

/// Puts what is given into use; the widest that the processor has unless it is given.
inline void add_instructions_option(CLI::App& app) {
    const auto use = [](const std::string& name) {
        const base::Instructions asked = instructions_by_name.at(name);
        if (asked > base::widest_instructions()) {
            throw CLI::ValidationError{"--instructions", "this processor has no " + name};
        }
        base::use_instructions(asked);
    };
    app.add_option_function<std::string>("--instructions", use, "baseline or avx2; the widest there are unless given")
        ->check(CLI::IsMember(instructions_by_name));
}

/// Of those in use.
inline std::string instructions_name() {
    for (const auto& [name, instructions] : instructions_by_name) {
        if (instructions == base::instructions()) {
            return name;
        }
    }
    return {};
}

} // namespace evod::bench
