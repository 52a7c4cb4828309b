// Options: the command line of evoview.
#pragma once

#include "client/link/connection.h"

#include <cstdint>
#include <optional>
#include <string>
#include <variant>

namespace evod::viewer {

struct Options {
    link::Options connection; // to where, as whom
    std::string world;        // empty: the server's choice
    std::uint32_t island = 0;
    unsigned width_pixels = 1280, height_pixels = 720;

    /// Not a window, but one picture in a file.
    struct Screenshot {
        std::string path;
        std::uint64_t tick = 0; // the first picture that shows this tick or a later one
        double timeout_s = 60;
    };
    std::optional<Screenshot> screenshot;
};

/// The options; or the exit status, after help, version or an error was printed.
std::variant<Options, int> parse_options(int argc, const char* const* argv);

} // namespace evod::viewer
