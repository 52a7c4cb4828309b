#include "client/viewer/shell/options.h"

#include "client/core/credentials.h"
#include "client/viewer/drawing/gui.h"
#include "proto/command_line/completion.h"
#include "proto/command_line/number.h"
#include "proto/files/input_file.h"

#include <algorithm>
#include <array>
#include <cerrno>
#include <charconv>
#include <cstring>
#include <filesystem>
#include <limits>

namespace evod::viewer {

namespace {

using command_line::Command;
using command_line::RealNumber;
using command_line::WholeNumber;

constexpr const char* footer =
    R"(Keys: press H in the window to list them. Q closes the window; the worlds continue to run.

A screenshot sends no command, so the world must be running or have reached the tick already. A
recording steps the world from frame to frame if the role allows it, so that no tick is missed;
a world that was running resumes afterwards. Without a display, run both under xvfb-run.

  evoview lab.example:7744 --world default
  evoview --screenshot out.png --at-tick 600
  evoview --world default --all-islands
  evoview --record film.mp4 --past 12 --record-generations 1

Without --server, evoview connects to this machine. While there is no server, the window tries again.

Exit status: 0 success; 1 no snapshot arrived, a file could not be written, no window could be opened,
or a line of the script failed; 2 the command line or the script is invalid.)";

constexpr unsigned pixels_min = 64, pixels_max = 8192;

/// Parses a size such as "1280x720". Returns an error message; empty if the size is valid.
std::string parse_size(const std::string& text, Options::Size& size) {
    const char* end = text.data() + text.size();
    const auto [cross, bad_width] = std::from_chars(text.data(), end, size.width);
    if (bad_width == std::errc{} && cross != end && *cross == 'x') {
        const auto [rest, bad_height] = std::from_chars(cross + 1, end, size.height);
        const auto in_range = [](unsigned pixels) { return pixels >= pixels_min && pixels <= pixels_max; };
        if (bad_height == std::errc{} && rest == end && in_range(size.width) && in_range(size.height)) {
            return {};
        }
    }
    return "got " + text + ", allowed WIDTHxHEIGHT like 1280x720, each from " + std::to_string(pixels_min) + " to " +
           std::to_string(pixels_max);
}

/// Sets `value` to the value with this name; leaves it if `text` is empty. Returns an error message; empty if the name
/// is known.
template <class Value>
std::string parse_name(const std::string& text, const std::array<std::string_view, 2>& names,
                       std::optional<Value>& value) {
    const auto found = std::ranges::find(names, text);
    if (found != names.end()) {
        value = static_cast<Value>(found - names.begin());
    } else if (!text.empty()) {
        return "got " + text + ", allowed " + std::string{names[0]} + " or " + std::string{names[1]};
    }
    return {};
}

core::Result<Script> read_script(const std::string& path) {
    const auto wrong = [&](const std::string& why) {
        return core::Error{.kind = core::Error::Kind::Usage, .what = "--script: " + path + ":" + why};
    };
    constexpr std::size_t script_bytes_max = 1 << 20;
    const auto text = files::read_input(path, "a script", script_bytes_max);
    if (!text) {
        return wrong(" " + text.error().why);
    }
    auto script = Script::parse(*text);
    if (!script) {
        return wrong(script.error().what);
    }
    return script;
}

} // namespace

Options::Size size_of(const Options& options, double scale) {
    const auto scaled = [&](double pixels) { return static_cast<unsigned>(pixels * scale); };
    return options.size.value_or(Options::Size{scaled(1280), scaled(720)});
}

WantedWorld wanted_of(const Options& options, double rate_hz) {
    return {.connection = options.connection,
            .world = options.world,
            .island = options.island,
            .rate_hz = rate_hz,
            .all_islands = options.all_islands,
            .replay_generation = options.replay_generation};
}

ViewOptions view_of(const Options& options) {
    return default_options({options.skin.value_or(Skin::Vivid), options.background.value_or(Background::Dark)});
}

