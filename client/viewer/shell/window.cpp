#include "client/viewer/shell/window.h"

#include "client/viewer/drawing/png.h"

#include <chrono>
#include <filesystem>
#include <stdexcept>

namespace evod::viewer {

namespace {

void toggle(bool& shown) {
    shown = !shown;
}

} // namespace

Window::Window(Screen& screen, const Options& options)
    : screen_{screen}, window_{screen.window()}, stage_{screen.stage()}, panes_{wanted_of(options), options.beside} {}

Window::Ending Window::run(bool must_connect, const std::function<void()>& connected) {
    using Clock = core::WorldView::Clock;
    now_ = Clock::now();
    bool was_connected = false;
    while (window_.isOpen() && !elsewhere_) {
        const double seconds = std::chrono::duration<double>{Clock::now() - now_}.count();
        now_ = Clock::now();
        handle_events();
        input_.move(panes_.focused().camera(), seconds);
        panes_.link_cameras(panes_.focused().camera());
        panes_.update(now_);
        if (!was_connected) {
            was_connected = panes_[0].watch.connection_status().connected_count > 0;
            if (was_connected) {
                connected();
            } else if (std::string why = panes_[0].watch.no_connection(); must_connect && !why.empty()) {
                return {.elsewhere = true, .reason = std::move(why)};
            }
        }
        for (std::size_t i = 0; i < panes_.size(); ++i) {
            for (std::string& notice : panes_[i].watch.take_notices()) {
                stage_.overlay().notice(std::move(notice), now_);
            }
        }
        Stage::Frame next = screen_.frame(now_);
        next.glide = true;
        next.pointed_at = stage_.gui().captured().mouse ? std::nullopt : input_.pointed_at();
        screen_.show(&panes_.focused().watch, next, [&] { stage_.draw(panes_, next); });
    }
    return {.elsewhere = elsewhere_ && window_.isOpen(), .reason = ""};
}

void Window::handle_events() {
    for (sf::Event event; screen_.poll(event);) {
        const Captured captured = stage_.captured(event);
        if (event.type == sf::Event::MouseButtonPressed && !captured.mouse) {
            panes_.focus_at({double(event.mouseButton.x), double(event.mouseButton.y)});
        }
        Camera& camera = event.type == sf::Event::MouseWheelScrolled
                             ? panes_.camera_at({double(event.mouseWheelScroll.x), double(event.mouseWheelScroll.y)})
                             : panes_.focused().camera();
        const auto action = input_.handle(event, captured, camera);
        panes_.link_cameras(camera);
        if (action) {
            carry_out(*action);
        }
        if (const auto click = input_.take_click()) {
            stage_.select_at(panes_.focused(), *click);
        }
    }
}

void Window::carry_out(Action action) {
    if (const auto panel = panel_of(action)) {
        return stage_.panels().toggle(*panel);
    }
    Watch& watch = panes_.focused().watch;
    Sight& sight = panes_.focused().sight;
    switch (action) {
    case Action::PauseOrResume:
        return watch.pause_or_resume();
    case Action::StepOne:
        return watch.step(1);
    case Action::StepMany:
        return watch.step(step_many_ticks);
    case Action::Faster:
        return watch.faster();
    case Action::Slower:
        return watch.slower();
    case Action::RealTime:
        return watch.real_time();
    case Action::MaxSpeed:
        return watch.max_speed();
    case Action::NextIsland:
        return watch.turn_islands(1);
    case Action::PreviousIsland:
        return watch.turn_islands(-1);
    case Action::NextWorld:
        return watch.next_world();
    case Action::PastOrPresent:
        return look_at_past_or_present();
    case Action::PreviousGeneration:
        return watch.turn_generations(-1);
    case Action::NextGeneration:
        return watch.turn_generations(1);
    case Action::Beside:
        return panes_.toggle_beside();
    case Action::OtherHalf:
        return panes_.focus_next();
    case Action::LinkCameras:
        return panes_.toggle_linked();
    case Action::AllIslands:
        return watch.show_all_islands(!watch.all_islands());
    case Action::Fit:
        return panes_.focused().camera().fit();
    case Action::NextColouring:
        return sight.next_colouring();
    case Action::Radii:
        return toggle(sight.shown.radii);
    case Action::Forces:
        return toggle(sight.shown.forces);
    case Action::Trails:
        return toggle(sight.shown.trails);
    case Action::Follow:
        return sight.toggle_following(watch);
    case Action::Screenshot:
        return save_screenshot();
    case Action::Help:
        return stage_.overlay().toggle_help();
    case Action::Start:
        elsewhere_ = true;
        return;
    case Action::Close:
        return close_front();
    case Action::Quit:
        return window_.close();
    case Action::FirstPanel: // a panel: above
        break;
    }
}

void Window::close_front() {
    if (stage_.gui().close_popup()) {
        return;
    }
    if (stage_.overlay().help()) {
        stage_.overlay().toggle_help();
    } else if (stage_.panels().close_front()) {
        return;
    } else if (now_ < asked_to_quit_ + Overlay::notice_shown) {
        window_.close();
    } else { // who presses it once too often wants to see the island
        asked_to_quit_ = now_;
        stage_.overlay().notice("Esc again quits; the worlds run on", now_);
    }
}

void Window::look_at_past_or_present() {
    Watch& watch = panes_.focused().watch;
    if (watch.opened_past()) {
        return watch.return_to_present();
    }
    if (watch.replay() != nullptr) {
        return stage_.overlay().notice("A run file is replayed: it has no present", now_);
    }
    evod::v1::RunMoment now;
    if (const codec::DecodedSnapshot* picture = watch.picture()) {
        now.set_tick(picture->about.tick());
    }
    watch.open_replay(std::move(now));
}

void Window::save_screenshot() {
    const Watch& watch = panes_.focused().watch;
    std::string name = "evoview";
    if (const codec::DecodedSnapshot* picture = watch.picture()) {
        name += "-" + picture->about.world() + "-island-" + std::to_string(picture->about.island()) + "-tick-" +
                std::to_string(picture->about.tick());
    }
    name += ".png";
    const std::string path = std::filesystem::absolute(name).string();
    try {
        // Latest positions, as the tick in the name says, and not those on the way there.
        write_file(path, png_of(stage_.capture(panes_, screen_.frame(now_))));
        stage_.overlay().notice("Saved " + path, now_);
    } catch (const std::runtime_error& error) {
        stage_.overlay().notice(error.what(), now_);
    }
}

} // namespace evod::viewer
