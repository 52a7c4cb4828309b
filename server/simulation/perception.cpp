#include "server/simulation/perception.h"

#include "server/base/assert.h"
#include "server/base/commutative.h"
#include "server/base/instructions.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace evod::simulation {

using physics::Circles;
using physics::Coordinate;

extern const OrganismKernels organism_kernels_baseline, organism_kernels_avx2, organism_kernels_avx512;

const OrganismKernels& organism_kernels() {
    return base::chosen(organism_kernels_baseline, organism_kernels_avx2, organism_kernels_avx512);
}

namespace {

// An organism searches a circle that is at least this much wider than the circle that it perceives, so that it need not
// search again soon. A wider search costs more, but is needed less often.
constexpr float least_skin_px = 24;
constexpr std::size_t changes_per_piece = 64;
// Up to this number of bodies, it takes less time to compare each change with all bodies than to find the bodies near
// it.
constexpr std::size_t few_bodies = 64;
constexpr float needs_search = -1;
// The view of a void body, the placeholder of a dead organism: the body has void_position, and the stored item is at 0.
// Their distance is finite, so arithmetic with it is harmless.
constexpr float never = 1e30f;
constexpr Coordinate far_from_void = 0;

float search_radius(float radius, float body_radius, float item_radius) {
    const float reach = std::max(radius, body_radius + item_radius);
    return reach + std::max(reach / 4, least_skin_px);
}

/// Returns slightly less than `distance`, to allow for rounding of distances and positions.
float safely_below(float distance) {
    return distance - (distance * 1e-6f + 0.002f);
}

} // namespace

void Perception::begin(const Circles& bodies, const LivingOrganisms& living, const Items& food, const Items& poison) {
    for (View* view : {&food_, &poison_}) {
        view->others.clear();
        view->x.clear();
        view->y.clear();
        view->search_radius_max = 0;
    }
    append(bodies, living, food, poison, 0);
}

void Perception::append(const Circles& bodies, const LivingOrganisms& living, const Items& food, const Items& poison,
                        std::size_t first) {
    EVOD_ASSERT(living.health.size() == bodies.x.size());
    x_.resize(bodies.x.size());
    y_.resize(bodies.y.size());
    const auto from = static_cast<std::ptrdiff_t>(first);
    std::copy(bodies.x.begin() + from, bodies.x.end(), x_.begin() + from);
    std::copy(bodies.y.begin() + from, bodies.y.end(), y_.begin() + from);
    append(food_, bodies, living.food_radius, food, first);
    append(poison_, bodies, living.poison_radius, poison, first);
}

void Perception::append(View& view, const Circles& bodies, const base::Column<float>& radius, const Items& items,
                        std::size_t first) {
    view.others.resize(bodies.x.size(), never);
    view.x.resize(bodies.x.size(), far_from_void);
    view.y.resize(bodies.x.size(), far_from_void);
    for (std::size_t i = first; i < bodies.size(); ++i) {
        view.others[i] = needs_search;
        view.search_radius_max =
            std::max(view.search_radius_max, search_radius(radius[i], bodies.radius[i], items.radius_px()));
    }
}

void Perception::search(const Circles& bodies, const LivingOrganisms& living, const Items& food, const Items& poison,
                        base::Range range) {
    for (std::size_t begin = range.begin; begin < range.end; begin += physics::circles_per_block) {
        const base::Range block{begin, std::min(begin + physics::circles_per_block, range.end)};
        // Cells of items are scattered over memory: the cells for poison are prefetched while food is searched.
        Searches for_food, for_poison;
        begin_search(for_food, food_, bodies, living.food_radius, food, block);
        begin_search(for_poison, poison_, bodies, living.poison_radius, poison, block);
        finish_search(for_food, food_, food);
        finish_search(for_poison, poison_, poison);
    }
}

void Perception::begin_search(Searches& searches, const View& view, const Circles& bodies,
                              const base::Column<float>& radius, const Items& items, base::Range block) {
    FoundIndices stale{searches.indices};
    organism_kernels().find_stale(view.others.data(), block.begin, block.end, stale);
    searches.count = stale.count;
    for (std::size_t k = 0; k < searches.count; ++k) {
        const std::uint32_t i = searches.indices[k];
        searches.queries[k] = {bodies.x[i], bodies.y[i], search_radius(radius[i], bodies.radius[i], items.radius_px())};
    }
    items_kernels().prefetch(items.grid(), searches.queries, searches.count);
}

void Perception::finish_search(const Searches& searches, View& view, const Items& items) {
    TwoNearest found[physics::circles_per_block];
    items_kernels().two_nearest(items.grid(), searches.queries, found, searches.count);
    for (std::size_t k = 0; k < searches.count; ++k) {
        const std::uint32_t i = searches.indices[k];
        view.x[i] = found[k].x;
        view.y[i] = found[k].y;
        view.others[i] = safely_below(std::sqrt(found[k].others_square));
    }
}

void Perception::notice_food(const Circles& bodies, const physics::NearPairs& near, const LivingOrganisms& living,
                             Items& food, base::Executor& executor) {
    notice(food_, bodies, near, living.food_radius, food, executor);
}

void Perception::notice_poison(const Circles& bodies, const physics::NearPairs& near, const LivingOrganisms& living,
                               Items& poison, base::Executor& executor) {
    notice(poison_, bodies, near, living.poison_radius, poison, executor);
}

