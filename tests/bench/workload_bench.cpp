// workload_bench: how many organism-ticks a second evod and other engines make of the same benchmark world.
//
// One run of one program, printed as one line of JSON: workload_bench --program box2d --organisms 2000. All programs
// start from the same first generations and follow the same rules (engines/rules.h), so what happens in them is printed
// too, to be compared.
#include "server/runtime/worker_pool.h"
#include "tests/bench/engines/all_pairs.h"
#include "tests/bench/engines/evod_scene.h"
#include "tests/bench/engines/measure.h"
#include "tests/bench/engines/rules.h"
#include "tests/bench/experiment.h"
#include "tests/bench/instructions_option.h"
#ifdef EVOD_BENCH_BOX2D
#include "tests/bench/engines/box2d.h"
#endif
#ifdef EVOD_BENCH_CHIPMUNK
#include "tests/bench/engines/chipmunk.h"
#endif

#include <CLI/CLI.hpp>
#include <boost/json.hpp>

#include <iostream>
#include <map>

namespace evod::bench {
namespace {

struct Options {
    std::string program = "evod", steering = "rules";
    std::uint32_t organisms = 2000, islands = 1;
    std::size_t threads = 1;
    bool spatial_order = false;
    Window window;
};

using Steering = parameters::Parameters (*)(std::uint32_t organisms);

/// What steers the organisms of evod: the rules, or networks with one of the locomotions.
const std::map<std::string, Steering> steerings = {
    {"rules", [](std::uint32_t organisms) { return bench_world(organisms); }},
    {"newtonian", [](std::uint32_t organisms) { return bench_world(organisms, evolution::Locomotion::Newtonian); }},
    {"kinematic", [](std::uint32_t organisms) { return bench_world(organisms, evolution::Locomotion::Kinematic); }},
};

Measured run_evod(const Options& options) {
    parameters::Parameters parameters = steerings.at(options.steering)(options.organisms);
    parameters.island_count = options.islands;
    const auto executor = runtime::make_executor(options.threads);
    return measure(
        options.window,
        [&](base::Seed seed) {
            return EvodScene{parameters, seed};
        },
        *executor);
}

template <class Engine>
Measured run_engine(const Options& options) {
    const parameters::Parameters parameters = bench_world(options.organisms);
    const auto executor = runtime::make_executor(1);
    return measure(
        options.window,
        [&](base::Seed seed) {
            StartState start = start_state(simulation::World{parameters, seed});
            if (options.spatial_order) {
                start = in_spatial_order(std::move(start));
            }
            return EngineScene<Engine>{start, seed};
        },
        *executor);
}

using Program = Measured (*)(const Options&);

const std::map<std::string, Program>& programs() {
    static const std::map<std::string, Program> all = {
        {"evod", run_evod},
        {"all_pairs", run_engine<AllPairs>},
#ifdef EVOD_BENCH_BOX2D
        {"box2d", run_engine<Box2d>},
#endif
#ifdef EVOD_BENCH_CHIPMUNK
        {"chipmunk_hash", run_engine<Chipmunk<ChipmunkIndex::Hash>>},
        {"chipmunk_tree", run_engine<Chipmunk<ChipmunkIndex::Tree>>},
#endif
    };
    return all;
}

boost::json::object report(const Options& options, const Measured& measured) {
    const auto organism_ticks = static_cast<double>(measured.organism_ticks);
    const double organism_s = organism_ticks / 60; // simulated
    boost::json::object line{
        {"program", options.program},
        {"steering", options.steering},
        {"organisms", options.organisms},
        {"islands", options.islands},
        {"threads", options.threads},
        {"spatial_order", options.spatial_order},
        {"instructions", base::name_of(base::instructions())},
        {"first_seed", options.window.first_seed},
        {"scenes", options.window.scenes},
        {"rounds", measured.rounds},
        {"warm_up_ticks", options.window.warm_up_ticks},
        {"ticks", options.window.ticks},
        {"organism_ticks", measured.organism_ticks},
        {"wall_s", measured.time.wall},
        {"processor_s", measured.time.processor},
        {"organism_ticks_per_s", organism_ticks / measured.time.wall},
        {"organism_ticks_per_processor_s", organism_ticks / measured.time.processor},
        {"food_per_organism_s", static_cast<double>(measured.counts.food_eaten) / organism_s},
        {"poison_per_organism_s", static_cast<double>(measured.counts.poison_eaten) / organism_s},
        {"deaths_share", static_cast<double>(measured.counts.deaths) / static_cast<double>(measured.born)}};
    if (measured.looked_at > 0) {
        line["speed_mean_px_s"] = measured.speed_sum / static_cast<double>(measured.looked_at);
        line["seeing_food_share"] = measured.seeing_food / static_cast<double>(measured.looked_at);
    }
    return line;
}

int run(int argc, char** argv) {
    Options options;
    bool list = false;
    CLI::App app{"One program on the benchmark world; prints one line of JSON."};
    app.add_flag("--list", list, "print the programs that were built, and nothing else");
    app.add_option("--program", options.program)->check(CLI::IsMember(&programs()))->capture_default_str();
    app.add_option("--steering", options.steering, "by rules, or by networks of 5-8-2; evod only")
        ->check(CLI::IsMember(&steerings))
        ->capture_default_str();
    app.add_option("--organisms", options.organisms, "on each island")->capture_default_str();
    app.add_option("--islands", options.islands, "evod only")->capture_default_str();
    app.add_option("--threads", options.threads, "evod only")->capture_default_str();
    app.add_flag("--spatial-order", options.spatial_order, "create neighbours one after another; engines only");
    app.add_option("--seed", options.window.first_seed)->capture_default_str();
    app.add_option("--scenes", options.window.scenes, "worlds of this and the next seeds")->capture_default_str();
    app.add_option("--warm-up-ticks", options.window.warm_up_ticks)->capture_default_str();
    app.add_option("--ticks", options.window.ticks, "measured, of each scene")->capture_default_str();
    app.add_option("--least-s", options.window.least_wall_s, "run all scenes again until as much was measured");
    app.add_option("--look-every", options.window.look_every_ticks, "look at the organisms every so many ticks");
    add_instructions_option(app);
    CLI11_PARSE(app, argc, argv);
    if (list) {
        for (const auto& [name, program] : programs()) {
            std::cout << name << '\n';
        }
        return 0;
    }
    std::cout << report(options, programs().at(options.program)(options)) << '\n';
    return 0;
}

} // namespace
} // namespace evod::bench

int main(int argc, char** argv) {
    return evod::bench::run(argc, argv);
}
