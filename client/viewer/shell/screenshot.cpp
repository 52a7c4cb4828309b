#include "client/viewer/shell/screenshot.h"

#include "client/core/duration.h"
#include "client/viewer/drawing/png.h"
#include "client/viewer/drawing/window_layout.h"
#include "client/viewer/shell/screen.h"
#include "client/viewer/shell/snapshot_wait.h"
#include "client/viewer/view/window_renderer.h"
#include "client/viewer/world/status_text.h"

#include <SFML/Window/Context.hpp>

#include <algorithm>
#include <chrono>
#include <iostream>
#include <stdexcept>
#include <string>
#include <thread>

namespace evod::viewer {

namespace {

constexpr double screenshot_rate_hz =
    60; // snapshots per second; high, so that the screenshot is taken close to the requested tick

// The sidebar requests what it shows while it is drawn, and again after some of the answers. The image does not wait
// until nothing more is requested, because in a fast world something always is.
constexpr unsigned sidebar_requests = 3;

/// Throws std::runtime_error if no snapshot of `tick` or a later tick can arrive.
void check_reachable(const ViewedWorld& world, std::uint64_t tick) {
    check_reachable(world);
    if (world.feed.control().state() == evod::v1::RUN_STATE_TERMINATED && world.feed.control().tick() < tick) {
        throw std::runtime_error{progress_text(world) + ", before tick " + std::to_string(tick)};
    }
}

} // namespace

void take_screenshot(const Options& options, const Options::Screenshot& screenshot) {
    using Clock = core::SnapshotInterpolator::Clock;
    const auto end =
        Clock::now() + std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>{screenshot.timeout_s});
    sf::Context context{context_settings(), 1, 1};
    const double scale = options.scale.value_or(1); // independent of any display
    WindowRenderer renderer{scale};
    WorldView view{wanted_of(options, screenshot_rate_hz), view_of(options)};
    const RunControl& control = view.world.feed.control();
    const Options::Size size = size_of(options, scale);
    const bool with_sidebar = size.width >= 2 * double{sidebar_width} * scale; // a smaller image shows only the island
    const auto draw = [&] {
        return renderer.capture(view, {.width_pixels = size.width,
                                       .height_pixels = size.height,
                                       .now = Clock::now(),
                                       .interactive = with_sidebar});
    };
    unsigned draw_count = 0;
    const auto arrived = [&] {
        if (!has_all_snapshots(view)) {
            return false;
        }
        if (with_sidebar && (draw_count < sidebar_requests || !view.world.feed.events().empty())) {
            draw();
            if (++draw_count <= sidebar_requests) { // wait for the answers
                return false;
            }
        }
        return std::ranges::all_of(
            view.tiles(), [&](const Tile& tile) { return tile.view.latest()->about.tick() >= screenshot.tick; });
    };
    bool reported = false;
    while (!arrived()) {
        check_reachable(view.world, screenshot.tick);
        const bool stopped =
            control.state() == evod::v1::RUN_STATE_WAITING || control.state() == evod::v1::RUN_STATE_PAUSED;
        if (!reported && stopped && control.tick() < screenshot.tick) {
            std::cerr << "evoview: " << progress_text(view.world) << "; waiting until a client runs it\n";
            reported = true;
        }
        if (Clock::now() >= end) {
            throw std::runtime_error{"no snapshot of tick " + std::to_string(screenshot.tick) + " arrived within " +
                                     core::duration(screenshot.timeout_s) + ": " + progress_text(view.world)};
        }
        std::this_thread::sleep_for(poll_interval);
    }
    write_file(screenshot.path, png_of(draw()));
    const auto& about = view.world.feed.snapshot()->about;
    std::cout << screenshot.path << ": " << quoted(about.world()) << " at tick " << about.tick() << '\n';
}

} // namespace evod::viewer
