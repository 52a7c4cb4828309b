// Common options: what several commands of evod check their options with, and the folder that --data stands for.
#pragma once

#include "proto/command_line/number.h"

#include <string>

namespace evod::commands {

inline constexpr command_line::WholeNumber any_number{}, generation_number{.min = 1}, thread_count{1, 1024};

/// Where runs and tokens are kept: `given` unless it is empty; otherwise evod's folder below the one that the XDG Base
/// Directory Specification has for what programs remember. Empty where the environment names no such folder.
std::string data_folder_or_default(const std::string& given);
/// Why data_folder_or_default() returned an empty name, and what to do.
inline constexpr const char* no_data_folder =
    "neither XDG_STATE_HOME nor HOME says where runs are kept: name a folder with --data";

/// Replaces an empty name by the default. Returns whether there is one; if not, it has printed why.
bool find_data_folder(std::string& folder);

} // namespace evod::commands
