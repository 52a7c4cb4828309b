// StartState: the first generation of an evod world as plain numbers, from which every engine starts.
#pragma once

#include "server/simulation/world.h"

#include <cstddef>
#include <vector>

namespace evod::bench {

struct Vector {
    double x = 0, y = 0;
};

inline double square(const Vector& v) {
    return v.x * v.x + v.y * v.y;
}

/// An organism at birth: at rest, genes as they act (ARCHITECTURE.md, the life of an organism).
struct Born {
    Vector place;                      // px
    double radius, mass;               // px, kg
    double health;                     // also the gene
    double normal_speed, impulse;      // gene units
    double food_radius, poison_radius; // px; how far it sees
};

/// The constants of the model, a tick being tick_s.
struct Model {
    double tick_s;
    double damping; // share of its velocity that a body keeps in a tick
    double restitution, max_speed;
    double health_loss, food_health, poison_harm; // loss: a tick's
    double lookahead_s, certain_impulse, force_per_unit;
    double item_radius;
};

struct StartState {
    Model model;
    double width, height;        // px
    std::vector<Born> organisms; // in order of id
    std::vector<Vector> items;   // food, then poison; each in order of id
    std::size_t food_count;
};

/// What the first island holds before its first tick.
/// world  fresh, with FleeRule::Nearer, no boxes, no costs of genes and immediate respawn, as experiments/bench.json.
StartState start_state(const simulation::World& world);

/// The same scene with neighbours next to each other in memory: organisms, food and poison each in the order of cells
/// of 200 px, row by row.
StartState in_spatial_order(StartState start);

} // namespace evod::bench
