// This file is a kernel: it is compiled once for each instruction set. base/lanes.h describes what it may include.
#include "server/simulation/organism_kernels.h"

#include "server/base/hash_lanes.h"
#include "server/base/lanes.h"
#include "server/base/random_lanes.h"
#include "server/physics/units.h"

namespace evod::simulation {
namespace {

using namespace evod::base; // the vector types of lanes.h

void append(FoundIndices& found, std::size_t begin, unsigned bits) {
    for (; bits != 0; bits &= bits - 1) {
        found.indices[found.count++] = static_cast<std::uint32_t>(begin) + static_cast<unsigned>(__builtin_ctz(bits));
    }
}

/// Returns to − from in px, like physics::distance_px().
Floats distances(Integers from, Integers to) {
    return to_floats((Integers)((Words)to - (Words)from)) * physics::px_per_unit;
}

void find_stale(const float* others, std::size_t begin, std::size_t end, FoundIndices& stale) {
    for (std::size_t i = begin; i < end; i += lanes) {
        if (const unsigned bits = bits_of(load<Floats>(others + i) < 0.0f); bits != 0) {
            append(stale, i, bits);
        }
    }
}

void prefetch_view_ahead(std::size_t i, const ViewColumns& view) {
    prefetch_ahead(i, view.x, view.y, view.others, view.radius);
}

struct Offset {
    Floats x, y, square;
};

Offset offset_to_nearest(const ViewColumns& view, std::size_t i, Integers x, Integers y) {
    const Floats dx = distances(x, load<Integers>(view.x + i)), dy = distances(y, load<Integers>(view.y + i));
    return {dx, dy, dx * dx + dy * dy};
}

void notice(const std::int32_t* x, const std::int32_t* y, const ViewColumns& view, const ItemChange* changes,
            std::size_t change_count, std::size_t end) {
    for (std::size_t i = 0; i < end; i += lanes) {
        const Integers own_x = load<Integers>(x + i), own_y = load<Integers>(y + i);
        const Integers nearest_x = load<Integers>(view.x + i), nearest_y = load<Integers>(view.y + i);
        const Floats radius = load<Floats>(view.radius + i), old_others = load<Floats>(view.others + i);
        const Floats known_square = lesser(offset_to_nearest(view, i, own_x, own_y).square, radius * radius);
        Floats others = old_others;
        for (std::size_t k = 0; k < change_count; ++k) {
            const Integers item_x = Integers{} + changes[k].x, item_y = Integers{} + changes[k].y;
            if (!changes[k].came) {
                others = (nearest_x == item_x) & (nearest_y == item_y) ? all_lanes(-1.0f) : others;
                continue;
            }
            const Floats dx = distances(own_x, item_x), dy = distances(own_y, item_y), square = dx * dx + dy * dy;
            Floats distance = square_root(square);
            distance -= distance * 1e-6f + 0.002f; // slightly less, to allow for rounding of distances and positions
            const Floats bound = (distance > 0.0f) & (known_square < distance * distance) ? distance : all_lanes(-1.0f);
            others = distance < others ? bound : others;
        }
        store(view.others + i, own_x != physics::void_position ? others : old_others);
    }
}

/// Chooses the forces of organisms. If `predicting` is true, health is not subtracted, and `choices` receives the
/// choices. If `hunting` is true, there are predators.
template <bool predicting, bool hunting>
inline void choose_each(const OrganismColumns& columns, std::size_t begin, std::size_t end, const ChoiceRules& rules,
                        float* force_x, float* force_y, std::int32_t* choices) {
    for (std::size_t i = begin; i < end; i += lanes) {
        if constexpr (!predicting) {
            prefetch_ahead(i, columns.x, columns.y, columns.velocity_x, columns.velocity_y, columns.body_radius,
                           columns.id, columns.health, columns.loss_per_tick, columns.normal_speed, columns.impulse);
            prefetch_view_ahead(i, columns.food);
            prefetch_view_ahead(i, columns.poison);
            store(columns.health + i, load<Floats>(columns.health + i) - load<Floats>(columns.loss_per_tick + i));
        }

        const Integers x = load<Integers>(columns.x + i), y = load<Integers>(columns.y + i);
        const Offset food = offset_to_nearest(columns.food, i, x, y),
                     poison = offset_to_nearest(columns.poison, i, x, y);
        const Floats food_radius = load<Floats>(columns.food.radius + i),
                     poison_radius = load<Floats>(columns.poison.radius + i);
        const Integers sees_food = food.square <= food_radius * food_radius;
        const Integers sees_poison = poison.square <= poison_radius * poison_radius;
        Integers afraid = rules.always_flee ? sees_poison : sees_poison & (~sees_food | (poison.square < food.square));
        if constexpr (hunting) {
            afraid |= sees_poison & load<Integers>(columns.is_hunted + i);
        }

        const WordPairs words = philox_pairs(load<Words>(columns.id + i), rules.pair_counter, rules.pair_key);
        const Floats impulse = load<Floats>(columns.impulse + i);
        const Integers flees = afraid & (unit_floats(words.second) * rules.certain_impulse < impulse);

        const Floats ahead_x = food.x - load<Floats>(columns.velocity_x + i) * rules.lookahead_s;
        const Floats ahead_y = food.y - load<Floats>(columns.velocity_y + i) * rules.lookahead_s;
        const Floats shift_x = flees ? -poison.x : ahead_x, shift_y = flees ? -poison.y : ahead_y;
        const Floats square = shift_x * shift_x + shift_y * shift_y;
        const Integers to_or_from = flees | sees_food, straight = to_or_from & (square != 0.0f);
        const Floats size = (to_or_from ? impulse : load<Floats>(columns.normal_speed + i)) * rules.force_per_unit;
        const Floats share = size / square_root(square);
        const Directions random = directions(words.first);
        store(force_x + (i - begin), straight ? shift_x * share : random.x * size);
        store(force_y + (i - begin), straight ? shift_y * share : random.y * size);
        if constexpr (predicting) {
            store(choices + (i - begin), flees       ? all_lanes(static_cast<std::int32_t>(Choice::Flee))
                                         : sees_food ? all_lanes(static_cast<std::int32_t>(Choice::Seek))
                                                     : all_lanes(static_cast<std::int32_t>(Choice::Wander)));
        }
    }
}

void choose(const OrganismColumns& columns, std::size_t begin, std::size_t end, const ChoiceRules& rules,
            float* force_x, float* force_y) {
    if (columns.is_hunted == nullptr) {
        choose_each<false, false>(columns, begin, end, rules, force_x, force_y, nullptr);
    } else {
        choose_each<false, true>(columns, begin, end, rules, force_x, force_y, nullptr);
    }
}

void predict(const OrganismColumns& columns, std::size_t begin, std::size_t end, const ChoiceRules& rules,
             float* force_x, float* force_y, std::int32_t* choices) {
    if (columns.is_hunted == nullptr) {
        choose_each<true, false>(columns, begin, end, rules, force_x, force_y, choices);
    } else {
        choose_each<true, true>(columns, begin, end, rules, force_x, force_y, choices);
    }
}

/// Updates a view to the present positions. Returns, for each lane, whether the organism may touch items of this kind.
Integers follow_view(const ViewColumns& view, std::size_t i, Integers x, Integers y, Floats shift, Floats body_radius) {
    const Offset nearest = offset_to_nearest(view, i, x, y);
    Floats others = load<Floats>(view.others + i);
    others -= shift + (others * 1e-6f + 0.002f); // slightly more, to allow for rounding of distances and positions
    const Floats reach = body_radius + view.item_radius, radius = load<Floats>(view.radius + i);
    const Integers good = (others > 0.0f) & (lesser(nearest.square, radius * radius) < others * others);
    store(view.others + i, good ? others : all_lanes(-1.0f));
    return (nearest.square <= reach * reach) | (others <= reach);
}

void follow(const OrganismColumns& columns, std::size_t begin, std::size_t end, FoundIndices& at_food,
            FoundIndices& at_poison) {
    for (std::size_t i = begin; i < end; i += lanes) {
        prefetch_ahead(i, columns.seen_x, columns.seen_y, columns.id, columns.health);
        prefetch_view_ahead(i, columns.food);
        prefetch_view_ahead(i, columns.poison);
        const Integers x = load<Integers>(columns.x + i), y = load<Integers>(columns.y + i);
        const Floats shift_x = distances(load<Integers>(columns.seen_x + i), x);
        const Floats shift_y = distances(load<Integers>(columns.seen_y + i), y);
        const Floats shift = square_root(shift_x * shift_x + shift_y * shift_y);
        store(columns.seen_x + i, x);
        store(columns.seen_y + i, y);
        const Floats body_radius = load<Floats>(columns.body_radius + i);
        if (const unsigned bits = bits_of(follow_view(columns.food, i, x, y, shift, body_radius)); bits != 0) {
            append(at_food, i, bits);
        }
        if (const unsigned bits = bits_of(follow_view(columns.poison, i, x, y, shift, body_radius)); bits != 0) {
            append(at_poison, i, bits);
        }
    }
}

HashWords hash(const OrganismColumns& columns, std::uint32_t kind, std::size_t begin, std::size_t end,
               FoundIndices& dying) {
    HashSumsPerLane sums;
    const std::uint32_t kind_key = kind * 0x85ebca6bu;
    for (std::size_t i = begin; i < end; i += lanes) {
        const Floats health = load<Floats>(columns.health + i);
        const Integers there = health >= -__FLT_MAX__;
        sums.add(load<Words>(columns.id + i) + kind_key, load<Words>(columns.x + i), load<Words>(columns.y + i),
                 load<Words>(columns.velocity_x + i), load<Words>(columns.velocity_y + i), (Words)health, there);
        if (const unsigned bits = bits_of(there & (health <= 0.0f)); bits != 0) {
            append(dying, i, bits);
        }
    }
    return {sum_of(sums.low), sum_of(sums.high)};
}

} // namespace

extern const OrganismKernels EVOD_KERNEL(organism_kernels);
const OrganismKernels EVOD_KERNEL(organism_kernels) = {find_stale, notice, choose, predict, follow, hash};

} // namespace evod::simulation