void Perception::notice(View& view, const Circles& bodies, const physics::NearPairs& near,
                        const base::Column<float>& radius, Items& items, base::Executor& executor) {
    const std::vector<Items::Change>& changes = items.changes();
    if (bodies.size() <= few_bodies) {
        organism_kernels().notice(bodies.x.data(), bodies.y.data(),
                                  {view.others.data(), view.x.data(), view.y.data(), radius.data(), items.radius_px()},
                                  changes.data(), changes.size(), bodies.size());
        items.forget_changes();
        return;
    }
    // If changes affect very many organisms, as in a crowd, it is cheaper to let all of them search.
    const std::size_t affected_max =
        8 * bodies.size() * changes_per_piece / std::max(changes.size(), changes_per_piece) + 64;
    std::uint32_t too_many = 0;
    executor.parallel_for(changes.size(), changes_per_piece, [&](base::Range range) {
        for (std::size_t begin = range.begin; begin < range.end; begin += changes_per_piece) {
            const std::size_t count = std::min(changes_per_piece, range.end - begin);
            if (notice(view, bodies, near, radius, {changes.data() + begin, count}, affected_max) > affected_max) {
                base::put<true>(too_many, 1u);
            }
        }
    });
    if (too_many != 0) {
        for (std::size_t i = 0; i < bodies.size(); ++i) {
            view.others[i] = bodies.is_void(i) ? never : needs_search;
        }
    }
    items.forget_changes();
}

std::size_t Perception::notice(View& view, const Circles& bodies, const physics::NearPairs& near,
                               const base::Column<float>& radius, std::span<const Items::Change> changes,
                               std::size_t affected_max) {
    // Changed items are scattered over the island, so memory is prefetched well before it is read: first where the list
    // of a stretch begins, then the list, then the bodies.
    struct Near {
        const Items::Change* change;
        physics::Strips::Stretch stretch;
        base::Range places{};
    };
    constexpr std::size_t batch_max = 512;
    std::array<Near, batch_max> batch;
    const std::span<const std::uint32_t> order = near.strips().order();
    std::size_t affected = 0, count = 0;
    const auto process_batch = [&] {
        for (std::size_t k = 0; k < count; ++k) {
            batch[k].places = near.strips().places(batch[k].stretch);
            affected += batch[k].places.end - batch[k].places.begin;
            __builtin_prefetch(order.data() + batch[k].places.begin);
        }
        for (std::size_t k = 0; k < count && affected <= affected_max; ++k) {
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
        for (std::size_t k = 0; k < count && affected <= affected_max; ++k) {
            for (std::size_t place = batch[k].places.begin; place < batch[k].places.end; ++place) {
                notice(view, bodies, radius, *batch[k].change, order[place]);
            }
        }
        count = 0;
    };
    for (const Items::Change& change : changes) {
        near.for_each_stretch_near(change.x, change.y, view.search_radius_max, [&](physics::Strips::Stretch stretch) {
            near.strips().prefetch(stretch);
            batch[count++] = {&change, stretch};
            if (count == batch_max) {
                process_batch();
            }
        });
    }
    process_batch();
    return affected;
}

void Perception::notice(View& view, const Circles& bodies, const base::Column<float>& radius,
                        const Items::Change& change, std::uint32_t i) {
    if (!change.came) {
        if (view.x[i] == change.x && view.y[i] == change.y) {
            base::fetch_min<true>(view.others[i], needs_search);
        }
        return;
    }
    const float dx = physics::distance_px(bodies.x[i], change.x), dy = physics::distance_px(bodies.y[i], change.y);
    const float square = dx * dx + dy * dy;
    if (square > view.search_radius_max * view.search_radius_max) {
        return;
    }
    const float distance = safely_below(std::sqrt(square));
    if (distance >= base::load_shared(view.others[i])) {
        return;
    }
    const float to_x = physics::distance_px(bodies.x[i], view.x[i]),
                to_y = physics::distance_px(bodies.y[i], view.y[i]);
    const float known_square = std::min(to_x * to_x + to_y * to_y, radius[i] * radius[i]);
    base::fetch_min<true>(view.others[i], distance > 0 && known_square < distance * distance ? distance : needs_search);
}

void Perception::reorder(const physics::Reordering& reordering) {
    reordering.apply(x_, physics::void_position);
    reordering.apply(y_, physics::void_position);
    for (View* view : {&food_, &poison_}) {
        reordering.apply(view->others, never);
        reordering.apply(view->x, far_from_void);
        reordering.apply(view->y, far_from_void);
    }
}

void Perception::remove(std::size_t body) {
    EVOD_ASSERT(body < x_.size());
    // The stored position becomes void_position, as if the body had always been void.
    x_[body] = y_[body] = physics::void_position;
    for (View* view : {&food_, &poison_}) {
        view->others[body] = never;
        view->x[body] = view->y[body] = far_from_void;
    }
}

void Perception::add_to(OrganismColumns& columns, const LivingOrganisms& living, const Items& food,
                        const Items& poison) {
    columns.seen_x = x_.data();
    columns.seen_y = y_.data();
    columns.food = {food_.others.data(), food_.x.data(), food_.y.data(), living.food_radius.data(), food.radius_px()};
    columns.poison = {poison_.others.data(), poison_.x.data(), poison_.y.data(), living.poison_radius.data(),
                      poison.radius_px()};
}

} // namespace evod::simulation
