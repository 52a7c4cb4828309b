// What a checkpoint costs: the ticks of a world while its run is kept, the longest with a checkpoint and the others,
// and what packing one takes. As a server does it: ticks and copying on this thread and its workers, the rest on the
// storage thread.
#include "server/base/inline_executor.h"
#include "server/recording/recorder.h"
#include "server/run_file/checkpoint.h"
#include "server/runtime/worker_pool.h"
#include "tests/bench/experiment.h"
#include "tests/bench/stopwatch.h"

#include <CLI/CLI.hpp>
#include <boost/json.hpp>

#include <algorithm>
#include <filesystem>
#include <iostream>
#include <string>
#include <thread>
#include <vector>

namespace {

using namespace evod;

boost::json::object spread(std::vector<double> values) {
    std::ranges::sort(values);
    return {{"median", values[values.size() / 2]}, {"min", values.front()}, {"max", values.back()}};
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
    for (const char* suffix : {"", "-wal", "-shm"}) {
        std::filesystem::remove(path + suffix);
    }
    simulation::World world{bench::bench_world(organisms), base::Seed{1}};
    std::vector<double> plain_ms, with_checkpoint_ms, copying_ms;
    {
        recording::StorageThread thread{{}};
        const auto number = thread.create(path, run_file::beginning_of_run(world, "w", {}));
        recording::RunRecorder recorder{thread, number, {.generations = 1}, 0};
        recorder.follow(world);
        for (std::uint32_t tick = 0; tick < 60; ++tick) {
            world.advance_tick(*executor);
        }
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
    const std::string packed = run_file::pack(state);
    const double packing_ms = 1e3 * packing.elapsed().wall;
    std::cout << boost::json::object{{"organisms", organisms},
                                     {"threads", executor->thread_count()},
                                     {"tick_ms", spread(plain_ms)},
                                     {"tick_with_checkpoint_ms", spread(with_checkpoint_ms)},
                                     {"copying_ms", spread(copying_ms)},
                                     {"packing_ms", packing_ms},
                                     {"packed_bytes", packed.size()},
                                     {"run_file_bytes", std::filesystem::file_size(path)}}
              << '\n';
    for (const char* suffix : {"", "-wal", "-shm"}) {
        std::filesystem::remove(path + suffix);
    }
}
