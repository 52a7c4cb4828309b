// User folder: the folders in which evoview keeps files of the user, by the XDG Base Directory specification.
//
// Threads      none.
#pragma once

#include <filesystem>

namespace evod::viewer {

/// Returns the folder evod in the folder that an environment variable names, or else in a folder of HOME. Empty if HOME
/// is not set either. The specification requires that a relative path in the variable is ignored.
///
/// variable      "XDG_STATE_HOME"
/// below_home    ".local/state"
std::filesystem::path user_folder(const char* variable, const char* below_home);

} // namespace evod::viewer
