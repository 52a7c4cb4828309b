#include "client/viewer/options.h"

#include "client/link/credentials.h"

#include <CLI/CLI.hpp>

#include <charconv>

namespace evod::viewer {

namespace {

constexpr int exit_usage = 2;

constexpr const char* footer = R"(Keys: H in the window lists them. The window closes with Q; the worlds run on.

A screenshot only watches: it sends no command, so the world must be running, or have
reached the tick already. Without a screen it works under xvfb-run.

  evoview --server lab.example:7744 --world default
  evoview --screenshot out.png --at-tick 600

Exit status: 0; 1 no picture could be had, or no window opened; 2 the command line is wrong.)";

constexpr unsigned pixels_min = 64, pixels_max = 8192;

/// "1280x720" → width and height; the text of an error, or empty.
std::string parse_size(const std::string& text, unsigned& width, unsigned& height) {
    const char* end = text.data() + text.size();
    const auto [cross, bad_width] = std::from_chars(text.data(), end, width);
    if (bad_width == std::errc{} && cross != end && *cross == 'x') {
        const auto [rest, bad_height] = std::from_chars(cross + 1, end, height);
        const auto in_range = [](unsigned pixels) { return pixels >= pixels_min && pixels <= pixels_max; };
        if (bad_height == std::errc{} && rest == end && in_range(width) && in_range(height)) {
            return {};
        }
    }
    return "\"" + text + "\" is no size like 1280x720, each from " + std::to_string(pixels_min) + " to " +
           std::to_string(pixels_max);
}

} // namespace

std::variant<Options, int> parse_options(int argc, const char* const* argv) {
    Options options;
    Options::Screenshot screenshot;
    std::string server = "localhost", size = "1280x720";
    CLI::App app{"evoview: a window into an evolution laboratory.", "evoview"};
    app.footer(footer);
    app.set_version_flag("--version", "evoview " EVOD_VERSION);
    app.add_option("--server", server, "where evod is: HOST, HOST:PORT, [IPV6]:PORT")
        ->envname("EVOD_SERVER")
        ->capture_default_str();
    link::Credentials credentials;
    add_options(app, credentials);
    app.add_option("--world", options.world, "the world to look at; else the only one, or \"default\"")
        ->envname("EVOD_WORLD");
    app.add_option("--island", options.island, "its island, from 0")->capture_default_str();
    app.add_option("--size", size, "of the window or the screenshot, in pixels")->capture_default_str();
    auto* shot = app.add_option("--screenshot", screenshot.path, "save one picture as this PNG file, open no window");
    app.add_option("--at-tick", screenshot.tick, "of the first tick from this one on that the server shows")
        ->needs(shot);
    app.add_option("--timeout", screenshot.timeout_s, "seconds to wait for it")
        ->needs(shot)
        ->capture_default_str()
        ->check(CLI::Range(0.0, 1e6));
    app.final_callback([&] {
        if (const auto endpoint = link::parse_endpoint(server)) {
            options.connection.server = *endpoint;
        } else {
            throw CLI::ValidationError{"--server", endpoint.error().what};
        }
        if (const auto known = link::apply(credentials, options.connection); !known) {
            throw CLI::ValidationError{known.error().what};
        }
        if (const std::string error = parse_size(size, options.width_pixels, options.height_pixels); !error.empty()) {
            throw CLI::ValidationError{"--size", error};
        }
    });
    try {
        app.parse(argc, argv);
    } catch (const CLI::ParseError& error) {
        return app.exit(error) == 0 ? 0 : exit_usage;
    }
    if (!screenshot.path.empty()) {
        options.screenshot = screenshot;
    }
    return options;
}

} // namespace evod::viewer