namespace {

/// Options whose texts are converted after the command line was parsed.
struct Texts {
    std::string size, skin, background;
};

void add_recording_options(Command& app, command_line::Option recording, Options::Record& record) {
    app.add_option("--record-ticks", &record.ticks,
                   "Stop after this many ticks; default: at the end of the run, or with Ctrl+C")
        .needs(recording)
        .check(WholeNumber{});
    app.add_option("--record-generations", &record.generations, "Stop when this many more generations have ended")
        .needs(recording)
        .check(WholeNumber{.min = 1});
    app.add_option("--every", &record.every_ticks, "Number of ticks between two frames, 1 to 1000000")
        .needs(recording)
        .show_default()
        .check(WholeNumber{1, 1'000'000});
    app.add_option("--fps", &record.fps,
                   "Frames per second of a film, 0.1 to 1000; 60 shows ticks of 1/60 s in real time")
        .needs(recording)
        .show_default()
        .check(RealNumber{0.1, 1000});
}

/// Converts texts, and reads the script. Returns what is wrong; "" if nothing is.
std::string convert_texts(const Texts& texts, Options& options) {
    if (!texts.size.empty()) {
        if (const std::string error = parse_size(texts.size, options.size.emplace()); !error.empty()) {
            return "--size: " + error;
        }
    }
    if (const std::string error = parse_name(texts.skin, skin_names, options.skin); !error.empty()) {
        return "--skin: " + error;
    }
    if (const std::string error = parse_name(texts.background, background_names, options.background); !error.empty()) {
        return "--background: " + error;
    }
    if (options.skin == Skin::Classic && options.background) {
        return "--background: got " + texts.background + " with --skin classic, allowed only with --skin vivid";
    }
    if (!options.script_path.empty()) {
        auto read = read_script(options.script_path);
        if (!read) {
            return read.error().what;
        }
        options.script = *std::move(read);
    }
    return "";
}

} // namespace

std::variant<Options, int> parse_options(int argc, const char* const* argv) {
    Options options;
    Options::Screenshot screenshot;
    Options::Record record;
    std::string server = "localhost";
    Texts texts;
    Command app{"evoview", "evoview: shows the worlds of an evod server in a window", "evoview " EVOD_VERSION};
    app.footer(footer + std::string{"\n\nActions of a script, one per line:\n"} + Script::reference());
    app.add_option("server,--server", &server, "Address of the server: HOST, HOST:PORT or [IPV6]:PORT")
        .environment("EVOD_SERVER")
        .show_default();
    core::Credentials credentials;
    add_options(app, credentials);
    app.add_option("--world", &options.world,
                   "Name of the world to show; default: the server's only world, or the world \"default\"")
        .environment("EVOD_WORLD");
    app.add_option("--island", &options.island, "Island to show, numbered from 0")
        .show_default()
        .check(WholeNumber{.max = std::numeric_limits<std::uint32_t>::max()});
    app.add_flag("--all-islands", &options.all_islands, "Show all islands as tiles");
    app.add_option("--past", &options.replay_generation, "Start with a replay of the world at this generation")
        .check(WholeNumber{.min = 1});
    app.add_option("--size", &texts.size,
                   "Size of the window or image in pixels, WIDTHxHEIGHT; default: 1280x720 times the scale");
    app.add_option("--scale", &options.scale,
                   "Scale of text and widgets, 0.5 to 4; default: the scale of the display; 1 for images and films")
        .check(RealNumber{Gui::scale_min, Gui::scale_max});
    app.add_option(
        "--skin", &texts.skin,
        "How islands are drawn. vivid: filled bodies, leaves and stars; classic: hollow circles and dots on grey; "
        "default: vivid");
    app.add_option("--background", &texts.background, "Background of the skin vivid: dark or light; default: dark");
    const auto script = app.add_option("--script", &options.script_path, "File with actions to perform in the window");
    const auto shot =
        app.add_option("--screenshot", &screenshot.path, "Save one frame as this PNG file, without a window")
            .excludes(script);
    app.add_option("--at-tick", &screenshot.tick,
                   "Tick of the screenshot; a snapshot of this tick or a later one is saved")
        .needs(shot)
        .check(WholeNumber{});
    const auto recording =
        app.add_option(
               "--record", &record.path,
               "Save a sequence of frames without a window: as PNG files in this folder, or, if the path\nends in "
               ".mp4, .mkv, .webm, .mov, .avi or .gif, as a film created by ffmpeg")
            .excludes(shot)
            .excludes(script);
    add_recording_options(app, recording, record);
    const auto timeout =
        app.add_option("--timeout", &screenshot.timeout_s, "Seconds to wait for a screenshot or a recorded frame")
            .show_default()
            .check(RealNumber{0, 1e6});
    add_help_commands(app);
    app.action([] { return 0; }); // main() opens the window
    if (command_line::complete(app, argc, argv)) {
        return 0;
    }
    if (const auto ended = app.parse(argc, argv)) {
        return *ended;
    }
    if (app.given_command() != nullptr) {
        return app.run();
    }

    const auto endpoint = core::parse_endpoint(server);
    if (!endpoint) {
        return app.reject("--server: " + endpoint.error().what);
    }
    options.connection.server = *endpoint;
    if (const auto known = core::apply(credentials, options.connection); !known) {
        return app.reject(known.error().what);
    }
    if (timeout.is_given() && screenshot.path.empty() && record.path.empty()) {
        return app.reject("--timeout: allowed only with --screenshot or --record");
    }
    if (const std::string error = convert_texts(texts, options); !error.empty()) {
        return app.reject(error);
    }
    if (!screenshot.path.empty()) {
        options.screenshot = screenshot;
    }
    if (!record.path.empty()) {
        record.timeout_s = screenshot.timeout_s;
        options.record = record;
    }
    return options;
}

} // namespace evod::viewer
