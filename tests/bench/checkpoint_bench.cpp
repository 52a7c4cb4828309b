// What a checkpoint costs: the ticks of a world while its run is kept, the longest with a checkpoint beside the others,
// and what packing one takes. As a server does it: ticks and copying on this thread and its workers, the rest on the
// storage thread.
#include "server/base/inline_executor.h"
#include "server/runtime/worker_pool.h"
#include "server/storage/checkpoint.h"
#include "server/storage/recorder.h"
#include "tests/bench/experiment.h"
#include "tests/bench/stopwatch.h"

#include <CLI/CLI.hpp>

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <string>
#include <thread>
#include <vector>

namespace {

using namespace evod;

double median(std::vector<double> values) {
    std::ranges::nth_element(values, values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2));
    return values[values.size() / 2];
}

} // namespace

int main(int argc, char** argv) {
    CLI::App app{"What a checkpoint costs the world whose state it is"};
    std::uint32_t organisms = 100'000, checkpoints = 10, ticks_between = 60;
    std::size_t threads = std::thread::hardware_concurrency();
    std::string folder = std::filesystem::temp_directory_path();
    app.add_option("--organisms", organisms);
    app.add_option("--checkpoints", checkpoints);
    app.add_option("--ticks-between", ticks_between);
    app.add_option("--threads", threads);
    app.add_option("--folder", folder, "where the run file is written");
    CLI11_PARSE(app, argc, argv);

    const auto executor = runtime::make_executor(threads);
    const std::string path = folder + "/checkpoint_bench.evod";
    for (const char* suffix : {"", "-wal", "-shm"})
        std::filesystem::remove(path + suffix);
    simulation::World world{bench::bench_world(organisms), base::Seed{1}};
    std::vector<double> plain_ms, with_checkpoint_ms, copying_ms;
    {
        storage::StorageThread thread{{}};
        const auto number = thread.create(
            path, {.name = "w", .run_id = {}, .seed = {1}, .parameters = world.parameters().requested}, {});
        storage::RunRecorder recorder{thread, number, {}, 0};
        recorder.follow(world);
        for (std::uint32_t tick = 0; tick < 60; ++tick)
            world.advance_tick(*executor);
        for (std::uint32_t made = 0; made < checkpoints; ++made) {
            for (std::uint32_t tick = 0; tick <= ticks_between; ++tick) {
                const bench::Stopwatch whole;
                world.advance_tick(*executor);
                recorder.follow(world);
                if (tick == ticks_between) {
                    const bench::Stopwatch copying;
                    recorder.make_checkpoint(world, *executor);
                    copying_ms.push_back(1e3 * copying.elapsed().wall);
                }
                (tick == ticks_between ? with_checkpoint_ms : plain_ms).push_back(1e3 * whole.elapsed().wall);
            }
        }
    }
    const simulation::WorldState state = world.state(*executor);
    const bench::Stopwatch packing;
    const std::string packed = storage::pack(state);
    const double packing_ms = 1e3 * packing.elapsed().wall;
    std::printf("%u organisms, %zu threads: a tick %.2f ms (median), longest without a checkpoint %.2f ms; with one "
                "%.2f ms (median), longest %.2f ms, of which copying %.2f ms (median), longest %.2f ms; packing "
                "%.1f ms, %.2f MB; run file %.1f MB\n",
                organisms, executor->thread_count(), median(plain_ms), std::ranges::max(plain_ms),
                median(with_checkpoint_ms), std::ranges::max(with_checkpoint_ms), median(copying_ms),
                std::ranges::max(copying_ms), packing_ms, 1e-6 * static_cast<double>(packed.size()),
                1e-6 * static_cast<double>(std::filesystem::file_size(path)));
    for (const char* suffix : {"", "-wal", "-shm"})
        std::filesystem::remove(path + suffix);
}
