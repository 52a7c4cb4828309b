// Options: parses the command line of evoview.
#pragma once

#include "client/core/connection.h"
#include "client/viewer/island/island_view.h"
#include "client/viewer/shell/script.h"
#include "client/viewer/world/viewed_world.h"

#include <cstdint>
#include <optional>
#include <string>
#include <variant>

namespace evod::viewer {

struct Options {
    core::Options connection; // server and credentials
    std::string world;        // empty: the server's choice
    std::uint32_t island = 0;
    bool all_islands = false;                       // show all islands at once, as tiles
    std::optional<std::uint64_t> replay_generation; // start with a replay of the world at this generation
    /// Size of the window, screenshot or recording; nullopt: 1280 × 720 times the scale.
    struct Size {
        unsigned width, height; // in pixels
    };
    std::optional<Size> size;
    std::optional<double> scale; // scale of text and widgets; nullopt: chosen by the display

    std::optional<Skin> skin;
    std::optional<Background> background;

    std::optional<Script> script;
    std::string script_path;

    /// Options for saving one frame instead of opening a window.
    struct Screenshot {
        std::string path;
        std::uint64_t tick = 0; // wait for a snapshot of this tick or a later one
        double timeout_s = 60;
    };
    std::optional<Screenshot> screenshot;

    /// Options for saving a sequence of frames instead of opening a window.
    struct Record {
        std::string path;                         // a film if is_film(path), otherwise a folder
        std::optional<std::uint64_t> ticks;       // ticks to record; both nullopt: until the run ends
        std::optional<std::uint64_t> generations; // further generations to record
        std::uint64_t every_ticks = 1;            // ticks between two frames
        double fps = 60;                          // frames per second of a film
        double timeout_s = 60;                    // longest wait for one frame
    };
    std::optional<Record> record;
};

/// Returns the size of the window, screenshot or recording.
Options::Size size_of(const Options& options, double scale);

/// Returns the world to view.
WantedWorld wanted_of(const Options& options, double rate_hz = WantedWorld{}.rate_hz);

/// Returns the default view options of the skin and the background of the command line.
ViewOptions view_of(const Options& options);

/// Returns the options. If help, the version or an error was printed, returns the exit status instead.
std::variant<Options, int> parse_options(int argc, const char* const* argv);

} // namespace evod::viewer
