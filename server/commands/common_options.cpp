#include "server/commands/common_options.h"

#include <cstdlib>
#include <iostream>

namespace evod::commands {

std::string data_folder_or_default(const std::string& given) {
    if (!given.empty()) {
        return given;
    }
    // The specification says that a path which is not absolute is to be ignored.
    if (const char* state = std::getenv("XDG_STATE_HOME"); state != nullptr && *state == '/') {
        return std::string{state} + "/evod";
    }
    if (const char* home = std::getenv("HOME"); home != nullptr && *home == '/') {
        return std::string{home} + "/.local/state/evod";
    }
    return {};
}

bool find_data_folder(std::string& folder) {
    folder = data_folder_or_default(folder);
    if (folder.empty()) {
        std::cerr << "evod: " << no_data_folder << '\n';
    }
    return !folder.empty();
}

} // namespace evod::commands
