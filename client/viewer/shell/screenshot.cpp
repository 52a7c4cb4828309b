#include "client/viewer/shell/screenshot.h"

#include "client/core/duration.h"
#include "client/viewer/drawing/png.h"
#include "client/viewer/shell/screen.h"
#include "client/viewer/shell/waiting.h"
#include "client/viewer/stage/stage.h"
#include "client/viewer/watch/readout.h"

#include <SFML/Window/Context.hpp>

#include <chrono>
#include <iostream>
#include <stdexcept>
#include <string>
#include <thread>

namespace evod::viewer {

namespace {

constexpr double screenshot_rate_hz = 60; // of pictures: a later tick than was asked for is shown as little as possible

/// Throws if the picture will never come.
void check_hope(const Watch& watch, std::uint64_t tick) {
    check_hope(watch);
    if (watch.control().state() == evod::v1::RUN_STATE_TERMINATED && watch.control().tick() < tick) {
        throw std::runtime_error{standing(watch) + ", before tick " + std::to_string(tick)};
    }
}

} // namespace

void take_screenshot(const Options& options, const Options::Screenshot& screenshot) {
    using Clock = core::WorldView::Clock;
    const auto end =
        Clock::now() + std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>{screenshot.timeout_s});
    sf::Context context{context_settings(), 1, 1};
    const double scale = options.scale.value_or(1); // a file is on no screen
    Stage stage{scale};
    Panes panes{wanted_of(options, screenshot_rate_hz), options.beside};
    bool told = false;
    const auto late = [&]() -> const Watch* { // a world that is not there yet
        const bool all = all_have_pictures(panes);
        for (std::size_t i = 0; i < panes.size(); ++i) {
            for (const Tile& tile : panes[i].tiles()) {
                if (!tile.view.latest() || tile.view.latest()->about.tick() < screenshot.tick) {
                    return &panes[i].watch;
                }
            }
        }
        return all ? nullptr : &panes[0].watch;
    };
    while (const Watch* watch = late()) {
        for (std::size_t i = 0; i < panes.size(); ++i) {
            check_hope(panes[i].watch, screenshot.tick);
        }
        const auto state = watch->control().state();
        if (!told && (state == evod::v1::RUN_STATE_WAITING || state == evod::v1::RUN_STATE_PAUSED) &&
            watch->control().tick() < screenshot.tick) {
            std::cerr << "evoview: " << standing(*watch) << "; waiting for somebody to run it\n";
            told = true;
        }
        if (Clock::now() >= end) {
            throw std::runtime_error{"no picture of tick " + std::to_string(screenshot.tick) + " came within " +
                                     core::duration(screenshot.timeout_s) + ": " + standing(*watch)};
        }
        std::this_thread::sleep_for(look_again);
    }
    const Options::Size size = size_of(options, scale);
    const Stage::Frame frame{.width_pixels = size.width, .height_pixels = size.height, .now = Clock::now()};
    write_file(screenshot.path, png_of(stage.capture(panes, frame)));
    const auto& about = panes[0].watch.picture()->about;
    std::cout << screenshot.path << ": " << quoted(about.world()) << " at tick " << about.tick() << '\n';
}

} // namespace evod::viewer
