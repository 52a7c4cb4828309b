// Common options: number checks, defaults and exit statuses that several commands share, and the folder of --data.
#pragma once

#include "proto/command_line/number.h"
#include "server/base/random.h"
#include "server/base/result.h"
#include "server/parameters/model_parameters.h"

#include <cstddef>
#include <optional>
#include <string>

namespace evod::commands {

inline constexpr command_line::WholeNumber any_number{}, generation_number{.min = 1}, thread_count{1, 1024};

/// Exit statuses that mean the same in every command.
constexpr int exit_error = 1;
constexpr int exit_interrupted = 130; // ended by SIGINT or SIGTERM

/// Prints an error to stderr, preceded by the name of the program: "evod: …". Returns exit_error.
int fail(const std::string& error);
int fail(const base::Refusal& error);

/// Prints a warning to stderr: "evod: warning: …".
void warn(const std::string& warning);
/// Prints the warnings about the parameters, and about a seed that programs with doubles read wrongly.
void warn_about(const parameters::Parameters& parameters, std::optional<base::Seed> seed);
/// Returns the warning about a seed; nullopt if there is none.
std::optional<std::string> warning_about(std::optional<base::Seed> seed);

/// The number of processors, at least 1. This is the default of --threads and --jobs.
std::size_t default_thread_count();

/// Uses the vector instructions that the environment variable EVOD_INSTRUCTIONS names, unless it is empty or unset.
/// Prints an error and returns false if this processor does not have them.
bool use_instructions_of_environment();

/// The folder of run files and tokens. If `given` is empty, it is the folder of evod in the state folder of the XDG
/// Base Directory Specification. Returns nullopt if the environment does not define that folder.
std::optional<std::string> data_folder_or_default(const std::string& given);
/// The error message for the case that data_folder_or_default() returns nullopt.
inline constexpr const char* no_data_folder =
    "there is no default folder for runs, because neither XDG_STATE_HOME nor HOME is set: name a folder with --data";

/// Replaces an empty `folder` with the default. If there is no default, prints the error and returns false.
bool find_data_folder(std::string& folder);

} // namespace evod::commands
