// Common options: checks of numbers, defaults and exit statuses that several commands share, and the folder of --data.
#pragma once

#include "proto/command_line/number.h"
#include "server/base/result.h"

#include <cstddef>
#include <string>
#include <string_view>

namespace evod::commands {

inline constexpr command_line::WholeNumber any_number{}, generation_number{.min = 1}, thread_count{1, 1024};

/// Exit statuses that mean the same in every command.
constexpr int exit_error = 1;
constexpr int exit_interrupted = 130; // by SIGINT or SIGTERM

/// Prints an error to stderr, after the command: "evod run: …". Returns exit_error.
int fail(std::string_view command, const std::string& error);
int fail(std::string_view command, const base::Refusal& error);

/// One per processor, at least 1: the default of --threads and --jobs.
std::size_t default_thread_count();

/// The folder of run files and tokens: `given`, or if that is empty, evod's folder in the state folder of the XDG Base
/// Directory Specification. Returns an empty name where the environment does not name that folder.
std::string data_folder_or_default(const std::string& given);
/// The error after data_folder_or_default() returned an empty name.
inline constexpr const char* no_data_folder =
    "there is no default folder for runs, because neither XDG_STATE_HOME nor HOME is set: name a folder with --data";

/// Replaces an empty name by the default. Returns false, after it has printed the error, where there is none.
bool find_data_folder(std::string_view command, std::string& folder);

} // namespace evod::commands
