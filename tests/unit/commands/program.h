// Program: runs a subcommand of evod within the test, from its command line to its exit status.
#pragma once

#include "proto/command_line/command.h"
#include "server/commands/commands.h"

#include <gtest/gtest.h>

#include <fstream>
#include <iterator>
#include <string>
#include <vector>

namespace evod::commands {

struct Ended {
    int status = 0;
    std::string output, errors; // stdout and stderr
};

/// add    adds the subcommand: add_run_command.
/// words  the command line after `evod`: {"run", "--seed", "3"}.
inline Ended run_command(void (*add)(command_line::Command&), std::vector<std::string> words) {
    std::vector<const char*> arguments{"evod"};
    for (const std::string& word : words) {
        arguments.push_back(word.c_str());
    }
    command_line::Command app{"evod", "", ""};
    add(app);
    testing::internal::CaptureStdout();
    testing::internal::CaptureStderr();
    Ended ended;
    const auto rejected = app.parse(static_cast<int>(arguments.size()), arguments.data());
    ended.status = rejected ? *rejected : app.run();
    ended.errors = testing::internal::GetCapturedStderr();
    ended.output = testing::internal::GetCapturedStdout();
    return ended;
}

inline std::string contents_of(const std::string& path) {
    std::ifstream file{path, std::ios::binary};
    return {std::istreambuf_iterator<char>{file}, {}};
}

/// An experiment that takes a moment: four organisms, generations of half a second.
inline constexpr const char* small_experiment =
    R"({"population_size": 4, "generation_s": 0.5, "food_count": 5, "poison_count": 5})";

} // namespace evod::commands
