#include "server/commands/common_options.h"

#include <algorithm>
#include <cstdlib>
#include <iostream>
#include <thread>

namespace evod::commands {

int fail(std::string_view command, const std::string& error) {
    std::cerr << command << ": " << error << '\n';
    return exit_error;
}

int fail(std::string_view command, const base::Refusal& error) {
    return fail(command, base::to_text(error));
}

std::size_t default_thread_count() {
    return std::max(1u, std::thread::hardware_concurrency());
}

std::string data_folder_or_default(const std::string& given) {
    if (!given.empty()) {
        return given;
    }
    // The XDG Base Directory Specification requires programs to ignore a relative path.
    if (const char* state = std::getenv("XDG_STATE_HOME"); state != nullptr && *state == '/') {
        return std::string{state} + "/evod";
    }
    if (const char* home = std::getenv("HOME"); home != nullptr && *home == '/') {
        return std::string{home} + "/.local/state/evod";
    }
    return {};
}

bool find_data_folder(std::string_view command, std::string& folder) {
    folder = data_folder_or_default(folder);
    if (folder.empty()) {
        fail(command, no_data_folder);
    }
    return !folder.empty();
}

} // namespace evod::commands
