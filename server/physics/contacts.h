// Contacts: finds which bodies touch, and resolves them.
//
// Resolving a contact moves the two apart in proportion to their inverse masses and, if they approach, gives the
// impulse j = −(1 + e)(v_rel·n)/(Σ inverse mass) along n.
//
// Threads      pairs are looked at in blocks of circles side by side, and resolved in rounds: in each, side by side,
//              the contacts that are the first of those left for both their bodies.
// Determinism  so a body's contacts are resolved in rising order of the other's identity, circles by id before boxes by
//              index, which is what resolving all contacts in order of (first body, second body) would give. Groups of
//              bodies that do not touch each other do not influence each other.
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
    /// Forgets what was found with boxes; each block forgets when it is looked at.
    void begin(const Circles& circles, const Boxes& boxes);
    /// What touches now of what `near` lists. Blocks may be looked at side by side.
    void find_among_circles(const Circles& circles, const NearPairs& near, std::size_t block);
    void find_with_boxes(const Circles& circles, const Boxes& boxes, const NearPairs& near);

    /// Every touching pair in which at least one body can move, found afresh.
    void find(const Circles& circles, const Boxes& boxes, const Area& area, base::Executor& executor);

    /// Resolves what has been found, each pair as it is when its turn comes.
    void resolve(Circles& circles, Boxes& boxes, float restitution, base::Executor& executor);

    /// Pairs found.
    std::size_t size() const;

  private:
    // Bodies are circle indices, and box indices with the highest bit set.
    struct Contact {
        std::uint32_t a, b;
        bool resolved = false;
    };

    template <bool side_by_side>
    void resolve_round(Circles& circles, Boxes& boxes, float restitution, base::Executor& executor);
    void resolve_in_order(Circles& circles, Boxes& boxes, float restitution);
    static void resolve_one(Circles& circles, Boxes& boxes, const Contact& contact, float restitution);

    std::vector<std::vector<Contact>> found_in_block_; // of circles; kept warm between ticks
    std::vector<Contact> found_with_boxes_;
    std::vector<Contact> left_;
    base::Column<std::uint32_t> first_of_circle_, first_of_box_; // the least identity it is in contact with; nobody
};

} // namespace evod::physics
