// Meadow: organisms, food and poison at places that a test chooses. Its ticks run in the order of an island's
// (server/simulation/island.h), one part after another, so that a test can inspect the state between them.
#pragma once

#include "server/base/inline_executor.h"
#include "server/physics/step.h"
#include "server/simulation/behaviour.h"
#include "server/simulation/item_claims.h"
#include "server/simulation/items.h"
#include "server/simulation/living_organisms.h"
#include "server/simulation/perception.h"

#include <cstdint>
#include <vector>

namespace evod::simulation {

struct Meadow {
    physics::Area area;
    physics::Circles bodies;
    physics::Boxes boxes;
    LivingOrganisms living;
    Items food, poison;
    physics::StepParameters step{.integration =
                                     physics::integration(physics::Integrator::SymplecticEuler, 1.0 / 60, 0.06),
                                 .restitution = 0.8f,
                                 .max_speed_px_s = 600};
    BehaviourRules rules{
        .flee_rule = parameters::FleeRule::Nearer, .lookahead_s = 0.3f, .certain_impulse = 200, .force_per_unit = 1};
    base::RandomKey key{base::Seed{4}, base::Purpose::Behaviour, 0, 1};
    base::InlineExecutor executor;
    physics::Stepper stepper;
    Perception perception;
    ItemClaims food_claims, poison_claims;
    std::uint32_t tick = 0;

    /// At rest; the id is the number of organisms added before.
    void add_organism(physics::Coordinate x, physics::Coordinate y, const evolution::BodyGenes& genes) {
        const BodyShape shape = body_shape(genes(evolution::BodySize), parameters::Parameters{});
        const auto id = static_cast<std::uint32_t>(bodies.size());
        bodies.add({.id = id, .x = x, .y = y, .radius = shape.radius_px, .mass = shape.mass_kg});
        living.resize(bodies.size());
        living.put(id, genes, parameters::Parameters{});
    }

    void put_items(const std::vector<Place>& foods, const std::vector<Place>& poisons, float radius_px, bool respawn) {
        const auto put = [&](Items& items, const std::vector<Place>& places, base::Purpose respawn_purpose) {
            items.begin_at({.placement = base::Purpose::FoodPlacement,
                            .respawn_purpose = respawn_purpose,
                            .kind = 2,
                            .count = static_cast<std::uint32_t>(places.size()),
                            .radius_px = radius_px,
                            .respawn = respawn,
                            .respawn_ticks = 1},
                           places, base::Seed{1}, area, executor);
        };
        put(food, foods, base::Purpose::FoodRespawn);
        put(poison, poisons, base::Purpose::PoisonRespawn);
    }

    /// Call it when everything has been placed.
    void begin() {
        perception.begin(bodies, living, food, poison);
        stepper.near().invalidate();
    }

    OrganismColumns columns() { return organism_columns(bodies, living, perception, food, poison); }

    /// Items reappear, and views are updated.
    void perceive() {
        ++tick;
        if (stepper.near().stale(bodies, boxes)) {
            stepper.near().renew(bodies, boxes, area, executor);
        }
        food.reappear(tick, {}, executor);
        poison.reappear(tick, {}, executor);
        perception.notice_food(bodies, stepper.near(), living, food, executor);
        perception.notice_poison(bodies, stepper.near(), living, poison, executor);
        perception.search(bodies, living, food, poison, {0, bodies.size()});
    }

    /// All organisms choose and move, and touches are found.
    void act() {
        const std::size_t blocks = physics::block_count(bodies.size());
        stepper.begin(bodies, boxes, area, step);
        ChosenForces forces;
        for (std::size_t block = 0; block < blocks; ++block) {
            live_and_choose(columns(), rules, key, tick, physics::circles_of_block(bodies.size(), block), forces);
            stepper.accelerate(bodies, block, {forces.x.data(), forces.y.data()});
        }
        stepper.collide(bodies, boxes, executor);
        food_claims.begin(blocks);
        poison_claims.begin(blocks);
        for (std::size_t block = 0; block < blocks; ++block) {
            stepper.move(bodies, block);
            const base::Range range = physics::circles_of_block(bodies.size(), block);
            std::uint32_t food_indices[physics::circles_per_block], poison_indices[physics::circles_per_block];
            FoundIndices at_food{food_indices}, at_poison{poison_indices};
            organism_kernels().follow(columns(), range.begin, range.end, at_food, at_poison);
            food_claims.find_touches(block, {food_indices, at_food.count}, bodies, food);
            poison_claims.find_touches(block, {poison_indices, at_poison.count}, bodies, poison);
        }
        stepper.finish(boxes);
        food_claims.award();
        poison_claims.award();
    }

    /// An item and the body that gets it.
    struct Meal {
        std::uint32_t item, body;
    };
    std::vector<Meal> meals(const ItemClaims& claims) const {
        std::vector<Meal> meals;
        for (std::size_t block = 0; block < physics::block_count(bodies.size()); ++block) {
            for (const Touch& touch : claims.touches(block)) {
                if (touch.gets_it) {
                    meals.push_back({touch.item, touch.body});
                }
            }
        }
        return meals;
    }

    void eat() {
        for (const Meal& meal : meals(food_claims)) {
            food.consume(meal.item, tick);
        }
        for (const Meal& meal : meals(poison_claims)) {
            poison.consume(meal.item, tick);
        }
    }
};

} // namespace evod::simulation
