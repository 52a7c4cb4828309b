// Latencies of evoview with a real evod and a real window: `under_xvfb.sh viewer_latency_bench [ORGANISMS…]`.
//
// first      from the start of the connection to the server until the first frame with the world is on the screen; the
//            time includes the connection, the Hello and the subscription
// step       from a client's command to a paused world until the frame of that one tick is on the screen
// running    from a tick of a world at 1 or 10 times real time until the first frame with its snapshot is on the
//            screen; and until the interpolated organisms have reached the snapshot's positions
// slider     from a slider's release until the server's event that the parameter is set, at real time; and the round
//            trip of a request
//
// The time of tick n is n / rate after the time of tick 0. Each answer to a query of the tick gives an upper bound for
// the time of tick 0; the benchmark uses the least of many. A frame is on the screen when display() has returned.
#include "client/core/connection.h"
#include "client/viewer/panels/parameters_panel.h"
#include "client/viewer/shell/screen.h"
#include "client/viewer/view/world_view.h"
#include "tests/system/viewer/support/processes.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <functional>
#include <mutex>
#include <random>
#include <stdexcept>
#include <thread>
#include <vector>

namespace evod::viewer {
namespace {

using Clock = core::SnapshotInterpolator::Clock;
using Ms = std::chrono::duration<double, std::milli>;

constexpr std::chrono::milliseconds frame_min{15}; // as in Screen
constexpr double ticks_per_s = 60;                 // at real time
constexpr const char* turned = "mutation_chance";

void print(const std::string& what, std::vector<double> ms) {
    if (ms.empty()) {
        std::printf("%-52s nothing was measured\n", what.c_str());
        return;
    }
    std::ranges::sort(ms);
    const auto at = [&](double share) { return ms[static_cast<std::size_t>(share * double(ms.size() - 1))]; };
    std::printf("%-52s median %6.1f, 99 of 100 %6.1f, least %6.1f, most %6.1f ms; %zu times\n", what.c_str(), at(0.5),
                at(0.99), ms.front(), ms.back(), ms.size());
    std::fflush(stdout);
}

/// The density of the benchmark world.
void make_benchmark_world(RealServer& server, const std::string& name, std::uint32_t organism_count) {
    const double area_px2 = organism_count * 46'080.0;
    server.make_world({.name = name,
                       .parameters = {{"population_size", count(organism_count)},
                                      {"food_count", count(organism_count * 3)},
                                      {"poison_count", count(organism_count * 2)},
                                      {"island_width_px", real(std::sqrt(area_px2 * 16 / 9))},
                                      {"island_height_px", real(std::sqrt(area_px2 * 9 / 16))}}});
}

class Viewer {
  public:
    Viewer(const std::string& server, const std::string& world) {
        options_.connection.server = core::parse_endpoint(server).value();
        options_.world = world;
        screen_.emplace(options_);
        view_.emplace(wanted_of(options_));
    }

    /// Connects again, as at the start of evoview. Returns when the connection was begun.
    Clock::time_point connect() {
        view_.reset();
        const auto begun = Clock::now();
        view_.emplace(wanted_of(options_));
        return begun;
    }

