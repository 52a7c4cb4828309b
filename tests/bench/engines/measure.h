// Measure: runs scenes for a while and says how fast they went and what happened in them.
#pragma once

#include "server/base/executor.h"
#include "tests/bench/engines/scene.h"
#include "tests/bench/stopwatch.h"

#include <algorithm>
#include <cmath>
#include <cstdint>

namespace evod::bench {

/// Which ticks of how many scenes count. All scenes are run, again and again, until `least_wall_s` have been measured.
struct Window {
    std::uint64_t first_seed = 1;
    std::uint32_t scenes = 1;         // of seeds first_seed, first_seed + 1, …
    std::uint32_t warm_up_ticks = 60; // not measured
    std::uint32_t ticks = 60;         // together with warm_up_ticks at most a generation
    double least_wall_s = 0;
    std::uint32_t look_every_ticks = 0; // how often the scene is looked at, outside the measured time; 0 is never
};

struct Measured {
    std::uint64_t organism_ticks = 0; // organisms alive at the start of each tick, summed
    std::uint64_t born = 0;           // organisms of all scenes measured
    std::uint32_t rounds = 0;         // times all scenes were run
    Seconds time;
    Counts counts;          // in the measured ticks
    double speed_sum = 0;   // px/s, over the organisms looked at
    double seeing_food = 0; // of the organisms looked at
    std::uint64_t looked_at = 0;
};

/// Adds what the living are doing: every organism compared with every food.
inline void observe(const Observation& observation, Measured& measured) {
    for (const Observation::Organism& organism : observation.organisms) {
        ++measured.looked_at;
        measured.speed_sum += std::sqrt(square(organism.velocity));
        for (const Vector& food : observation.food) {
            if (square({food.x - organism.place.x, food.y - organism.place.y}) <=
                organism.food_radius * organism.food_radius) {
                ++measured.seeing_food;
                break;
            }
        }
    }
}

/// make_scene(seed)  a scene at its start.
template <class MakeScene>
Measured measure(const Window& window, MakeScene&& make_scene, base::Executor& executor) {
    Measured measured;
    do {
        ++measured.rounds;
        for (std::uint32_t k = 0; k < window.scenes; ++k) {
            auto scene = make_scene(base::Seed{window.first_seed + k});
            measured.born += scene.alive_count();
            for (std::uint32_t tick = 0; tick < window.warm_up_ticks && scene.alive_count() > 0; ++tick) {
                scene.advance_tick(executor);
            }
            const Counts before = scene.counts();
            const std::uint32_t stretch = window.look_every_ticks > 0 ? window.look_every_ticks : window.ticks;
            for (std::uint32_t done = 0; done < window.ticks && scene.alive_count() > 0; done += stretch) {
                const Stopwatch stopwatch;
                for (std::uint32_t tick = done; tick < std::min(done + stretch, window.ticks); ++tick) {
                    if (scene.alive_count() == 0) {
                        break;
                    }
                    measured.organism_ticks += scene.alive_count();
                    scene.advance_tick(executor);
                }
                const Seconds took = stopwatch.elapsed();
                measured.time.wall += took.wall;
                measured.time.processor += took.processor;
                if (window.look_every_ticks > 0) {
                    observe(scene.observation(), measured);
                }
            }
            const Counts after = scene.counts();
            measured.counts.food_eaten += after.food_eaten - before.food_eaten;
            measured.counts.poison_eaten += after.poison_eaten - before.poison_eaten;
            measured.counts.deaths += after.deaths - before.deaths;
        }
    } while (measured.time.wall < window.least_wall_s);
    return measured;
}

} // namespace evod::bench
