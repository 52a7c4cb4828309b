// The network thread's work for one snapshot, stage by stage, without sending it: sorting and quantising what the
// simulation thread copied, encoding it against the snapshot before, and building and compressing the bytes, with a
// checksum, as they are or by zstd.
//
// Benchmarks are named WORLD/COMPRESSION; the counters are nanoseconds of an entity (organisms, food, poison), and
// bytes. The worlds have 23,000 entities, of which half, a tenth or all move, and are those of `stream_cost.py
// --movers`; snapshots are 3 ticks apart, or 300 to 302, as a world at full speed has them.
#include "proto/codec/snapshot_codec.h"
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

void snapshots(benchmark::State& state, const Kind& kind, v1::Compression compression) {
    const std::vector<runtime::SnapshotPtr> snapshots = snapshots_of(kind);
    codec::Compressor compressor;
    std::chrono::duration<double> scene{0}, delta{0}, bytes{0};
    std::uint64_t entities = 0, size = 0;
    for (auto _ : state) {
        streaming::DeltaStream chain;
        for (std::size_t i = 0; i < snapshots.size(); ++i) {
            const runtime::Snapshot& snapshot = *snapshots[i];
            v1::SnapshotFrame about;
            about.set_sequence(i + 1);
            about.set_generation(snapshot.moment.generation);
            about.set_generation_tick(snapshot.moment.generation_tick);
            const auto began = Clock::now();
            auto made = std::make_shared<const codec::QuantisedSnapshot>(streaming::quantise(snapshot.islands.front()));
            codec::describe(*made, about);
            const auto ready = Clock::now();
            const streaming::DeltaSnapshotPtr& snapshot =
                chain.add(std::make_shared<const v1::SnapshotFrame>(about), std::move(made), compressor, {}, {});
            const auto encoded = Clock::now();
            const streaming::SharedBytes frame = snapshot->after(i, compression);
            benchmark::DoNotOptimize(frame->data());
            const auto done = Clock::now();
            if (i == 0) { // a keyframe
                continue;
            }
            scene += ready - began;
            delta += encoded - ready;
            bytes += done - encoded;
            entities += about.organism_count() + about.food_count() + about.poison_count();
            size += frame->size();
        }
    }
    const auto each_ns = [&](std::chrono::duration<double> took) {
        return 1e9 * took.count() / static_cast<double>(entities);
    };
    state.counters["scene_ns"] = each_ns(scene);
    state.counters["delta_ns"] = each_ns(delta);
    state.counters["bytes_ns"] = each_ns(bytes);
    state.counters["all_ns"] = each_ns(scene + delta + bytes);
    state.counters["bytes"] = static_cast<double>(size) / static_cast<double>(entities);
}

const bool registered = [] {
    const parameters::Parameters half = world_of(10'000, 5'000, 8'000, 10'000);
    for (const Kind& kind : {Kind{"half move", half}, Kind{"a tenth moves", world_of(2'300, 8'000, 12'700, 10'000)},
                             Kind{"all move", world_of(23'000, 0, 0, 23'000)}, Kind{"at full speed", half, 300, 3}}) {
        for (const auto& [name, compression] :
             {std::pair{"none", v1::COMPRESSION_NONE}, std::pair{"zstd", v1::COMPRESSION_ZSTD}}) {
            benchmark::RegisterBenchmark((std::string{kind.name} + '/' + name).c_str(), snapshots, kind, compression)
                ->Unit(benchmark::kMillisecond);
        }
    }
    return true;
}();

} // namespace
} // namespace evod::bench
