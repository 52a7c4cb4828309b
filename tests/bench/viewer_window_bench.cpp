// How soon and how often evoview draws in a real window: `under_xvfb.sh viewer_window_bench [OPTIONS OF EVOVIEW]`.
//
// It connects to a running server, draws as evoview does, and prints one JSON object:
//   first_frame_ms    from the begin of the connection until the first frame with a snapshot was shown; the window is
//                     open before
//   frames_per_s      frames shown during the following 10 s; evoview shows at most 67
//   frame_ms          median of the time for one frame without the wait for the next one
//   snapshots_per_s   new snapshots drawn in that time
// The numbers include the work of OpenGL, which is in software under Xvfb. Start the server before.
#include "client/viewer/shell/options.h"
#include "client/viewer/shell/screen.h"

#include <GL/gl.h>
#include <SFML/Window/Event.hpp>

#include <algorithm>
#include <chrono>
#include <iostream>
#include <thread>
#include <variant>
#include <vector>

namespace evod::viewer {
namespace {

using Clock = Screen::Clock;
constexpr std::chrono::seconds measured{10}, patience{60};

double ms_between(Clock::time_point from, Clock::time_point to) {
    return std::chrono::duration<double, std::milli>{to - from}.count();
}

class Bench {
  public:
    explicit Bench(const Options& options)
        : screen_{options}, started_{Clock::now()}, view_{wanted_of(options), view_of(options)} {}

    int run() {
        while (view_.world.feed.snapshot() == nullptr) {
            show_frame();
            if (Clock::now() > started_ + patience) {
                std::cerr << "viewer_window_bench: no snapshot has arrived\n";
                return 1;
            }
        }
        const double first_frame_ms = ms_between(started_, drawn_);
        const auto begin = Clock::now(), end = begin + measured;
        std::vector<double> frames_ms;
        std::size_t snapshot_count = 0;
        while (Clock::now() < end) {
            const auto before = view_.world.feed.view().latest();
            frames_ms.push_back(show_frame());
            snapshot_count += view_.world.feed.view().latest() != before;
        }
        const double seconds = ms_between(begin, Clock::now()) / 1e3;
        std::ranges::sort(frames_ms);
        std::cout << "{\"first_frame_ms\": " << first_frame_ms
                  << ", \"frames_per_s\": " << static_cast<double>(frames_ms.size()) / seconds
                  << ", \"frame_ms\": " << frames_ms[frames_ms.size() / 2]
                  << ", \"snapshots_per_s\": " << static_cast<double>(snapshot_count) / seconds << "}\n";
        return 0;
    }

  private:
    /// Returns the duration in ms, without the wait for the next frame.
    double show_frame() {
        const auto now = Clock::now();
        for (sf::Event event; screen_.poll(event);) {
        }
        view_.world.update(now);
        WindowRenderer::Frame frame = screen_.frame(now);
        frame.interpolate = true;
        screen_.renderer().draw(view_, frame);
        screen_.window().display();
        glFinish();
        drawn_ = Clock::now();
        std::this_thread::sleep_until(now + Screen::frame_min);
        return ms_between(now, drawn_);
    }

    Screen screen_;
    Clock::time_point started_, drawn_;
    WorldView view_;
};

} // namespace
} // namespace evod::viewer

int main(int argc, char** argv) {
    const auto parsed = evod::viewer::parse_options(argc, argv);
    const auto* options = std::get_if<evod::viewer::Options>(&parsed);
    return options != nullptr ? evod::viewer::Bench{*options}.run() : std::get<int>(parsed);
}
