#include "server/simulation/sight.h"

#include "server/base/commutative.h"
#include "server/base/instructions.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace evod::simulation {

using physics::Circles;
using physics::Coordinate;

extern const OrganismKernels organism_kernels_baseline, organism_kernels_avx2;

const OrganismKernels& organism_kernels() {
    return base::chosen(organism_kernels_baseline, organism_kernels_avx2);
}

namespace {

// How much further than it sees an organism looks, so that it need not look again at once: further looks cost more, and
// are due less often.
constexpr float least_skin_px = 24;
constexpr std::size_t changes_per_piece = 64;
constexpr float has_to_look = -1;
// A void body is elsewhere, so its view is of an item at 0; finite, so that arithmetic on it is harmless.
constexpr float never = 1e30f;
constexpr Coordinate far_from_void = 0;

float look_radius(float radius, float body_radius, float item_radius) {
    const float reach = std::max(radius, body_radius + item_radius);
    return reach + std::max(reach / 4, least_skin_px);
}

/// A little less than a distance, for all rounding of distances and places.
float safely_below(float distance) {
    return distance - (distance * 1e-6f + 0.002f);
}

} // namespace

void Sight::begin(const Circles& bodies, const Living& living, const Items& food, const Items& poison) {
    x_ = bodies.x;
    y_ = bodies.y;
    begin(food_, bodies, living.food_radius, food);
    begin(poison_, bodies, living.poison_radius, poison);
}

void Sight::begin(View& view, const Circles& bodies, const base::Column<float>& radius, const Items& items) {
    view.others.assign(bodies.x.size(), never);
    std::fill_n(view.others.begin(), bodies.size(), has_to_look);
    view.x.assign(bodies.x.size(), far_from_void);
    view.y.assign(bodies.x.size(), far_from_void);
    view.look_radius_max = 0;
    for (std::size_t i = 0; i < bodies.size(); ++i) {
        view.look_radius_max =
            std::max(view.look_radius_max, look_radius(radius[i], bodies.radius[i], items.radius_px()));
    }
}

void Sight::look(const Circles& bodies, const Living& living, const Items& food, const Items& poison,
                 base::Range range) {
    for (std::size_t begin = range.begin; begin < range.end; begin += physics::circles_per_block) {
        const base::Range block{begin, std::min(begin + physics::circles_per_block, range.end)};
        // Cells of items lie anywhere in memory: those for poison are on their way while food is looked for.
        Looks for_food, for_poison;
        begin_look(for_food, food_, bodies, living.food_radius, food, block);
        begin_look(for_poison, poison_, bodies, living.poison_radius, poison, block);
        finish_look(for_food, food_, food);
        finish_look(for_poison, poison_, poison);
    }
}

void Sight::begin_look(Looks& looks, const View& view, const Circles& bodies, const base::Column<float>& radius,
                       const Items& items, base::Range block) {
    FoundIndices stale{looks.indices};
    organism_kernels().find_stale(view.others.data(), block.begin, block.end, stale);
    looks.count = stale.count;
    for (std::size_t k = 0; k < looks.count; ++k) {
        const std::uint32_t i = looks.indices[k];
        looks.queries[k] = {bodies.x[i], bodies.y[i], look_radius(radius[i], bodies.radius[i], items.radius_px())};
    }
    items_kernels().prefetch(items.grid(), looks.queries, looks.count);
}

void Sight::finish_look(const Looks& looks, View& view, const Items& items) {
    TwoNearest found[physics::circles_per_block];
    items_kernels().two_nearest(items.grid(), looks.queries, found, looks.count);
    for (std::size_t k = 0; k < looks.count; ++k) {
        const std::uint32_t i = looks.indices[k];
        view.x[i] = found[k].x;
        view.y[i] = found[k].y;
        view.others[i] = safely_below(std::sqrt(found[k].others_square));
    }
}

void Sight::notice_food(const Circles& bodies, const physics::NearPairs& near, const Living& living, Items& food,
                        base::Executor& executor) {
    notice(food_, bodies, near, living.food_radius, food, executor);
}

void Sight::notice_poison(const Circles& bodies, const physics::NearPairs& near, const Living& living, Items& poison,
                          base::Executor& executor) {
    notice(poison_, bodies, near, living.poison_radius, poison, executor);
}

void Sight::notice(View& view, const Circles& bodies, const physics::NearPairs& near, const base::Column<float>& radius,
                   Items& items, base::Executor& executor) {
    const std::vector<Items::Change>& changes = items.changes();
    // Where changes concern a great many, as in a crowd, it is cheaper to have everybody look.
    const std::size_t concerned_max =
        8 * bodies.size() * changes_per_piece / std::max(changes.size(), changes_per_piece) + 64;
    std::uint32_t too_many = 0;
    executor.parallel_for(changes.size(), changes_per_piece, [&](base::Range range) {
        for (std::size_t begin = range.begin; begin < range.end; begin += changes_per_piece) {
            const std::size_t count = std::min(changes_per_piece, range.end - begin);
            if (notice(view, bodies, near, radius, {changes.data() + begin, count}, concerned_max) > concerned_max) {
                base::put<true>(too_many, 1u);
            }
        }
    });
    if (too_many != 0) {
        for (std::size_t i = 0; i < bodies.size(); ++i) {
            view.others[i] = bodies.is_void(i) ? never : has_to_look;
        }
    }
    items.forget_changes();
}

