#include "client/viewer/window.h"

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <thread>

namespace evod::viewer {

namespace {

// The screen paces the window where it can; this is for where it cannot, and too short to miss a beat at 60 Hz.
constexpr std::chrono::milliseconds frame_min{15};

void toggle(bool& shown) {
    shown = !shown;
}

} // namespace

sf::ContextSettings context_settings() {
    return sf::ContextSettings{0, 0, 0, 3, 3, sf::ContextSettings::Core};
}

Window::Window(const Options& options)
    : window_{sf::VideoMode{options.width_pixels, options.height_pixels}, "evoview", sf::Style::Default,
              context_settings()}
    , watch_{{.connection = options.connection, .world = options.world, .island = options.island}} {
    window_.setVerticalSyncEnabled(true);
}

Stage::Frame Window::frame() const {
    const sf::Vector2u size = window_.getSize();
    return {.width_pixels = std::max(size.x, 1u), .height_pixels = std::max(size.y, 1u), .now = now_};
}

void Window::run() {
    using Clock = link::WorldView::Clock;
    now_ = Clock::now();
    while (window_.isOpen()) {
        const double seconds = std::chrono::duration<double>{Clock::now() - now_}.count();
        now_ = Clock::now();
        handle_events();
        input_.move(camera_, seconds);
        watch_.update(now_);
        for (std::string& notice : watch_.take_notices()) {
            stage_.overlay().notice(std::move(notice), now_);
        }
        Stage::Frame next = frame();
        next.blend = watch_.view().blend_at(now_);
        next.pointed_at = stage_.gui().captured().mouse ? std::nullopt : input_.pointed_at();
        stage_.draw(watch_, camera_, next);
        window_.display();
        std::this_thread::sleep_until(now_ + frame_min);
    }
}

void Window::handle_events() {
    for (sf::Event event; window_.pollEvent(event);) {
        stage_.gui().handle(event);
        if (const auto action = input_.handle(event, stage_.gui().captured(), camera_)) {
            carry_out(*action);
        }
        if (const auto click = input_.take_click()) {
            stage_.select_at(watch_, camera_, *click);
        }
    }
}

void Window::carry_out(Action action) {
    switch (action) {
    case Action::PauseOrResume:
        return watch_.pause_or_resume();
    case Action::StepOne:
        return watch_.step(1);
    case Action::StepMany:
        return watch_.step(step_many_ticks);
    case Action::Faster:
        return watch_.faster();
    case Action::Slower:
        return watch_.slower();
    case Action::RealTime:
        return watch_.real_time();
    case Action::MaxSpeed:
        return watch_.max_speed();
    case Action::NextIsland:
        return watch_.turn_islands(1);
    case Action::PreviousIsland:
        return watch_.turn_islands(-1);
    case Action::NextWorld:
        return watch_.next_world();
    case Action::Fit:
        return camera_.fit();
    case Action::NextColouring:
        return stage_.sight().next_colouring();
    case Action::Radii:
        return toggle(stage_.sight().shown.radii);
    case Action::Forces:
        return toggle(stage_.sight().shown.forces);
    case Action::Trails:
        return toggle(stage_.sight().shown.trails);
    case Action::Follow:
        return stage_.sight().toggle_following(watch_);
    case Action::Screenshot:
        return save_screenshot();
    case Action::Help:
        return stage_.overlay().toggle_help();
    case Action::Close:
        return stage_.overlay().help() ? stage_.overlay().toggle_help() : window_.close();
    case Action::Quit:
        return window_.close();
    }
}

void Window::save_screenshot() {
    std::string name = "evoview";
    if (const wire::Picture* picture = watch_.picture()) {
        name += "-" + picture->about.world() + "-island-" + std::to_string(picture->about.island()) + "-tick-" +
                std::to_string(picture->about.tick());
    }
    name += ".png";
    // Latest positions, as the tick in the name says, and not those on the way there.
    const bool saved = stage_.capture(watch_, camera_, frame()).saveToFile(name);
    const std::string path = std::filesystem::absolute(name).string();
    stage_.overlay().notice(saved ? "Saved " + path : "Could not write " + path, now_);
}

} // namespace evod::viewer
