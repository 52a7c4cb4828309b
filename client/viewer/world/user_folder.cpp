#include "client/viewer/world/user_folder.h"

#include <cstdlib>

namespace evod::viewer {

std::filesystem::path user_folder(const char* variable, const char* below_home) {
    const auto from = [](const char* name) -> std::filesystem::path {
        const char* value = std::getenv(name);
        return value == nullptr ? "" : value;
    };
    if (const auto named = from(variable); named.is_absolute()) {
        return named / "evod";
    }
    const auto home = from("HOME");
    return home.empty() ? home : home / below_home / "evod";
}

} // namespace evod::viewer
