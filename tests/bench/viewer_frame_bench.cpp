// What one drawn frame costs the drawing thread: `xvfb-run viewer_frame_bench`.
//
// Where OpenGL is done in software, most of it is that.
#include "client/viewer/shell/window.h"
#include "client/viewer/stage/stage.h"

#include <SFML/Window/Context.hpp>
#include <benchmark/benchmark.h>

#include <cmath>
#include <cstdint>
#include <memory>

namespace evod::viewer {
namespace {

constexpr double px2_per_organism = 46'080; // and 2.5 food and 1.5 poison each: the benchmark world

wire::ItemPicture items(std::size_t count, double width, double step) {
    wire::ItemPicture all;
    for (std::size_t i = 0; i < count; ++i) {
        all.id.push_back(static_cast<std::uint32_t>(i));
        all.x_px.push_back(static_cast<float>(std::fmod(static_cast<double>(i) * step, width)));
        all.y_px.push_back(static_cast<float>(std::fmod(static_cast<double>(i) * step * 1.618, width)));
    }
    return all;
}

std::shared_ptr<const wire::Picture> picture(std::size_t organism_count, std::uint64_t tick) {
    auto made = std::make_shared<wire::Picture>();
    const double width = std::sqrt(static_cast<double>(organism_count) * px2_per_organism);
    made->about.set_width_px(width);
    made->about.set_height_px(width);
    made->about.set_item_radius_px(4);
    made->about.set_tick(tick);
    made->about.set_simulated_s(static_cast<double>(tick) / 60);
    made->food = items(organism_count * 5 / 2, width, 311.7);
    made->poison = items(organism_count * 3 / 2, width, 173.3);
    const auto places = items(organism_count, width, 97.1 + 0.0001 * static_cast<double>(tick));
    made->organisms = {places.id, places.x_px, places.y_px, std::vector<float>(organism_count, 10.f),
                       std::vector<float>(organism_count, 87.f)};
    return made;
}

/// Where no server is.
link::Options nobody() {
    link::Options options;
    options.server = {.host = "127.0.0.1", .port = 1};
    return options;
}

/// Range 0: organisms; range 1: how many times larger than fitted.
void draw_frame(benchmark::State& state) {
    const auto organism_count = static_cast<std::size_t>(state.range(0));
    const sf::Context context{context_settings(), 1280, 720};
    Stage stage;
    Options options;
    options.connection = nobody();
    Panes panes{wanted_of(options)};
    Pane& pane = panes.focused();
    const auto start = link::WorldView::Clock::now();
    const auto first = picture(organism_count, 0), second = picture(organism_count, 2);
    constexpr std::chrono::milliseconds between{33};
    pane.watch.view().add(first, start);
    pane.watch.view().add(second, start + between);
    Stage::Frame frame{.width_pixels = 1280, .height_pixels = 720, .now = start + between, .glide = true};
    stage.draw(panes, frame);
    pane.camera().zoom_at(pane.camera().viewport().centre(), static_cast<double>(state.range(1)));
    for (auto _ : state) {
        frame.pointed_at = Point{640, 360};
        frame.now += std::chrono::milliseconds{3}; // from one picture to the next, again and again
        frame.now = frame.now > start + 2 * between ? start + between : frame.now;
        stage.draw(panes, frame);
    }
}
BENCHMARK(draw_frame)
    ->ArgNames({"organisms", "zoom"})
    ->ArgsProduct({{50, 10'000, 100'000}, {1, 16}})
    ->Unit(benchmark::kMicrosecond);

} // namespace
} // namespace evod::viewer