    /// One iteration of the window's loop. `meanwhile` is called at a uniformly random time in it.
    ///
    /// returns  when the frame was on the screen
    Clock::time_point frame(const std::function<void()>& meanwhile = {}) {
        const auto now = Clock::now();
        for (sf::Event event; screen_->poll(event);) {
        }
        view_->world.update(now);
        WindowRenderer::Frame next = screen_->frame(now);
        next.interpolate = true;
        screen_->renderer().draw(*view_, next);
        screen_->window().display();
        const auto shown = Clock::now();
        if (meanwhile) {
            std::this_thread::sleep_until(
                now + std::uniform_int_distribution{0, 15'000}(chance_)*std::chrono::microseconds{1});
            meanwhile();
        }
        std::this_thread::sleep_until(now + frame_min);
        return shown;
    }
    /// Draws frames until the condition holds. Returns when the first such frame was on the screen.
    template <class Condition>
    Clock::time_point frames_until(Condition condition) {
        const auto end = Clock::now() + std::chrono::seconds{60};
        while (Clock::now() < end) {
            if (const auto shown = frame(); condition()) {
                return shown;
            }
        }
        throw std::runtime_error{"it never came to that"};
    }

    ViewedWorld& world() { return view_->world; }
    std::uint64_t tick() { return world().feed.snapshot() != nullptr ? world().feed.snapshot()->about.tick() : 0; }
    WindowRenderer& renderer() { return screen_->renderer(); }

    void mouse(sf::Event::EventType type, Point at) {
        sf::Event event{};
        event.type = type;
        if (type == sf::Event::MouseMoved) {
            event.mouseMove = {static_cast<int>(at.x), static_cast<int>(at.y)};
        } else {
            event.mouseButton = {sf::Mouse::Left, static_cast<int>(at.x), static_cast<int>(at.y)};
        }
        renderer().gui().handle(event);
    }
    Point find(const std::string& widget) {
        frames_until([&] { return !renderer().gui().widget_positions().find(widget).empty(); });
        return renderer().gui().widget_positions().find(widget).front()->centre();
    }
    void click(const std::string& widget) {
        const Point at = find(widget);
        for (const auto type : {sf::Event::MouseMoved, sf::Event::MouseButtonPressed, sf::Event::MouseButtonReleased}) {
            mouse(type, at);
            frame();
        }
    }

  private:
    Options options_;
    std::optional<Screen> screen_;
    std::optional<WorldView> view_;
    std::minstd_rand chance_{1};
};

evod::v1::Request at_speed(const std::string& world, double factor) {
    evod::v1::Request request;
    request.mutable_set_speed()->set_world(world);
    request.mutable_set_speed()->mutable_speed()->set_real_time_factor(factor);
    return request;
}

void measure_first_frame(Viewer& viewer, const std::string& world) {
    std::vector<double> ms;
    for (int i = 0; i < 50; ++i) {
        const auto begun = viewer.connect();
        ms.push_back(
            Ms{viewer.frames_until([&] { return viewer.world().feed.snapshot() != nullptr; }) - begun}.count());
    }
    print(world + ", first frame", ms);
}

void measure_steps(RealServer& server, Viewer& viewer, const std::string& world) {
    std::vector<double> ms;
    for (int i = 0; i < 200; ++i) {
        const std::uint64_t tick = viewer.tick() + 1;
        evod::v1::Request step;
        step.mutable_run_until_tick()->set_world(world);
        step.mutable_run_until_tick()->set_tick(tick);
        Clock::time_point sent;
        viewer.frame([&] {
            sent = Clock::now();
            server.connection->send(step, [](const auto&) {});
        });
        ms.push_back(Ms{viewer.frames_until([&] { return viewer.tick() >= tick; }) - sent}.count());
    }
    print(world + ", step", ms);
}

/// The times of the ticks of a running world, estimated from its answers.
class TickClock {
  public:
    TickClock(RealServer& server, const std::string& world, double rate_hz) : server_{server}, rate_hz_{rate_hz} {
        question_.mutable_get_statistics()->set_world(world);
    }
    void ask() {
        server_.connection->send(question_, [this](const core::Result<evod::v1::Response>& response) {
            if (response && response->has_statistics()) {
                const std::lock_guard lock{mutex_};
                const auto now = Clock::now();
                begins_.emplace_back(now, now - since_begin(response->statistics().world().tick()));
            }
        });
    }
    /// Uses the answers within half a second, because a world may be delayed.
    Clock::time_point when(std::uint64_t tick, Clock::time_point shown) {
        const std::lock_guard lock{mutex_};
        auto begin = Clock::time_point::max();
        for (const auto& [heard, latest] : begins_) {
            if (std::chrono::abs(heard - shown) < std::chrono::milliseconds{500}) {
                begin = std::min(begin, latest);
            }
        }
        return begin + since_begin(tick);
    }

  private:
    Clock::duration since_begin(std::uint64_t tick) const {
        return std::chrono::duration_cast<Clock::duration>(
            std::chrono::duration<double>{static_cast<double>(tick) / rate_hz_});
    }
    RealServer& server_;
    double rate_hz_;
    evod::v1::Request question_;
    std::mutex mutex_;
    // Of each answer: its arrival, and its upper bound for the time of tick 0.
    std::vector<std::pair<Clock::time_point, Clock::time_point>> begins_;
};

void measure_running(RealServer& server, Viewer& viewer, const std::string& world, double factor) {
    server.ask(at_speed(world, factor));
    evod::v1::Request run, pause;
    run.mutable_run()->set_world(world);
    pause.mutable_pause()->set_world(world);
    server.ask(run);
    TickClock clock{server, world, ticks_per_s * factor};
    struct Shown {
        std::uint64_t tick;
        Clock::time_point first, reached;
    };
    std::vector<Shown> all;
    bool slowed = false;
    const auto begin = Clock::now();
    while (Clock::now() < begin + std::chrono::seconds{20}) {
        const auto shown = viewer.frame([&] { clock.ask(); });
        const bool newer = all.empty() || viewer.tick() != all.back().tick;
        if (!all.empty() && all.back().reached == Clock::time_point{} &&
            (newer || viewer.world().feed.view().blend_at(shown) >= 1)) {
            all.back().reached = shown;
        }
        if (newer) {
            all.push_back({viewer.tick(), shown, {}});
        }
        slowed = slowed || viewer.world().feed.control().info().slowed();
    }
    server.ask(pause);
    viewer.frames_until([&] { return viewer.world().feed.control().state() == evod::v1::RUN_STATE_PAUSED; });
    std::vector<double> first, reached;
    for (const Shown& shown : all) {
        if (shown.first > begin + std::chrono::seconds{2} && shown.reached != Clock::time_point{}) {
            const auto when = clock.when(shown.tick, shown.first);
            first.push_back(Ms{shown.first - when}.count());
            reached.push_back(Ms{shown.reached - when}.count());
        }
    }
    const std::string name = world + ", " + std::to_string(static_cast<int>(factor)) + " × real time";
    print(name + (slowed ? ", slowed: first frame" : ": first frame"), first);
    print(name + ": all organisms at their positions", reached);
}

void measure_slider(RealServer& server, Viewer& viewer, const std::string& world) {
    server.ask(at_speed(world, 1));
    evod::v1::Request run, pause, style;
    run.mutable_run()->set_world(world);
    pause.mutable_pause()->set_world(world);
    style.mutable_get_parameters()->set_world(world);
    server.ask(run);
    std::vector<double> round_trips;
    for (int i = 0; i < 200; ++i) {
        const auto sent = Clock::now();
        server.ask(style);
        round_trips.push_back(Ms{Clock::now() - sent}.count());
    }
    viewer.renderer().panels().show("Parameters");
    viewer.click("apply at once");
    viewer.click("Search");
    for (const char sign : std::string{turned}) {
        sf::Event event{};
        event.type = sf::Event::TextEntered;
        event.text.unicode = static_cast<sf::Uint32>(sign);
        viewer.renderer().gui().handle(event);
        viewer.frame();
    }
    evod::v1::SubscribeEvents subscription;
    subscription.set_world(world);
    const auto events = server.connection->subscribe(subscription);
    server.connection->wait_subscribed(events).value();
    std::vector<double> ms;
    for (int i = 0; i < 100; ++i) {
        Point at = viewer.find(turned);
        viewer.mouse(sf::Event::MouseMoved, at);
        viewer.frame();
        viewer.mouse(sf::Event::MouseButtonPressed, at);
        viewer.frame();
        at.x += i % 2 == 0 ? 30 : -30; // always another value
        viewer.mouse(sf::Event::MouseMoved, at);
        viewer.frame();
        server.connection->take_events();
        Clock::time_point released, holds;
        std::thread listener{[&] {
            while (const auto event = server.connection->wait_event(std::chrono::seconds{20})) {
                if (event->has_parameters_changed()) {
                    holds = Clock::now();
                    return;
                }
            }
        }};
        viewer.frame([&] {
            released = Clock::now();
            viewer.mouse(sf::Event::MouseButtonReleased, at);
        });
        for (int frame = 0; frame < 10; ++frame) {
            viewer.frame();
        }
        listener.join();
        if (holds == Clock::time_point{}) {
            throw std::runtime_error{"the parameter was never changed"};
        }
        ms.push_back(Ms{holds - released}.count());
    }
    server.ask(pause);
    print(world + ", slider", ms);
    print(world + ", round trip", round_trips);
}

void measure(std::uint32_t organism_count) {
    RealServer server{{}};
    const std::string world = std::to_string(organism_count);
    make_benchmark_world(server, world, organism_count);
    Viewer viewer{server.address(), world};
    viewer.frames_until([&] { return viewer.world().feed.snapshot() != nullptr; });
    measure_first_frame(viewer, world);
    measure_steps(server, viewer, world);
    measure_running(server, viewer, world, 1);
    measure_running(server, viewer, world, 10);
    measure_slider(server, viewer, world);
}

} // namespace
} // namespace evod::viewer

int main(int argc, char** argv) {
    std::vector<std::string> organisms{argv + 1, argv + argc};
    try {
        for (const std::string& count : organisms.empty() ? std::vector<std::string>{"50", "10000"} : organisms) {
            evod::viewer::measure(static_cast<std::uint32_t>(std::stoul(count)));
        }
    } catch (const std::exception& error) {
        std::fprintf(stderr, "viewer_latency_bench: %s\n", error.what());
        return 1;
    }
    return 0;
}
