// The processor time per frame outside the graphics driver, by view option: making the shapes of everything that moves.
// Needs no display. All organisms are visible in each frame.
#include "client/viewer/island/marks.h"

#include "tests/unit/viewer/world/population_pages.h"

#include <benchmark/benchmark.h>

#include <cmath>
#include <cstdint>
#include <memory>

namespace evod::viewer {
namespace {

constexpr double px2_per_organism = 46'080;

std::shared_ptr<const codec::ReceivedSnapshot> snapshot(std::size_t count, std::uint64_t tick) {
    auto made = std::make_shared<codec::ReceivedSnapshot>();
    const double width = std::sqrt(static_cast<double>(count) * px2_per_organism);
    made->about.set_width_px(width);
    made->about.set_height_px(width);
    made->about.set_tick(tick);
    made->about.set_generation(1);
    made->about.set_simulated_s(static_cast<double>(tick) / 60);
    codec::QuantisedSnapshot entities;
    codec::Entities& all = entities.organisms;
    const auto steps = [&](double px) { return codec::steps_of(static_cast<float>(std::fmod(px, width))); };
    for (std::size_t i = 0; i < count; ++i) {
        all.id.push_back(static_cast<std::uint32_t>(i));
        all.x.push_back(steps(static_cast<double>(i * 977 + tick) * 1.1));
        all.y.push_back(steps(static_cast<double>(i * 1583 + tick) * 1.7));
    }
    all.width.assign(count, codec::steps_of(10));
    all.height.assign(count, codec::steps_of(87));
    for (std::size_t i = 0; i < count; ++i) {
        all.heading.push_back(static_cast<std::uint32_t>((i * 31 + tick) % codec::heading_steps));
    }
    made->entities = std::make_shared<const codec::QuantisedSnapshot>(std::move(entities));
    return made;
}

struct Setting {
    explicit Setting(std::size_t count) : before{snapshot(count, 0)}, latest{snapshot(count, 15)} {
        const auto start = core::SnapshotInterpolator::Clock::now();
        view.add(before, start);
        view.add(latest, start + std::chrono::milliseconds{33});
        population.add(page_of(0, static_cast<std::uint32_t>(count), static_cast<std::uint32_t>(count), 1, 6));
        camera.set_viewport({0, 0, 1280, 652});
        camera.set_island(latest->about.width_px(), latest->about.height_px());
    }
    std::shared_ptr<const codec::ReceivedSnapshot> before, latest;
    core::SnapshotInterpolator view;
    Population population{6};
    Camera camera;
};

template <class Frame>
void frames(benchmark::State& state, Frame frame) {
    Setting setting{static_cast<std::size_t>(state.range(0))};
    double blend = 0;
    for (auto _ : state) {
        blend = blend > 0.9 ? 0 : blend + 0.1;
        const Positions at = setting.view.organisms_at(blend);
        frame(setting, at);
    }
}

void plain(benchmark::State& state) {
    std::vector<Shape> shapes;
    frames(state, [&](Setting&, const Positions& at) {
        shapes.clear();
        add_discs(at, shapes);
        benchmark::DoNotOptimize(shapes.data());
    });
}

/// The bodies of the vivid skin, with their health.
void bodies(benchmark::State& state) {
    std::vector<Shape> shapes;
    frames(state, [&](Setting& setting, const Positions& at) {
        shapes.clear();
        add_discs(at, shapes);
        set_health(setting.latest->entities->organisms, 100, shapes);
        benchmark::DoNotOptimize(shapes.data());
    });
}

/// Organisms that are steered by networks.
void headings(benchmark::State& state) {
    std::vector<Shape> shapes;
    std::vector<Line> lines;
    frames(state, [&](Setting& setting, const Positions& at) {
        shapes.clear(), lines.clear();
        add_discs(at, shapes);
        add_headings(at, shapes, setting.camera.visible(), 10, lines);
        benchmark::DoNotOptimize(lines.data());
    });
}

/// All options together: coloured by a gene, with radii, forces and trails.
void everything(benchmark::State& state) {
    std::vector<Shape> shapes, rings;
    std::vector<Colour> colours;
    std::vector<Line> ways;
    ColouredLines arrows, targets;
    frames(state, [&](Setting& setting, const Positions& at) {
        const codec::Entities& organisms = setting.latest->entities->organisms;
        const Rectangle seen = setting.camera.visible();
        shapes.clear(), rings.clear(), colours.clear(), ways.clear(), arrows.clear(), targets.clear();
        add_discs(at, shapes);
        add_gene_colours(organisms, setting.population, 3, gene_scale(setting.population, 3, palette::Ramp::Viridis),
                         colours);
        add_radii(organisms, shapes, setting.population, 4, seen, {}, rings);
        add_radii(organisms, shapes, setting.population, 5, seen, {}, rings);
        add_forces(organisms, shapes, setting.population, seen, {}, palette::of({}), arrows, targets);
        add_paths(setting.before->entities->organisms, organisms, shapes, ways);
        benchmark::DoNotOptimize(shapes.data());
        benchmark::DoNotOptimize(targets.lines.data());
    });
}

void density(benchmark::State& state) {
    std::vector<Shape> shapes;
    std::vector<Colour> colours;
    frames(state, [&](Setting& setting, const Positions& at) {
        shapes.clear(), colours.clear();
        const DensityGrid grid = density_of(at, setting.camera.visible(), density_cell_px(setting.camera, 5));
        add_density(grid, {1e9, 1e9}, density_scale(std::span{&grid, 1}, palette::Ramp::Viridis), shapes, colours);
        benchmark::DoNotOptimize(shapes.data());
    });
}

BENCHMARK(plain)->Arg(10'000)->Arg(100'000)->Unit(benchmark::kMicrosecond);
BENCHMARK(bodies)->Arg(10'000)->Arg(100'000)->Unit(benchmark::kMicrosecond);
BENCHMARK(headings)->Arg(10'000)->Arg(100'000)->Unit(benchmark::kMicrosecond);
BENCHMARK(everything)->Arg(10'000)->Arg(100'000)->Unit(benchmark::kMicrosecond);
BENCHMARK(density)->Arg(10'000)->Arg(100'000)->Unit(benchmark::kMicrosecond);

} // namespace
} // namespace evod::viewer