std::size_t Sight::notice(View& view, const Circles& bodies, const physics::NearPairs& near,
                          const base::Column<float>& radius, std::span<const Items::Change> changes,
                          std::size_t concerned_max) {
    // A change may be anywhere, so memory is asked for well before it is needed: first where the bodies of a stretch
    // are listed, then the list, then the bodies.
    struct Near {
        const Items::Change* change;
        physics::Strips::Stretch stretch;
        base::Range places{};
    };
    constexpr std::size_t batch_max = 512;
    std::array<Near, batch_max> batch;
    const std::span<const std::uint32_t> order = near.strips().order();
    std::size_t concerned = 0, count = 0;
    const auto notice_batch = [&] {
        for (std::size_t k = 0; k < count; ++k) {
            batch[k].places = near.strips().places(batch[k].stretch);
            concerned += batch[k].places.end - batch[k].places.begin;
            __builtin_prefetch(order.data() + batch[k].places.begin);
        }
        for (std::size_t k = 0; k < count && concerned <= concerned_max; ++k) {
            if (batch[k].places.begin == batch[k].places.end) {
                continue;
            }
            const auto& x = batch[k].change->came ? bodies.x : view.x;
            const auto& y = batch[k].change->came ? bodies.y : view.y;
            for (const std::size_t place : {batch[k].places.begin, batch[k].places.end - 1}) {
                __builtin_prefetch(&x[order[place]]);
                __builtin_prefetch(&y[order[place]]);
            }
        }
        for (std::size_t k = 0; k < count && concerned <= concerned_max; ++k) {
            for (std::size_t place = batch[k].places.begin; place < batch[k].places.end; ++place) {
                notice(view, bodies, radius, *batch[k].change, order[place]);
            }
        }
        count = 0;
    };
    for (const Items::Change& change : changes) {
        near.for_each_stretch_near(change.x, change.y, view.look_radius_max, [&](physics::Strips::Stretch stretch) {
            near.strips().prefetch(stretch);
            batch[count++] = {&change, stretch};
            if (count == batch_max) {
                notice_batch();
            }
        });
    }
    notice_batch();
    return concerned;
}

void Sight::notice(View& view, const Circles& bodies, const base::Column<float>& radius, const Items::Change& change,
                   std::uint32_t i) {
    if (!change.came) {
        if (view.x[i] == change.x && view.y[i] == change.y) {
            base::fetch_min<true>(view.others[i], has_to_look);
        }
        return;
    }
    const float dx = physics::distance_px(bodies.x[i], change.x), dy = physics::distance_px(bodies.y[i], change.y);
    const float square = dx * dx + dy * dy;
    if (square > view.look_radius_max * view.look_radius_max) {
        return;
    }
    const float distance = safely_below(std::sqrt(square));
    if (distance >= base::look_at(view.others[i])) {
        return;
    }
    const float to_x = physics::distance_px(bodies.x[i], view.x[i]),
                to_y = physics::distance_px(bodies.y[i], view.y[i]);
    const float known = std::min(to_x * to_x + to_y * to_y, radius[i] * radius[i]);
    base::fetch_min<true>(view.others[i], distance > 0 && known < distance * distance ? distance : has_to_look);
}

void Sight::reorder(const physics::Reordering& reordering) {
    reordering.apply(x_, physics::elsewhere);
    reordering.apply(y_, physics::elsewhere);
    for (View* view : {&food_, &poison_}) {
        reordering.apply(view->others, never);
        reordering.apply(view->x, far_from_void);
        reordering.apply(view->y, far_from_void);
    }
}

void Sight::remove(std::size_t body) {
    // As if it had never moved from elsewhere.
    x_[body] = y_[body] = physics::elsewhere;
    for (View* view : {&food_, &poison_}) {
        view->others[body] = never;
        view->x[body] = view->y[body] = far_from_void;
    }
}

void Sight::add_to(OrganismColumns& columns, const Living& living, const Items& food, const Items& poison) {
    columns.seen_x = x_.data();
    columns.seen_y = y_.data();
    columns.food = {food_.others.data(), food_.x.data(), food_.y.data(), living.food_radius.data(), food.radius_px()};
    columns.poison = {poison_.others.data(), poison_.x.data(), poison_.y.data(), living.poison_radius.data(),
                      poison.radius_px()};
}

} // namespace evod::simulation
