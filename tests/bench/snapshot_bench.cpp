// The work of the network thread for a snapshot, stage by stage, without sending it: quantising what the simulation
// thread copied, encoding it against the snapshot before, and serialising that with a checksum, uncompressed or with
// zstd.
//
// Benchmarks are named WORLD/COMPRESSION; the counters are nanoseconds of an entity (organisms, food, poison), and
// bytes per entity. The worlds have 23,000 entities, of which half, a tenth or all move, and are those of
// `stream_cost.py
// --movers`; snapshots are 3 ticks apart, or 300 to 302, as a world at full speed has them.
#include "server/base/inline_executor.h"
#include "server/runtime/snapshot.h"
#include "server/streaming/delta_stream.h"
#include "server/streaming/quantise.h"
#include "tests/bench/experiment.h"

#include <benchmark/benchmark.h>

#include <chrono>
#include <cmath>
#include <memory>
#include <string>
#include <vector>

namespace evod::bench {
namespace {

using Clock = std::chrono::steady_clock;

/// The default world, with so many organisms and items on the ground of `ground` organisms.
parameters::Parameters world_of(std::uint32_t organisms, std::uint32_t food, std::uint32_t poison, double ground) {
    parameters::Parameters parameters = experiment("default");
    const double longer = std::sqrt(ground / parameters.population_size);
    parameters.island_width_px *= longer;
    parameters.island_height_px *= longer;
    parameters.population_size = organisms;
    parameters.food_count = food;
    parameters.poison_count = poison;
    return parameters;
}

struct Kind {
    const char* name;
    parameters::Parameters parameters;
    int ticks_between = 3;
    int spread = 1; // so many different numbers of ticks, from ticks_between on
};

/// Snapshots of a run, so many ticks apart.
std::vector<runtime::SnapshotPtr> snapshots_of(const Kind& kind) {
    constexpr int warm_up_ticks = 60, snapshot_count = 40;
    simulation::Entry entry{
        .name = "w", .run_id = {1, 2}, .control = {}, .world = simulation::World{kind.parameters, base::Seed{1}}};
    base::InlineExecutor executor;
    for (int tick = 0; tick < warm_up_ticks; ++tick) {
        entry.world.advance_tick(executor);
    }
    runtime::SnapshotPool pool;
    std::vector<runtime::SnapshotPtr> snapshots;
    for (int i = 0; i < snapshot_count; ++i) {
        snapshots.push_back(pool.take(entry, {0}, false));
        for (int tick = 0; tick < kind.ticks_between + i % kind.spread; ++tick) {
            entry.world.advance_tick(executor);
        }
    }
    return snapshots;
}

void encode(benchmark::State& state, const Kind& kind, v1::Compression compression) {
    const std::vector<runtime::SnapshotPtr> snapshots = snapshots_of(kind);
    codec::Compressor compressor;
    std::chrono::duration<double> quantising{0}, encoding{0};
    std::uint64_t entities = 0, size = 0;
    for (auto _ : state) {
        streaming::StreamedSnapshotPtr latest;
        streaming::SentState state_of_viewer;
        for (std::size_t i = 0; i < snapshots.size(); ++i) {
            const runtime::Snapshot& snapshot = *snapshots[i];
            v1::SnapshotFrame about;
            about.set_sequence(i + 1);
            about.set_generation(snapshot.moment.generation);
            about.set_generation_tick(snapshot.moment.generation_tick);
            const auto began = Clock::now();
            codec::QuantisedSnapshot quantised = streaming::quantise(snapshot.islands.front());
            const auto ready = Clock::now();
            const auto island =
                std::make_shared<streaming::EncodedIsland>(std::move(about), std::move(quantised), compressor);
            latest = std::make_shared<streaming::StreamedSnapshot>(
                island, streaming::Form::Whole, latest, runtime::Clock::time_point{}, runtime::Clock::duration{});
            std::vector<const streaming::SharedBytes*> parts;
            const codec::TileRange all = codec::tiles_of(latest->layout());
            state_of_viewer.add_parts(*latest, all, v1::DETAIL_FULL, compression, parts);
            state_of_viewer.sent(*latest, all, v1::DETAIL_FULL);
            benchmark::DoNotOptimize((*parts.front())->data());
            const auto done = Clock::now();
            if (i == 0) { // a keyframe
                continue;
            }
            quantising += ready - began;
            encoding += done - ready;
            const v1::SnapshotFrame& counted = island->about();
            entities += counted.organism_count() + counted.food_count() + counted.poison_count();
            size += (*parts.front())->size();
        }
    }
    const auto each_ns = [&](std::chrono::duration<double> took) {
        return 1e9 * took.count() / static_cast<double>(entities);
    };
    state.counters["quantise_ns"] = each_ns(quantising);
    state.counters["encode_ns"] = each_ns(encoding);
    state.counters["all_ns"] = each_ns(quantising + encoding);
    state.counters["bytes"] = static_cast<double>(size) / static_cast<double>(entities);
}

const bool registered = [] {
    const parameters::Parameters half = world_of(10'000, 5'000, 8'000, 10'000);
    for (const Kind& kind : {Kind{"half move", half}, Kind{"a tenth moves", world_of(2'300, 8'000, 12'700, 10'000)},
                             Kind{"all move", world_of(23'000, 0, 0, 23'000)}, Kind{"at full speed", half, 300, 3}}) {
        for (const auto& [name, compression] :
             {std::pair{"none", v1::COMPRESSION_NONE}, std::pair{"zstd", v1::COMPRESSION_ZSTD}}) {
            benchmark::RegisterBenchmark((std::string{kind.name} + '/' + name).c_str(), encode, kind, compression)
                ->Unit(benchmark::kMillisecond);
        }
    }
    return true;
}();

} // namespace
} // namespace evod::bench
