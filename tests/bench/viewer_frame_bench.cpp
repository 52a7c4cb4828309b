// The processor time of the drawing thread per frame: `under_xvfb.sh viewer_frame_bench`.
//
// With OpenGL in software, the driver takes most of the time. With driver:0 the calls that upload and draw shapes do
// nothing: the linker redirects them to this file. Calls of Dear ImGui are not redirected, so the rest is the viewer's
// own time and a little more.
#include "client/viewer/shell/screen.h"
#include "client/viewer/view/window_renderer.h"

#include <GL/gl.h>
#include <GL/glext.h>
#include <SFML/Window/Context.hpp>
#include <benchmark/benchmark.h>

#include <array>
#include <cmath>
#include <cstdint>
#include <memory>

namespace {
bool driver_works = true;
}
// The viewer's calls as redirected by the linker's --wrap, and the wrapped functions.
extern "C" {
void __real_glBufferData(GLenum target, GLsizeiptr size, const void* data, GLenum usage);
void __real_glClear(GLbitfield mask);
void __real_glDrawArrays(GLenum mode, GLint first, GLsizei count);
void __wrap_glBufferData(GLenum target, GLsizeiptr size, const void* data, GLenum usage) {
    if (driver_works) {
        __real_glBufferData(target, size, data, usage);
    }
}
void __wrap_glClear(GLbitfield mask) {
    if (driver_works) {
        __real_glClear(mask);
    }
}
void __wrap_glDrawArrays(GLenum mode, GLint first, GLsizei count) {
    if (driver_works) {
        __real_glDrawArrays(mode, first, count);
    }
}
}

namespace evod::viewer {
namespace {

constexpr double px2_per_organism = 46'080; // and 2.5 food and 1.5 poison each: the benchmark world
constexpr std::chrono::milliseconds snapshot_interval{33};

codec::Entities items(std::size_t count, double width, double step) {
    codec::Entities all;
    const auto steps = [&](double px) { return codec::steps_of(static_cast<float>(std::fmod(px, width))); };
    for (std::size_t i = 0; i < count; ++i) {
        all.id.push_back(static_cast<std::uint32_t>(i));
        all.x.push_back(steps(static_cast<double>(i) * step));
        all.y.push_back(steps(static_cast<double>(i) * step * 1.618));
    }
    return all;
}

std::shared_ptr<codec::ReceivedSnapshot> snapshot_at(std::size_t organism_count, std::uint64_t tick) {
    auto made = std::make_shared<codec::ReceivedSnapshot>();
    const double width = std::sqrt(static_cast<double>(organism_count) * px2_per_organism);
    made->about.set_width_px(width);
    made->about.set_height_px(width);
    made->about.set_item_radius_px(4);
    made->about.set_tick(tick);
    made->about.set_simulated_s(static_cast<double>(tick) / 60);
    codec::QuantisedSnapshot entities;
    entities.food = items(organism_count * 5 / 2, width, 311.7);
    entities.poison = items(organism_count * 3 / 2, width, 173.3);
    entities.organisms = items(organism_count, width, 97.1 + 0.0001 * static_cast<double>(tick));
    entities.organisms.width.assign(organism_count, codec::steps_of(10));
    entities.organisms.height.assign(organism_count, codec::steps_of(87));
    made->entities = std::make_shared<const codec::QuantisedSnapshot>(std::move(entities));
    return made;
}

/// An address without a server.
core::Options no_server() {
    core::Options options;
    options.server = {.host = "127.0.0.1", .port = 1};
    return options;
}

/// Range 0: organisms; range 1: whether the skin is vivid or classic; range 2: zoom relative to the fitted island;
/// range 3: whether each frame shows a new snapshot (at 60 frames and 30 snapshots per second every second one does) or
/// interpolates between two; range 4: whether the driver's calls are made.
void draw_frame(benchmark::State& state) {
    const auto organism_count = static_cast<std::size_t>(state.range(0));
    const bool new_snapshot = state.range(3) != 0;
    const sf::Context context{context_settings(), 1280, 720};
    WindowRenderer renderer;
    Options options;
    options.connection = no_server();
    const Look look{state.range(1) != 0 ? Skin::Vivid : Skin::Classic};
    WorldView view{wanted_of(options), default_options(look)};
    auto now = core::SnapshotInterpolator::Clock::now();
    std::uint64_t tick = 2;
    const std::array snapshots{snapshot_at(organism_count, 0), snapshot_at(organism_count, tick)};
    view.world.feed.view().add(snapshots[0], now);
    view.world.feed.view().add(snapshots[1], now += snapshot_interval);
    const auto arrived = now;
    WindowRenderer::Frame frame{.width_pixels = 1280, .height_pixels = 720, .now = now, .interpolate = true};
    renderer.draw(view, frame);
    view.camera().zoom_at(view.camera().viewport().centre(), static_cast<double>(state.range(2)));
    frame.pointed_at = Point{640, 360};
    renderer.draw(view, frame);
    driver_works = state.range(4) != 0;
    for (auto _ : state) {
        if (new_snapshot) { // the older of the two is reused as the next one
            const auto& next = snapshots[tick / 2 % 2 == 0 ? 1 : 0];
            next->about.set_tick(tick += 2);
            next->about.set_simulated_s(static_cast<double>(tick) / 60);
            view.world.feed.view().add(next, frame.now += snapshot_interval);
        } else {
            frame.now += std::chrono::milliseconds{3}; // interpolates from one snapshot to the next, repeatedly
            frame.now = frame.now > arrived + snapshot_interval ? arrived : frame.now;
        }
        renderer.draw(view, frame);
    }
    driver_works = true;
}
BENCHMARK(draw_frame)
    ->ArgNames({"organisms", "vivid", "zoom", "new_snapshot", "driver"})
    ->ArgsProduct({{50, 10'000, 100'000}, {0, 1}, {1, 16}, {0, 1}, {0, 1}})
    ->Unit(benchmark::kMicrosecond);

} // namespace
} // namespace evod::viewer
