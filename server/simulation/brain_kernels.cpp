// This file is a kernel: it is compiled once for each instruction set. base/lanes.h describes what it may include.
#include "server/simulation/brain_kernels.h"

#include "server/base/elementary_lanes.h"
#include "server/base/hash_lanes.h"
#include "server/base/lanes.h"
#include "server/physics/units.h"

namespace evod::simulation {
namespace {

using namespace evod::base; // the vector types of lanes.h
using evolution::BrainInput;

constexpr std::size_t group_size = 16; // physics::lanes_max
constexpr float tau = 6.28318530717958647693f;
constexpr float tiny = 1e-30f; // so that no divisor is 0

struct ItemOffset {
    Floats x, y, square;
};

Floats px_between(Integers from, Integers to) {
    return to_floats((Integers)((Words)to - (Words)from)) * physics::px_per_unit;
}

/// What an organism knows of its surroundings, and the item that it sees.
struct Surroundings {
    Integers x, y;
    Directions heading;
    Floats food_radius;

    Floats bearing(const ViewColumns& view, std::size_t i) const {
        const ItemOffset item = offset(view, i);
        const Floats ahead = item.x * heading.x + item.y * heading.y, aside = item.y * heading.x - item.x * heading.y;
        return sees(view, i, item) ? half_turns(ahead, aside) : Floats{};
    }
    Floats proximity(const ViewColumns& view, std::size_t i) const {
        const ItemOffset item = offset(view, i);
        const Floats radius = greater(load<Floats>(view.radius + i), all_lanes(tiny));
        return sees(view, i, item) ? 1.0f - square_root(item.square) / radius : Floats{};
    }
    /// Returns the proximity of the first wall in the direction of the heading.
    Floats wall_proximity(const SteeringRules& rules) const {
        const auto distance = [](Integers position, Floats way, std::int32_t size) {
            const Floats to_wall =
                way < 0.0f ? px_between(Integers{}, position) : px_between(position, Integers{} + size);
            return to_wall / greater(absolute(way), all_lanes(1e-6f));
        };
        const Floats ahead = lesser(distance(x, heading.x, rules.width), distance(y, heading.y, rules.height));
        return greater(1.0f - ahead / greater(food_radius, all_lanes(tiny)), Floats{});
    }

