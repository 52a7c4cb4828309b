// Presets: the experiments of the folder experiments/, which evoview contains and offers for new worlds.
//
// Owner        none: constants, which CMake writes from the files.
// Threads      any.
#pragma once

#include <span>
#include <string_view>

namespace evod::viewer {

struct Preset {
    std::string_view name;        // of the file, without ".json": "annealing"
    std::string_view description; // the field "description" of the file
    std::string_view json;        // the whole file
};

/// Returns all presets: "default" first, then in the order of their names.
std::span<const Preset> presets();

} // namespace evod::viewer
