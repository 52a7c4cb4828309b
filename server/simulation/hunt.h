// Hunt: how prey and predators see each other.
//
// A predator that handles no prey sees the nearest prey within its food_radius, and no items. A prey sees, besides
// items, the nearest predator within its poison_radius. If the predator is nearer than the nearest poison, it takes the
// place of the poison: the prey may then flee even if it sees nearer food.
//
// Owner        an island with predators.
// Threads      blocks of organisms look in parallel.
// Determinism  equal distances: the lowest id. What organisms see depends on their positions alone.
#pragma once

#include "server/base/column.h"
#include "server/base/executor.h"
#include "server/physics/bodies.h"
#include "server/simulation/body_grid.h"
#include "server/simulation/living_organisms.h"
#include "server/simulation/organism_kernels.h"

#include <algorithm>
#include <cstdint>
#include <span>
#include <vector>

namespace evod::simulation {

/// What an organism sees: the positions of its food and of its threat; void_position if there is none.
struct SeenPlaces {
    physics::Coordinate food_x, food_y, threat_x, threat_y;
    std::int32_t is_hunted; // −1 if the threat is a predator, otherwise 0
};

class Hunt {
  public:
    /// Finds where the organisms of both species are.
    ///
    /// is_predator  is_predator(id).
    template <class IsPredator>
    void locate(const physics::Circles& bodies, const physics::Area& area, const IsPredator& is_predator) {
        prey_bodies_.clear();
        predator_bodies_.clear();
        widest_prey_px_ = 0;
        is_predator_.assign(physics::padded(bodies.size()), false);
        for (std::uint32_t i = 0; i < bodies.size(); ++i) {
            if (!bodies.is_void(i)) {
                is_predator_[i] = is_predator(bodies.id[i]);
                (is_predator_[i] ? predator_bodies_ : prey_bodies_).push_back(i);
                widest_prey_px_ = is_predator_[i] ? widest_prey_px_ : std::max(widest_prey_px_, bodies.radius[i]);
            }
        }
        prey_.build(bodies, prey_bodies_, area);
        predators_.build(bodies, predator_bodies_, area);
        for (auto* column : {&food_x_, &food_y_, &threat_x_, &threat_y_, &is_hunted_}) {
            column->resize(is_predator_.size());
        }
        is_located_ = true;
    }
    /// The bodies have changed otherwise than by becoming void.
    void forget() { is_located_ = false; }
    bool is_located() const { return is_located_; }
    float widest_prey_px() const { return widest_prey_px_; } // greatest radius
    const BodyGrid& prey() const { return prey_; }
    const BodyGrid& predators() const { return predators_; }

    /// Changes what an organism sees of the items to what it sees of items and organisms.
    ///
    /// tick  of the generation, in which it acts.
    void look(const physics::Circles& bodies, const LivingOrganisms& living, std::uint32_t body, std::uint32_t tick,
              SeenPlaces& seen_places) const;

    /// Lets the organisms of a block look, and sets the members of `columns` that describe what they see.
    ///
    /// columns  with the views of items.
    void look(const physics::Circles& bodies, const LivingOrganisms& living, base::Range block, std::uint32_t tick,
              OrganismColumns& columns);
    bool is_predator(std::uint32_t body) const { return is_predator_[body] != 0; }

  private:
    bool is_located_ = false;
    BodyGrid prey_, predators_;
    float widest_prey_px_ = 0;
    std::vector<std::uint32_t> prey_bodies_, predator_bodies_; // kept between ticks to reuse the memory
    std::vector<std::uint8_t> is_predator_;                    // by body
    base::Column<std::int32_t> food_x_, food_y_, threat_x_, threat_y_, is_hunted_; // by body
};

} // namespace evod::simulation