  private:
    ItemOffset offset(const ViewColumns& view, std::size_t i) const {
        const Floats dx = px_between(x, load<Integers>(view.x + i)), dy = px_between(y, load<Integers>(view.y + i));
        return {dx, dy, dx * dx + dy * dy};
    }
    static Integers sees(const ViewColumns& view, std::size_t i, const ItemOffset& item) {
        const Floats radius = load<Floats>(view.radius + i);
        return item.square <= radius * radius;
    }
};

Floats input(BrainInput which, const OrganismColumns& columns, const BrainColumns& brains, std::size_t i,
             const Surroundings& around, Floats speed, const SteeringRules& rules) {
    switch (which) {
    case BrainInput::FoodBearing:
        return around.bearing(columns.food, i);
    case BrainInput::FoodProximity:
        return around.proximity(columns.food, i);
    case BrainInput::PoisonBearing:
        return around.bearing(columns.poison, i);
    case BrainInput::PoisonProximity:
        return around.proximity(columns.poison, i);
    case BrainInput::Speed:
        return speed / rules.max_speed;
    case BrainInput::Health: {
        const Floats base = greater(load<Floats>(brains.base_health + i), all_lanes(tiny));
        return lesser(greater(load<Floats>(columns.health + i) / base, Floats{}), all_lanes(1.0f));
    }
    case BrainInput::WallProximity:
        return around.wall_proximity(rules);
    }
    return Floats{};
}

/// Computes a layer of neurons. Returns the first weight after those of the layer.
const float* compute_layer(const float* weights, const Floats* inputs, std::uint32_t input_count, bool has_bias,
                           Floats* neurons, std::uint32_t neuron_count) {
    const auto next = [&] {
        const Floats weight = load<Floats>(weights);
        weights += group_size;
        return weight;
    };
    for (std::uint32_t neuron = 0; neuron < neuron_count; ++neuron) {
        Floats sum = next() * inputs[0];
        for (std::uint32_t k = 1; k < input_count; ++k) {
            sum += next() * inputs[k];
        }
        if (has_bias) {
            sum += next();
        }
        neurons[neuron] = tanh(sum);
    }
    return weights;
}

struct Outputs {
    Floats drive, turn; // −1 … 1
};

/// neurons  the inputs; receives the hidden neurons and then the outputs after them.
Outputs run_networks(Floats* neurons, const float* weights, const SteeringRules& rules) {
    Floats* const hidden = neurons + rules.input_count;
    Floats* const outputs = hidden + rules.hidden_count;
    weights = compute_layer(weights, neurons, rules.input_count, rules.has_bias, hidden, rules.hidden_count);
    compute_layer(weights, hidden, rules.hidden_count, rules.has_bias, outputs, 2);
    return {outputs[0], outputs[1]};
}

template <bool predicting>
inline void steer_each(const OrganismColumns& columns, const BrainColumns& brains, std::size_t begin, std::size_t end,
                       const SteeringRules& rules, float* out_x, float* out_y, float* neurons_seen = nullptr) {
    for (std::size_t i = begin; i < end; i += lanes) {
        if constexpr (!predicting) {
            store(columns.health + i, load<Floats>(columns.health + i) - load<Floats>(columns.loss_per_tick + i));
        }
        const Integers x = load<Integers>(columns.x + i), y = load<Integers>(columns.y + i);
        const Floats old_heading = load<Floats>(brains.heading + i);
        const Floats vx = load<Floats>(columns.velocity_x + i), vy = load<Floats>(columns.velocity_y + i);
        const Floats speed = square_root(vx * vx + vy * vy);
        const Surroundings around{x, y, directions_of(old_heading), load<Floats>(columns.food.radius + i)};
        Floats neurons[evolution::brain_inputs_max + evolution::brain_hidden_max + 2];
        for (std::uint32_t k = 0; k < rules.input_count; ++k) {
            neurons[k] = input(rules.inputs[k], columns, brains, i, around, speed, rules);
        }
        const float* weights =
            brains.weights + i / group_size * group_size * rules.weight_count + i % group_size; // of the first lane
        const Outputs out = run_networks(neurons, weights, rules);

        const Floats turned = old_heading + out.turn * rules.turn;
        const Floats heading = turned - to_floats(round_to_integers(turned * (1 / tau))) * tau;
        const Directions ahead = directions_of(heading);
        const Floats faster = lesser(greater(speed + out.drive * rules.speed_change, Floats{}),
                                     all_lanes(rules.max_speed * 0.999999f)); // directions are up to 3e-7 too long
        const Floats size =
            rules.is_kinematic ? faster : out.drive * (load<Floats>(columns.normal_speed + i) * rules.force_per_unit);
        const Integers there = x != physics::void_position;
        store(out_x + (i - begin), there ? ahead.x * size : Floats{});
        store(out_y + (i - begin), there ? ahead.y * size : Floats{});
        if constexpr (!predicting) {
            store(brains.heading + i, heading);
        } else if (neurons_seen != nullptr) {
            for (std::uint32_t n = 0; n < rules.input_count + rules.hidden_count + 2; ++n) {
                store(neurons_seen + n * group_size + (i - begin), neurons[n]);
            }
        }
    }
}

void steer(const OrganismColumns& columns, const BrainColumns& brains, std::size_t begin, std::size_t end,
           const SteeringRules& rules, float* out_x, float* out_y) {
    steer_each<false>(columns, brains, begin, end, rules, out_x, out_y);
}

void predict(const OrganismColumns& columns, const BrainColumns& brains, std::size_t begin, std::size_t end,
             const SteeringRules& rules, float* out_x, float* out_y, float* neurons) {
    steer_each<true>(columns, brains, begin, end, rules, out_x, out_y, neurons);
}

HashWords hash(const OrganismColumns& columns, const float* heading, std::uint32_t kind, std::size_t begin,
               std::size_t end) {
    HashSumsPerLane sums;
    const std::uint32_t kind_key = kind * 0x85ebca6bu;
    for (std::size_t i = begin; i < end; i += lanes) {
        const Integers there = load<Floats>(columns.health + i) >= -__FLT_MAX__;
        sums.add(load<Words>(columns.id + i) + kind_key, load<Words>(heading + i), Words{}, Words{}, Words{}, Words{},
                 there);
    }
    return {sum_of(sums.low), sum_of(sums.high)};
}

} // namespace

extern const BrainKernels EVOD_KERNEL(brain_kernels);
const BrainKernels EVOD_KERNEL(brain_kernels) = {steer, predict, hash};

} // namespace evod::simulation
