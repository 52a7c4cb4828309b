#include "server/physics/contacts.h"

#include "server/base/assert.h"
#include "server/base/commutative.h"
#include "server/physics/shapes.h"

#include <algorithm>
#include <utility>

namespace evod::physics {
namespace {

constexpr std::uint32_t box_bit = 0x8000'0000;
constexpr std::uint32_t no_identity = ~0u;
constexpr std::size_t contacts_per_piece = 256;

BoxShape shape_of(const Boxes& boxes, std::size_t i) {
    return {boxes.half_width[i], boxes.half_height[i]};
}

Overlap overlap_of(const Boxes& boxes, std::size_t a, std::size_t b) {
    return box_box(distance_px(boxes.x[a], boxes.x[b]), distance_px(boxes.y[a], boxes.y[b]), shape_of(boxes, a),
                   shape_of(boxes, b));
}

Overlap overlap_of(const Boxes& boxes, std::size_t box, const Circles& circles, std::size_t circle) {
    return box_circle(distance_px(boxes.x[box], circles.x[circle]), distance_px(boxes.y[box], circles.y[circle]),
                      shape_of(boxes, box), circles.radius[circle]);
}

struct Body {
    Bodies& bodies;
    std::size_t index;
};

/// Resolves one contact. overlap.normal must point from `a` to `b`.
void resolve_contact(Body a, Body b, const Overlap& overlap, float restitution) {
    const float mass_a = a.bodies.inverse_mass[a.index], mass_b = b.bodies.inverse_mass[b.index];
    const float total = mass_a + mass_b;
    EVOD_ASSERT(total > 0);
    const float nx = overlap.normal_x, ny = overlap.normal_y;
    // Immovable bodies are not written to, because several contacts of one such body may be resolved in parallel.
    const auto move = [&](Body body, float distance) {
        if (body.bodies.inverse_mass[body.index] == 0) {
            return;
        }
        body.bodies.x[body.index] += to_units(nx * distance);
        body.bodies.y[body.index] += to_units(ny * distance);
    };
    move(a, -overlap.depth * (mass_a / total));
    move(b, overlap.depth * (mass_b / total));

    const auto velocity_of = [&](Body body) {
        return std::pair{body.bodies.velocity_x[body.index], body.bodies.velocity_y[body.index]};
    };
    const auto [ax, ay] = velocity_of(a);
    const auto [bx, by] = velocity_of(b);
    const float approach = (bx - ax) * nx + (by - ay) * ny;
    if (approach >= 0) {
        return;
    }
    const float impulse = -(1 + restitution) * approach / total;
    const auto push = [&](Body body, float mass, float sign) {
        if (mass == 0) {
            return;
        }
        body.bodies.velocity_x[body.index] += sign * (impulse * mass * nx);
        body.bodies.velocity_y[body.index] += sign * (impulse * mass * ny);
    };
    push(a, mass_a, -1);
    push(b, mass_b, 1);
}

Overlap overlap_of(const Circles& circles, std::size_t a, std::size_t b) {
    return circle_circle(distance_px(circles.x[a], circles.x[b]), distance_px(circles.y[a], circles.y[b]),
                         circles.radius[a], circles.radius[b]);
}

/// Returns the identity of a body, by which contacts are sorted.
std::uint32_t identity_of(const Circles& circles, std::uint32_t body) {
    return body & box_bit ? body : circles.id[body];
}

} // namespace

void Contacts::begin(const Circles& circles, const Boxes& boxes) {
    constexpr std::size_t usually_enough = 64;
    resize_lists(found_in_block_, block_count(circles.size()), usually_enough);
    left_.reserve(found_in_block_.size() * usually_enough + 8 * boxes.size());
    found_with_boxes_.reserve(8 * boxes.size());
    first_of_circle_.resize(circles.size(), no_identity);
    first_of_box_.resize(boxes.size(), no_identity);
    found_with_boxes_.clear();
}

void Contacts::find_among_circles(const Circles& circles, const NearPairs& near, std::size_t block) {
    EVOD_ASSERT(block < found_in_block_.size());
    std::vector<Contact>& found = found_in_block_[block];
    found.clear();
    const Coordinate *x = circles.x.data(), *y = circles.y.data();
    const float* radius = circles.radius.data();
    for (const auto [a, b] : near.circle_pairs(block)) {
        const float dx = distance_px(x[a], x[b]), dy = distance_px(y[a], y[b]);
        const float reach = radius[a] + radius[b];
        if (dx * dx + dy * dy <= reach * reach && reach > 0) { // 0: both are void
            found.push_back({a, b});
        }
    }
}

void Contacts::find_with_boxes(const Circles& circles, const Boxes& boxes, const NearPairs& near) {
    for (const auto [circle, box] : near.circle_box_pairs()) {
        if (overlap_of(boxes, box, circles, circle).touching) {
            found_with_boxes_.push_back({circle, box | box_bit});
        }
    }
    for (const auto [a, b] : near.box_pairs()) {
        if (overlap_of(boxes, a, b).touching) {
            found_with_boxes_.push_back({a | box_bit, b | box_bit});
        }
    }
}

void Contacts::find(const Circles& circles, const Boxes& boxes, const Area& area, base::Executor& executor) {
    NearPairs near;
    near.renew(circles, boxes, area, executor);
    begin(circles, boxes);
    for (std::size_t block = 0; block < found_in_block_.size(); ++block) {
        find_among_circles(circles, near, block);
    }
    find_with_boxes(circles, boxes, near);
}

std::size_t Contacts::size() const {
    std::size_t size = found_with_boxes_.size();
    for (const std::vector<Contact>& found : found_in_block_) {
        size += found.size();
    }
    return size;
}

void Contacts::resolve(Circles& circles, Boxes& boxes, float restitution, base::Executor& executor) {
    EVOD_ASSERT(restitution >= 0);
    EVOD_ASSERT(first_of_circle_.size() >= circles.size());
    EVOD_ASSERT(first_of_box_.size() >= boxes.size());
    left_.assign(found_with_boxes_.begin(), found_with_boxes_.end());
    for (const std::vector<Contact>& found : found_in_block_) {
        left_.insert(left_.end(), found.begin(), found.end());
    }
    // If many bodies touch in a row, or a body has many contacts, each round can resolve only one of these contacts.
    // The remaining contacts are then sorted and resolved in order.
    const auto resolve_rounds = [&](std::size_t enough, auto resolve_one_round) {
        while (left_.size() > enough) {
            const std::size_t before = left_.size();
            resolve_one_round();
            if (before - left_.size() < before / 8) {
                resolve_in_order(circles, boxes, restitution);
                return;
            }
        }
    };
    if (executor.thread_count() > 1) {
        resolve_rounds(contacts_per_piece, [&] { resolve_round<true>(circles, boxes, restitution, executor); });
    }
    resolve_rounds(0, [&] { resolve_round<false>(circles, boxes, restitution, executor); });
}

void Contacts::resolve_in_order(Circles& circles, Boxes& boxes, float restitution) {
    const auto identities = [&](const Contact& contact) {
        const std::uint32_t a = identity_of(circles, contact.a), b = identity_of(circles, contact.b);
        return std::pair{std::min(a, b), std::max(a, b)};
    };
    std::sort(left_.begin(), left_.end(),
              [&](const Contact& a, const Contact& b) { return identities(a) < identities(b); });
    for (const Contact& contact : left_) {
        resolve_one(circles, boxes, contact, restitution);
    }
    left_.clear();
}

template <bool parallel>
void Contacts::resolve_round(Circles& circles, Boxes& boxes, float restitution, base::Executor& executor) {
    const auto identity = [&](std::uint32_t body) { return identity_of(circles, body); };
    const auto first_of = [&](std::uint32_t body) -> std::uint32_t& {
        return body & box_bit ? first_of_box_[body & ~box_bit] : first_of_circle_[body];
    };
    // A contact does not change an immovable body, so such a body may take part in several contacts at once.
    const auto waits = [&](std::uint32_t body) { return !(body & box_bit) || boxes.inverse_mass[body & ~box_bit] > 0; };
    const std::size_t grain = parallel ? contacts_per_piece : left_.size();

    executor.parallel_for(left_.size(), grain, [&](base::Range range) {
        for (std::size_t i = range.begin; i < range.end; ++i) {
            const std::uint32_t a = left_[i].a, b = left_[i].b;
            if (waits(a)) {
                base::fetch_min<parallel>(first_of(a), identity(b));
            }
            if (waits(b)) {
                base::fetch_min<parallel>(first_of(b), identity(a));
            }
        }
    });
    executor.parallel_for(left_.size(), grain, [&](base::Range range) {
        for (std::size_t i = range.begin; i < range.end; ++i) {
            const std::uint32_t a = left_[i].a, b = left_[i].b;
            if ((waits(a) && first_of(a) != identity(b)) || (waits(b) && first_of(b) != identity(a))) {
                continue;
            }
            resolve_one(circles, boxes, left_[i], restitution);
            left_[i].resolved = true;
        }
    });
    executor.parallel_for(left_.size(), grain, [&](base::Range range) {
        for (std::size_t i = range.begin; i < range.end; ++i) {
            base::put<parallel>(first_of(left_[i].a), no_identity);
            base::put<parallel>(first_of(left_[i].b), no_identity);
        }
    });
    std::erase_if(left_, [](const Contact& contact) { return contact.resolved; });
}

void Contacts::resolve_one(Circles& circles, Boxes& boxes, const Contact& contact, float restitution) {
    std::size_t a = contact.a & ~box_bit, b = contact.b & ~box_bit;
    if (!(contact.b & box_bit)) {
        // The normal points from the lower id to the higher. Two circles at the same position separate in that
        // direction.
        if (circles.id[a] > circles.id[b]) {
            std::swap(a, b);
        }
        if (const Overlap overlap = overlap_of(circles, a, b); overlap.touching) {
            resolve_contact({circles, a}, {circles, b}, overlap, restitution);
        }
    } else if (!(contact.a & box_bit)) {
        if (const Overlap overlap = overlap_of(boxes, b, circles, a); overlap.touching) {
            resolve_contact({boxes, b}, {circles, a}, overlap, restitution);
        }
    } else {
        if (const Overlap overlap = overlap_of(boxes, a, b); overlap.touching) {
            resolve_contact({boxes, a}, {boxes, b}, overlap, restitution);
        }
    }
}

} // namespace evod::physics
