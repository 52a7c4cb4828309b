// Contacts: finds which bodies touch, and resolves them.
//
// Resolving a contact moves the two apart in proportion to their inverse masses and, if they approach, gives the
// impulse j = −(1 + e)(v_rel·n)/(Σ inverse mass) along n.
//
// Threads      pairs are looked for in rows of cells side by side; they are resolved one after another.
// Determinism  contacts are resolved in rising order of (first body, second body): circles by id, then boxes by index.
//              Groups of bodies that do not touch each other do not influence each other.
// Source       Baraff 1997, "An introduction to physically based modeling", on impulses without rotation.
#pragma once

#include "server/base/executor.h"
#include "server/physics/bodies.h"
#include "server/physics/broad_phase.h"

#include <cstdint>
#include <vector>

namespace evod::physics {

class Contacts {
  public:
    /// Finds every touching pair in which at least one body can move.
    void find(const Circles& circles, const Boxes& boxes, const Area& area, base::Executor& executor);

    /// Resolves what find() found, each pair as it is when its turn comes.
    void resolve(Circles& circles, Boxes& boxes, float restitution) const;

    std::size_t size() const { return pairs_.size(); }

  private:
    // A pair as one number that sorts by (first, second): bodies are circle indices, then boxes from circle count on.
    using Pair = std::uint64_t;

    void find_circle_pairs(base::Executor& executor);
    void find_box_circle_pairs(const Circles& circles, const Boxes& boxes, float radius_max);
    void find_box_pairs(const Circles& circles, const Boxes& boxes);

    CircleGrid grid_;
    std::vector<std::vector<Pair>> pairs_of_block_; // kept warm between ticks
    std::vector<std::uint32_t> boxes_by_left_;
    std::vector<Pair> pairs_;
};

/// Bounces the bodies that touch a wall, or are beyond it, and head outward: their outward velocity v becomes −e·v.
void bounce_off_walls(Circles& circles, Boxes& boxes, const Area& area, float restitution);

/// Puts what is beyond a wall back to touching it, and bounces it if it still heads outward.
void keep_inside(Circles& circles, Boxes& boxes, const Area& area, float restitution);

} // namespace evod::physics
