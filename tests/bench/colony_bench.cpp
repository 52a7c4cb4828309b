// Colonies: what an organism-tick costs with births, and with births and predators, compared with the same world with
// generations. On one thread. The worlds take turns, so that a change of the machine's speed affects all of them.
#include "server/base/inline_executor.h"
#include "server/simulation/world.h"
#include "tests/bench/experiment.h"
#include "tests/bench/stopwatch.h"

#include <CLI/CLI.hpp>

#include <cstdio>
#include <vector>

namespace evod::bench {
namespace {

using parameters::Parameters;

/// A world of a preset, as dense as the preset at rest, with another number of organisms.
///
/// at_rest  how many prey the preset has after some intervals.
Parameters enlarged(const std::string& preset, std::uint32_t organisms, std::uint32_t at_rest) {
    Parameters parameters = experiment(preset);
    parameters.scale_with_population = true;
    parameters.reference_population = at_rest;
    parameters.population_size = organisms;
    parameters.population_max = parameters.predator_population_max = 4 * organisms;
    parameters.predator_from = 1;
    parameters.predator_count =
        static_cast<std::uint32_t>(std::uint64_t{parameters.predator_count} * organisms / at_rest);
    return parameters;
}

struct Subject {
    const char* name;
    simulation::World world;
    double processor_s = 0;
    std::uint64_t organism_ticks = 0;

    void advance(std::uint64_t ticks, base::Executor& executor) {
        const Stopwatch watch;
        for (std::uint64_t tick = 0; tick < ticks; ++tick) {
            organism_ticks += world.alive_count();
            world.advance_tick(executor);
        }
        processor_s += watch.elapsed().processor;
    }
    double ns() const { return 1e9 * processor_s / static_cast<double>(organism_ticks); }
};

int run(int argc, char** argv) {
    std::uint32_t organisms = 100'000;
    std::uint64_t warm_up_ticks = 1200, ticks = 600;
    CLI::App app{"The cost of an organism-tick in colonies, compared with the same world with generations."};
    app.add_option("--organisms", organisms)->capture_default_str();
    app.add_option("--warm-up-ticks", warm_up_ticks)->capture_default_str();
    app.add_option("--ticks", ticks, "measured, in turns of 60")->capture_default_str();
    CLI11_PARSE(app, argc, argv);

    const Parameters colony = enlarged("colony", organisms, 135), predators = enlarged("predators", organisms, 160);
    const auto with_generations = [](Parameters parameters) {
        parameters.reproduction = parameters::Reproduction::Generations;
        parameters.predator_count = 0;
        return parameters;
    };
    std::vector<Subject> subjects;
    subjects.push_back({"colony.json with generations", {with_generations(colony), base::Seed{1}}});
    subjects.push_back({"colony.json", {colony, base::Seed{1}}});
    subjects.push_back({"predators.json with generations", {with_generations(predators), base::Seed{1}}});
    subjects.push_back({"predators.json", {predators, base::Seed{1}}});
    base::InlineExecutor executor;
    for (Subject& subject : subjects) {
        subject.advance(warm_up_ticks, executor);
        subject.processor_s = 0;
        subject.organism_ticks = 0;
    }
    for (std::uint64_t done = 0; done < ticks; done += 60) {
        for (Subject& subject : subjects) {
            subject.advance(60, executor);
        }
    }
    std::puts("world                             organisms  predators  births  ns per organism-tick  speed");
    for (std::size_t k = 0; k < subjects.size(); ++k) {
        const Subject& subject = subjects[k];
        const simulation::LiveStatistics live = subject.world.island(0).live_counts();
        std::printf("%-32s %10u %10u %7u %21.1f %6.2f\n", subject.name, live.alive_count, live.predator_count,
                    live.born_count, subject.ns(), subjects[k / 2 * 2].ns() / subject.ns());
    }
    return 0;
}

} // namespace
} // namespace evod::bench

int main(int argc, char** argv) {
    return evod::bench::run(argc, argv);
}
