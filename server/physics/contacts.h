// Contacts: the narrow phase. Finds which listed pairs touch, and resolves the contacts.
//
// Resolving a contact moves the two bodies apart in proportion to their inverse masses. If they approach each other, it
// also applies the impulse j = −(1 + e)(v_rel·n)/(Σ inverse mass) along n.
//
// Threads      pairs are tested in parallel, by blocks of circles. Contacts are resolved in rounds. Each round
//              resolves, in parallel, every contact that is the next one for both of its bodies.
// Determinism  a body's contacts are resolved in ascending order of the other body's identity: circles by id, then
//              boxes by index. The result equals that of resolving all contacts in order of (first body, second body).
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
    /// Clears the contacts with boxes. Each block clears its own contacts when it is tested.
    void begin(const Circles& circles, const Boxes& boxes);
    /// Finds the pairs of a block that touch now, among the near pairs of that block. Blocks may be tested in parallel.
    void find_among_circles(const Circles& circles, const NearPairs& near, std::size_t block);
    void find_with_boxes(const Circles& circles, const Boxes& boxes, const NearPairs& near);

    /// Finds every touching pair in which at least one body can move, from a new list of near pairs.
    void find(const Circles& circles, const Boxes& boxes, const Area& area, base::Executor& executor);

    /// Resolves the contacts that were found. Each contact uses the state that the previous contacts have left.
    void resolve(Circles& circles, Boxes& boxes, float restitution, base::Executor& executor);

    /// The number of pairs found.
    std::size_t size() const;

  private:
    // A body is identified by a circle's index, or by a box's index with the highest bit set.
    struct Contact {
        std::uint32_t a, b;
        bool resolved = false;
    };

    template <bool parallel>
    void resolve_round(Circles& circles, Boxes& boxes, float restitution, base::Executor& executor);
    void resolve_in_order(Circles& circles, Boxes& boxes, float restitution);
    static void resolve_one(Circles& circles, Boxes& boxes, const Contact& contact, float restitution);

    std::vector<std::vector<Contact>> found_in_block_; // per block of circles; kept between ticks
    std::vector<Contact> found_with_boxes_;
    std::vector<Contact> left_;
    // Per body: the least identity of the other bodies in its unresolved contacts; no_identity if there are none.
    base::Column<std::uint32_t> first_of_circle_, first_of_box_;
};

} // namespace evod::physics
