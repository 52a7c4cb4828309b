// Options: the command line of evoview.
#pragma once

#include "client/core/connection.h"
#include "client/viewer/shell/script.h"
#include "client/viewer/watch/watch.h"

#include <cstdint>
#include <optional>
#include <string>
#include <variant>

namespace evod::viewer {

struct Options {
    core::Options connection; // to where, as whom
    std::string world;        // empty: the server's choice
    std::uint32_t island = 0;
    bool all_islands = false;                     // at once, as tiles
    std::optional<std::string> beside;            // a second world, in the right half
    std::optional<std::uint64_t> past_generation; // begin in the past of the world, with this generation
    /// Of the window or the pictures; nullopt: 1280 × 720 times the scale.
    struct Size {
        unsigned width, height; // in pixels
    };
    std::optional<Size> size;
    std::optional<double> scale; // of text and widgets; nullopt: as the screen needs it

    bool server_given = false; // or else the start screen comes up where there is none
    bool start = false;        // with the start screen
    std::optional<Script> script;
    std::string script_path;

    /// Not a window, but one picture in a file.
    struct Screenshot {
        std::string path;
        std::uint64_t tick = 0; // the first picture that shows this tick or a later one
        double timeout_s = 60;
    };
    std::optional<Screenshot> screenshot;

    /// Not a window, but picture after picture in files.
    struct Record {
        std::string path;                         // a folder, or a film by its ending
        std::optional<std::uint64_t> ticks;       // end after so many; without both, with the run
        std::optional<std::uint64_t> generations; // end when so many more have ended
        std::uint64_t every_ticks = 1;            // from one picture to the next
        double fps = 60;                          // pictures a second of a film
        double timeout_s = 60;                    // for one picture
    };
    std::optional<Record> record;
};

/// The size of the window or the screenshot.
Options::Size size_of(const Options& options, double scale);

/// What the first pane watches.
Watch::Wanted wanted_of(const Options& options, double rate_hz = Watch::Wanted{}.rate_hz);

/// The options; or the exit status, after help, version or an error was printed.
std::variant<Options, int> parse_options(int argc, const char* const* argv);

} // namespace evod::viewer
