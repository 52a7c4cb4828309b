#include "client/viewer/shell/screenshot.h"

#include "client/core/duration.h"
#include "client/viewer/drawing/png.h"
#include "client/viewer/panes/window_renderer.h"
#include "client/viewer/shell/screen.h"
#include "client/viewer/shell/snapshot_wait.h"
#include "client/viewer/world/status_text.h"

#include <SFML/Window/Context.hpp>

#include <chrono>
#include <iostream>
#include <stdexcept>
#include <string>
#include <thread>

namespace evod::viewer {

namespace {

constexpr double screenshot_rate_hz =
    60; // snapshots per second; high, so that the screenshot is taken close to the requested tick

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
    Panes panes{wanted_of(options, screenshot_rate_hz), options.beside, view_of(options)};
    bool reported = false;
    const auto late = [&]() -> const ViewedWorld* { // returns a world whose snapshot has not arrived; null: none
        const bool all = all_have_snapshots(panes);
        for (std::size_t i = 0; i < panes.size(); ++i) {
            for (const Tile& tile : panes[i].tiles()) {
                if (!tile.view.latest() || tile.view.latest()->about.tick() < screenshot.tick) {
                    return &panes[i].world;
                }
            }
        }
        return all ? nullptr : &panes[0].world;
    };
    while (const ViewedWorld* world = late()) {
        for (std::size_t i = 0; i < panes.size(); ++i) {
            check_reachable(panes[i].world, screenshot.tick);
        }
        const auto state = world->feed.control().state();
        if (!reported && (state == evod::v1::RUN_STATE_WAITING || state == evod::v1::RUN_STATE_PAUSED) &&
            world->feed.control().tick() < screenshot.tick) {
            std::cerr << "evoview: " << progress_text(*world) << "; waiting until a client runs it\n";
            reported = true;
        }
        if (Clock::now() >= end) {
            throw std::runtime_error{"no snapshot of tick " + std::to_string(screenshot.tick) + " arrived within " +
                                     core::duration(screenshot.timeout_s) + ": " + progress_text(*world)};
        }
        std::this_thread::sleep_for(poll_interval);
    }
    const Options::Size size = size_of(options, scale);
    const WindowRenderer::Frame frame{.width_pixels = size.width, .height_pixels = size.height, .now = Clock::now()};
    write_file(screenshot.path, png_of(renderer.capture(panes, frame)));
    const auto& about = panes[0].world.feed.snapshot()->about;
    std::cout << screenshot.path << ": " << quoted(about.world()) << " at tick " << about.tick() << '\n';
}

} // namespace evod::viewer
