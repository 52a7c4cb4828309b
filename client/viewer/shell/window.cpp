#include "client/viewer/shell/window.h"

#include "client/viewer/drawing/png.h"
#include "client/viewer/panels/page_panels.h"

#include <SFML/Window/Clipboard.hpp>

#include <chrono>
#include <filesystem>
#include <stdexcept>
#include <utility>

namespace evod::viewer {

namespace {

/// Returns whether the event is a pressed key or a typed character. Ctrl, Shift and Alt alone do not count.
bool is_key(const sf::Event& event) {
    using Key = sf::Keyboard;
    return event.type == sf::Event::TextEntered ||
           (event.type == sf::Event::KeyPressed && (event.key.code < Key::LControl || event.key.code > Key::RSystem));
}

/// Explains why a key has no effect.
std::string unused_key_text(const sf::Event& event, std::string_view link) {
    using Key = sf::Keyboard;
    const bool of_two_worlds = event.type == sf::Event::KeyPressed &&
                               (event.key.code == Key::B || event.key.code == Key::X || event.key.code == Key::K);
    return of_two_worlds ? "two worlds side by side are in the browser page: " + way_to_page(link)
                         : "this key has no effect";
}

void toggle(bool& shown) {
    shown = !shown;
}

} // namespace

Window::Window(Screen& screen, const Options& options)
    : screen_{screen}
    , window_{screen.window()}
    , renderer_{screen.renderer()}
    , view_{wanted_of(options), view_of(options)} {}

void Window::run() {
    using Clock = core::SnapshotInterpolator::Clock;
    now_ = Clock::now();
    while (window_.isOpen()) {
        const double seconds = std::chrono::duration<double>{Clock::now() - now_}.count();
        now_ = Clock::now();
        handle_events();
        input_.move(view_.camera(), seconds);
        view_.world.update(now_);
        for (std::string& notice : view_.world.server.take_notices()) {
            renderer_.overlay().notice(std::move(notice), now_);
        }
        WindowRenderer::Frame next = screen_.frame(now_);
        next.interpolate = true;
        next.pointed_at = renderer_.gui().captured().mouse ? std::nullopt : input_.pointed_at();
        screen_.show(view_, next);
    }
}

void Window::handle_events() {
    for (sf::Event event; screen_.poll(event);) {
        const Captured captured = renderer_.gui().captured();
        if (event.type == sf::Event::MouseButtonPressed && !captured.mouse) {
            const Point place{double(event.mouseButton.x), double(event.mouseButton.y)};
            view_.choose_island_at(place);
            // A running organism moves on before the button is released.
            pressed_organism_ = renderer_.organism_drawn_at(view_, place);
        }
        Camera& camera = event.type == sf::Event::MouseWheelScrolled
                             ? view_.camera_at({double(event.mouseWheelScroll.x), double(event.mouseWheelScroll.y)})
                             : view_.camera();
        const auto action = input_.handle(event, captured, camera);
        const std::string problem = action ? problem_of(*action) : "";
        if (action && problem.empty()) {
            carry_out(*action);
        } else if (action) {
            renderer_.overlay().notice(problem, now_);
        }
        if (is_key(event)) {
            const bool used = action || captured.keyboard || Input::moves_camera(event);
            screen_.report_key(used ? problem : unused_key_text(event, view_.world.live_link()));
        }
        if (const auto click = input_.take_click()) {
            renderer_.select(view_, pressed_organism_);
        }
    }
}

std::string Window::problem_of(Action action) {
    ViewedWorld& world = view_.world;
    if (const auto key = panel_key_of(action)) {
        return renderer_.panels().panel_at(*key) ? "" : where_in_page(page_panel_at(*key), world.live_link());
    }
    switch (action) {
    case Action::PauseOrResume:
    case Action::StepOne:
    case Action::StepMany:
    case Action::Faster:
    case Action::Slower:
    case Action::RealTime:
    case Action::MaxSpeed:
        return std::string{world.commands.read_only_reason()};
    case Action::NextIsland:
    case Action::PreviousIsland:
    case Action::AllIslands:
        return world.feed.island_count() > 1 ? "" : "There is only one island";
    case Action::PreviousGeneration:
    case Action::NextGeneration:
        return world.replay.info() != nullptr ? "" : "Only a replay has a time line: press P to open one";
    case Action::Follow:
        return world.feed.selected() ? "" : "Select an organism first: click it";
    default:
        return "";
    }
}

void Window::carry_out(Action action) {
    if (const auto key = panel_key_of(action)) {
        return renderer_.panels().show(*renderer_.panels().panel_at(*key));
    }
    ViewedWorld& world = view_.world;
    IslandView& island_view = view_.island_view;
    switch (action) {
    case Action::PauseOrResume:
        return world.commands.pause_or_resume();
    case Action::StepOne:
        return world.commands.step(1);
    case Action::StepMany:
        return world.commands.step(step_many_ticks);
    case Action::Faster:
        return world.commands.faster();
    case Action::Slower:
        return world.commands.slower();
    case Action::RealTime:
        return world.commands.real_time();
    case Action::MaxSpeed:
        return world.commands.max_speed();
    case Action::NextIsland:
        return world.feed.cycle_island(1);
    case Action::PreviousIsland:
        return world.feed.cycle_island(-1);
    case Action::NextWorld:
        return world.show_next_world();
    case Action::ReplayOrLive:
        return world.toggle_replay();
    case Action::PreviousGeneration:
        return world.replay.seek_generations(-1);
    case Action::NextGeneration:
        return world.replay.seek_generations(1);
    case Action::AllIslands:
        return world.feed.show_all_islands(!world.feed.all_islands());
    case Action::Fit:
        return view_.camera().fit();
    case Action::NextColouring:
        return island_view.next_colouring();
    case Action::Radii:
        island_view.options.radii = next(island_view.options.radii);
        return;
    case Action::Forces:
        island_view.options.forces = next(island_view.options.forces);
        return;
    case Action::Trails:
        return toggle(island_view.options.trails);
    case Action::Follow:
        return view_.island_data.toggle_following(world.feed);
    case Action::Screenshot:
        return save_screenshot();
    case Action::CopyLink:
        return copy_link();
    case Action::Sidebar:
        return renderer_.panels().toggle_sidebar();
    case Action::Help:
        return renderer_.overlay().toggle_help();
    case Action::Close:
        return close_front();
    case Action::Quit:
        return window_.close();
    case Action::FirstPanel: // handled before the switch
        break;
    }
}

void Window::close_front() {
    if (renderer_.gui().close_popup()) {
        return;
    }
    if (renderer_.overlay().help()) {
        renderer_.overlay().toggle_help();
    } else if (now_ < asked_to_quit_ + Overlay::notice_shown) {
        window_.close();
    } else { // the user may have pressed Esc once too often
        asked_to_quit_ = now_;
        renderer_.overlay().notice("Esc again quits; the worlds continue", now_);
    }
}

void Window::copy_link() {
    const std::string link = view_.world.link();
    if (link.empty()) {
        renderer_.overlay().notice("No link: start evod with --web, so that it serves the page for browsers", now_);
        return;
    }
    sf::Clipboard::setString(link);
    renderer_.overlay().notice("Copied " + link, now_);
}

void Window::save_screenshot() {
    const ViewedWorld& world = view_.world;
    std::string name = "evoview";
    if (const codec::ReceivedSnapshot* snapshot = world.feed.snapshot()) {
        name += "-" + snapshot->about.world() + "-island-" + std::to_string(snapshot->about.island()) + "-tick-" +
                std::to_string(snapshot->about.tick());
    }
    name += ".png";
    const std::string path = std::filesystem::absolute(name).string();
    try {
        // Draw without interpolation, so that the positions are those of the tick in the file name.
        write_file(path, png_of(renderer_.capture(view_, screen_.frame(now_))));
        renderer_.overlay().notice("Saved " + path, now_);
    } catch (const std::runtime_error& error) {
        renderer_.overlay().notice(error.what(), now_);
    }
}

} // namespace evod::viewer
