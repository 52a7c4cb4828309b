#include "client/viewer/screenshot.h"

#include "client/viewer/readout.h"
#include "client/viewer/stage.h"
#include "client/viewer/watch.h"
#include "client/viewer/window.h"

#include <SFML/Window/Context.hpp>

#include <chrono>
#include <iostream>
#include <stdexcept>
#include <string>
#include <thread>

namespace evod::viewer {

namespace {

constexpr double rate_hz = 60; // of pictures: a later tick than was asked for is shown as little as possible
constexpr std::chrono::milliseconds look_again{2};

std::string quoted(const std::string& world) {
    return world.empty() ? "the world" : "the world \"" + world + "\"";
}

/// Where things stand, for the message of a time-out: "the world "default" is paused at tick 12".
std::string standing(const Watch& watch) {
    const auto status = watch.connection_status();
    if (status.state != link::State::Connected) {
        return status.reason.empty() ? "no connection to " + link::to_text(watch.server()) : status.reason;
    }
    const RunControl& control = watch.control();
    if (!control.known()) {
        return link::to_text(watch.server()) + " has shown no picture of " + quoted(watch.world());
    }
    return quoted(control.world()) + " is " + shown_state(control.state(), watch.storage()) + " at tick " +
           std::to_string(control.tick());
}

/// Throws if the picture will never come.
void check_hope(const Watch& watch, std::uint64_t tick) {
    const auto status = watch.connection_status();
    if (status.state == link::State::Failed) {
        throw std::runtime_error{standing(watch)};
    }
    if (const auto refusal = watch.refusal()) {
        throw std::runtime_error{*refusal};
    }
    if (watch.control().state() == evod::v1::RUN_STATE_TERMINATED && watch.control().tick() < tick) {
        throw std::runtime_error{standing(watch) + ", before tick " + std::to_string(tick)};
    }
}

} // namespace

void take_screenshot(const Options& options, const Options::Screenshot& screenshot) {
    using Clock = link::WorldView::Clock;
    const auto end =
        Clock::now() + std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>{screenshot.timeout_s});
    sf::Context context{context_settings(), 1, 1};
    Stage stage;
    Watch watch{
        {.connection = options.connection, .world = options.world, .island = options.island, .rate_hz = rate_hz}};
    bool told = false;
    const auto here = [&] {
        watch.update(Clock::now());
        return watch.all_answered() && watch.picture() && watch.picture()->about.tick() >= screenshot.tick;
    };
    while (!here()) {
        check_hope(watch, screenshot.tick);
        const auto state = watch.control().state();
        if (!told && (state == evod::v1::RUN_STATE_WAITING || state == evod::v1::RUN_STATE_PAUSED)) {
            std::cerr << "evoview: " << standing(watch) << "; waiting for somebody to run it\n";
            told = true;
        }
        if (Clock::now() >= end) {
            throw std::runtime_error{"no picture of tick " + std::to_string(screenshot.tick) + " came within " +
                                     shown_duration(screenshot.timeout_s) + ": " + standing(watch)};
        }
        std::this_thread::sleep_for(look_again);
    }
    Camera camera;
    const Stage::Frame frame{
        .width_pixels = options.width_pixels, .height_pixels = options.height_pixels, .now = Clock::now()};
    if (!stage.capture(watch, camera, frame).saveToFile(screenshot.path)) {
        throw std::runtime_error{"could not write " + screenshot.path};
    }
    std::cout << screenshot.path << ": " << quoted(watch.picture()->about.world()) << " at tick "
              << watch.picture()->about.tick() << '\n';
}

} // namespace evod::viewer
